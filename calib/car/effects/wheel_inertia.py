"""Wheel inertia: parts of the driveline that turn with the front wheels."""

from calib.car.effects.effect import Card, Effect, Parameter, Parameters


def inertia(parameters: Parameters) -> tuple[float, float]:
    """Additional inertia J_x [kg m^2] of one front wheel; zero at the rear.

    Valid for one gear: the engine's share grows with the square of the ratio.
    """
    return parameters["extra_inertia"], 0.0


EFFECT = Effect(
    card=Card(
        name="wheel_inertia",
        cause="drive shafts, gears and engine that turn with the driven front wheels",
        equation="J_w + J_x at the front; no effect at extra_inertia = 0",
        source="Gillespie, Fundamentals of Vehicle Dynamics, ch. 2 (rotating masses)",
        looks_like="less front tyre force per torque, as with weaker front pads",
        parameters=(Parameter("extra_inertia", "kg*m^2", 0.0, 10.0, 1.0, 0.7),),
    ),
    inertia=inertia,
)
