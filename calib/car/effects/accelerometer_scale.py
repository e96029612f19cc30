"""Accelerometer scale: an error of the reading in proportion to it."""

from calib.car.effects.effect import Array, Card, Effect, Parameter, Parameters
from calib.car.history import RunHistory
from calib.car.vehicle import Vehicle


def accelerometer(
    vehicle: Vehicle, parameters: Parameters, history: RunHistory, a_x: Array
) -> Array:
    """Return a_x (1 + e) [m/s^2]."""
    return a_x * (1.0 + parameters["scale_error"])


EFFECT = Effect(
    card=Card(
        name="accelerometer_scale",
        cause="scale factor error of the sensor",
        equation="a_x (1 + e); no effect at scale_error = 0",
        source="IEEE Std 1293, scale factor",
        looks_like="an error of a_x in proportion to the deceleration, not shown by wheel speeds",
        parameters=(Parameter("scale_error", "1", -0.2, 0.2, 0.03, 0.02),),
    ),
    accelerometer=accelerometer,
)
