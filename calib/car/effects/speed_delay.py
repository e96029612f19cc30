"""Speed delay: the reference speed is read late."""

from calib.car.effects.effect import Card, Effect, Parameter, Parameters


def speed_delay(parameters: Parameters) -> float:
    """Time [s] by which v is late against every other channel."""
    return parameters["v_delay"]


EFFECT = Effect(
    card=Card(
        name="speed_delay",
        cause="latency of the reference speed: the computing time of a satellite receiver, a bus",
        equation="v(t - T_v); no effect at v_delay = 0",
        source="data sheets of satellite speed sensors: 5 to 150 ms",
        looks_like="a slip of all wheels in proportion to the deceleration over the speed",
        parameters=(Parameter("v_delay", "s", 0.0, 0.5, 0.05, 0.03),),
    ),
    speed_delay=speed_delay,
)
