"""Pitch: the load transfer waits for the body, and the pitched accelerometer sees gravity.

z --> body on its springs --> z_b:  z_b'' + 2 D w z_b' + w^2 z_b = w^2 z
load transfer: (1 - e) z at once through the links, e z_b through the springs
nose down by e k z_b
"""

from calib.names import G
from calib.physics.effects.effect import Array, Card, Effect, Parameter, Parameters
from calib.physics.history import RunHistory
from calib.physics.lag import second_order
from calib.physics.vehicle import Vehicle


def load_shift(vehicle: Vehicle, parameters: Parameters, history: RunHistory) -> Array:
    """Share e (z - z_b) h/L of W [1] that the front axle still lacks.

    Springs and dampers of both axles as one mode; steady at the first sample.
    """
    late = history.z - _body(parameters, history)
    return parameters["elastic_share"] * late * vehicle.cg_height / vehicle.wheelbase


def accelerometer(
    vehicle: Vehicle, parameters: Parameters, history: RunHistory, a_x: Array
) -> Array:
    """Return a_x - g e k z_b [m/s^2]: nose down, gravity adds to the deceleration; small angles."""
    pitch = parameters["elastic_share"] * parameters["pitch_gradient"] * _body(parameters, history)
    return a_x - G * pitch


def _body(parameters: Parameters, history: RunHistory) -> Array:
    """Deceleration [1] at which the springs as they stand would be at rest."""
    frequency, damping = parameters["natural_frequency"], parameters["damping"]
    return second_order(history.time, history.z, frequency, damping)


EFFECT = Effect(
    card=Card(
        name="pitch_coupling",
        cause="the body pitches on its springs; e of the load transfer goes through them",
        equation=(
            "z_b'' + 2 D w z_b' + w^2 z_b = w^2 z; front load less W e (z - z_b) h/L; "
            "a_x - g e k z_b; nothing at elastic_share = 0"
        ),
        source="Gillespie, Fundamentals of Vehicle Dynamics, ch. 5 and 7 (anti-dive)",
        looks_like="a_x that rings at 1 to 2 Hz after a step and reads too much while held",
        parameters=(
            Parameter("elastic_share", "1", 0.0, 1.5, 1.0, 0.25),
            Parameter("natural_frequency", "rad/s", 3.0, 30.0, 9.5, 2.5),
            Parameter("damping", "1", 0.05, 0.95, 0.3, 0.1),
            Parameter("pitch_gradient", "rad", 0.0, 0.15, 0.03, 0.015),
        ),
    ),
    load_shift=load_shift,
    accelerometer=accelerometer,
)
