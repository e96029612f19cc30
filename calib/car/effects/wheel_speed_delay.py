"""Wheel speed delay: all wheel speeds are read late."""

from calib.car.effects.effect import Card, Effect, Parameter, Parameters


def wheel_speed_delay(parameters: Parameters) -> float:
    """Time [s] by which the wheel speeds are late against every other channel."""
    return parameters["omega_delay"]


EFFECT = Effect(
    card=Card(
        name="wheel_speed_delay",
        cause="wheel speeds that are averaged over teeth or sent over a bus",
        equation="omega(t - T_w); no effect at omega_delay = 0",
        source="message cycle of a brake control unit: 10 to 20 ms, after a mean over the teeth",
        looks_like="a negative slip of all wheels in proportion to deceleration over speed",
        parameters=(Parameter("omega_delay", "s", 0.0, 0.3, 0.02, 0.015),),
    ),
    wheel_speed_delay=wheel_speed_delay,
)
