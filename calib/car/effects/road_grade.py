"""Road grade: the part of the weight that acts along the road."""

import numpy as np

from calib.base.names import G
from calib.car.effects.effect import Array, Card, Effect, Parameter, Parameters
from calib.car.history import Motion, RunHistory
from calib.car.vehicle import Vehicle


def body_force(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> Array:
    """F = W s [N], constant over the run; the axle loads are those of a flat road.

    The sine s is within 0.5 % of the tangent up to a grade of 10 %.
    """
    return np.full_like(motion.v, vehicle.weight * parameters["grade"])


def accelerometer(
    vehicle: Vehicle, parameters: Parameters, history: RunHistory, a_x: Array
) -> Array:
    """Return a_x + f g s [m/s^2]: a sensor reads specific force (f = 1), a log may hold dv/dt."""
    return a_x + parameters["felt"] * G * parameters["grade"]


EFFECT = Effect(
    card=Card(
        name="road_grade",
        cause="slope of the road, positive uphill",
        equation="F = W s, s sine of the slope; a_x reads f g s more; no effect at grade = 0",
        source="Gillespie, Fundamentals of Vehicle Dynamics, ch. 1",
        looks_like="a constant deceleration, braked or not, without slip; either sign",
        parameters=(
            Parameter("grade", "1", -0.2, 0.2, 0.02, 0.02),
            Parameter("felt", "1", 0.0, 1.0, 0.5, 0.5),
        ),
    ),
    body_force=body_force,
    accelerometer=accelerometer,
)
