"""Accelerometer bias: a constant offset of the reading."""

from calib.car.effects.effect import Array, Card, Effect, Parameter, Parameters
from calib.car.history import RunHistory
from calib.car.vehicle import Vehicle


def accelerometer(
    vehicle: Vehicle, parameters: Parameters, history: RunHistory, a_x: Array
) -> Array:
    """Return a_x + b [m/s^2]; b is constant over the run."""
    return a_x + parameters["bias"]


EFFECT = Effect(
    card=Card(
        name="accelerometer_bias",
        cause="zero error or tilted mounting of the sensor",
        equation="a_x + b; no effect at bias = 0",
        source="IEEE Std 1293, bias",
        looks_like="a constant error of a_x, coasting and braking, that wheel speeds do not show",
        parameters=(Parameter("bias", "m/s^2", -1.0, 1.0, 0.1, 0.1),),
    ),
    accelerometer=accelerometer,
)
