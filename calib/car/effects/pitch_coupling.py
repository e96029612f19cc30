"""Pitch: the load transfer follows the body's pitch mode; a pitched accelerometer reads gravity.

z --> body on its springs --> z_b:  z_b'' + 2 D w z_b' + w^2 z_b = w^2 z
load transfer: (1 - e) z at once through the links, e z_b through the springs
nose down by e k z_b

The split filter (`calib.estimation.states`) follows the same mode with the same typical values.
"""

import numpy as np

from calib.base.names import G
from calib.car.effects.effect import Array, Card, Effect, Parameter, Parameters
from calib.car.history import RunHistory
from calib.car.lag import second_order
from calib.car.vehicle import Vehicle

NATURAL_FREQUENCY = Parameter("natural_frequency", "rad/s", 3.0, 30.0, 2.6 * np.pi, 2.5)
"""1.3 Hz, that of a usual body (Gillespie, ch. 5)."""

DAMPING = Parameter("damping", "1", 0.05, 0.95, 0.3, 0.1)
"""That of a usual body (Gillespie, ch. 5)."""

ELASTIC_SHARE = Parameter("elastic_share", "1", 0.0, 1.5, 0.4, 0.4)
"""Zero on a stiff car, nearly 1 without anti-dive (Gillespie, ch. 7)."""


def pitch_deficit(
    vehicle: Vehicle, time: Array, z: Array, natural_frequency: float, damping: float
) -> Array:
    """Share (z - z_b) h/L of W [1] by which load transfer through the springs lags, (n,).

    ``time`` [s], ``z`` deceleration over g [1], (n,); ``natural_frequency`` w [rad/s]; ``damping``
    D [1], 0 <= D < 1. Springs and dampers of both axles as one mode; steady state at the first
    sample. Causal. Not valid where a wheel lifts or the suspension reaches its stops.
    """
    late = z - second_order(time, z, natural_frequency, damping)
    return np.asarray(late * vehicle.cg_height / vehicle.wheelbase)


def load_shift(vehicle: Vehicle, parameters: Parameters, history: RunHistory) -> Array:
    """Share e (z - z_b) h/L of W [1] by which the load of the front axle lags."""
    w, damping = parameters["natural_frequency"], parameters["damping"]
    return parameters["elastic_share"] * pitch_deficit(vehicle, history.time, history.z, w, damping)


def accelerometer(
    vehicle: Vehicle, parameters: Parameters, history: RunHistory, a_x: Array
) -> Array:
    """Return a_x - g e k z_b [m/s^2]: nose down, the reading contains gravity; small angles."""
    pitch = parameters["elastic_share"] * parameters["pitch_gradient"] * _body(parameters, history)
    return a_x - G * pitch


def _body(parameters: Parameters, history: RunHistory) -> Array:
    """Deceleration z_b [1] at which the present deflection of the springs would be steady."""
    frequency, damping = parameters["natural_frequency"], parameters["damping"]
    return second_order(history.time, history.z, frequency, damping)


EFFECT = Effect(
    card=Card(
        name="pitch_coupling",
        cause="the body pitches on its springs; e of the load transfer goes through them",
        equation=(
            "z_b'' + 2 D w z_b' + w^2 z_b = w^2 z; front load less W e (z - z_b) h/L; "
            "a_x - g e k z_b; no effect at elastic_share = 0"
        ),
        source="Gillespie, Fundamentals of Vehicle Dynamics, ch. 5 and 7 (anti-dive)",
        looks_like="a_x that oscillates at 1 to 2 Hz after a step and is too large while held",
        parameters=(
            ELASTIC_SHARE,
            NATURAL_FREQUENCY,
            DAMPING,
            Parameter("pitch_gradient", "rad", 0.0, 0.15, 0.03, 0.015),
        ),
    ),
    load_shift=load_shift,
    accelerometer=accelerometer,
)
