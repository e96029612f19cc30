"""Pressure dependence of the pads: friction that changes with the clamping pressure.

mu  |`.
    |  `-.__                  bend > 0: most of the change at light braking
    |       `````-----___
    +----------|----------> p
             20 bar
"""

import numpy as np

from calib.car.effects.effect import Array, Card, Effect, Pair, Parameter, Parameters
from calib.car.history import RunHistory

REFERENCE_PRESSURE = 20e5
"""Pressure [Pa] at which the pad friction is that of the model; the middle of usual braking."""

STRAIGHT = 1e-10
"""Bend [1/Pa] below which the curve is a straight line to the last digits."""


def friction(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Factor 1 + k (p - 20 bar) [1], p of the caliper, bent with the ``pressure_bend`` b.

    Instead of p - 20 bar, 40 bar (exp(-20 bar b) - exp(-p b))/(1 - exp(-40 bar b)), so that k is
    the mean slope from 0 to 40 bar. A bend of 0 to 0.2/bar covers the powers of p by which linings
    are described: p^-0.1 within 3.5 % from 3 to 60 bar.
    """
    slope, bend = parameters["pressure_slope"], parameters.get("pressure_bend", 0.0)
    return 1.0 + slope * _beyond(p_f, bend), 1.0 + slope * _beyond(p_r, bend)


def _beyond(p: Array, bend: float) -> Array:
    """Pressure beyond the reference [Pa] (n,), bent."""
    middle = REFERENCE_PRESSURE
    if bend < STRAIGHT:
        return p - middle
    part = (np.exp(-bend * middle) - np.exp(-bend * p)) / -np.expm1(-2.0 * bend * middle)
    return np.asarray(2.0 * middle * part)


EFFECT = Effect(
    card=Card(
        name="pad_pressure_dependence",
        cause="pad friction changes with the contact pressure",
        equation=(
            "mu_p (1 + k (p - 20 bar)), most of it at light braking with a bend b > 0; no effect "
            "at pressure_slope = 0"
        ),
        source="Limpert, Brake Design and Safety, ch. 3; ISO 15484",
        looks_like="torque that is not proportional to pressure, at any speed and temperature",
        parameters=(
            Parameter("pressure_slope", "1/Pa", -1e-7, 1e-7, -2e-8, 2e-8),
            Parameter("pressure_bend", "1/Pa", 0.0, 4e-6, 2e-7, 4e-7, default=0.0),
        ),
    ),
    friction=friction,
)
