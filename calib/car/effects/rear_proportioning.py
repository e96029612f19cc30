"""Proportioning valve: the rear brakes get less of the pressure above a knee."""

import numpy as np

from calib.car.effects.effect import Array, Card, Effect, Pair, Parameter, Parameters
from calib.car.history import RunHistory


def pressure(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Rear pressure [Pa] that grows with ``knee_slope`` above ``knee``; the front is unchanged.

    Valid for a valve without hysteresis, whose knee does not depend on load or deceleration.
    """
    return p_f, limited(p_r, parameters["knee"], parameters["knee_slope"])


def limited(p: Array, knee: float, slope: float) -> Array:
    """Pressure [Pa] behind the valve: it grows with ``slope`` [1] above the ``knee`` [Pa]."""
    return np.asarray(p - (1.0 - slope) * np.maximum(p - knee, 0.0))


EFFECT = Effect(
    card=Card(
        name="rear_proportioning",
        cause="a proportioning valve, or a control unit that acts as one",
        equation="p_r = p_k + s (p - p_k) above p_k; no effect at knee_slope = 1",
        source="Limpert, Brake Design and Safety, ch. 7",
        looks_like="rear torque that grows less with pressure above a knee; front unchanged",
        parameters=(
            Parameter("knee_slope", "1", 0.0, 1.0, 0.4, 0.2),
            Parameter("knee", "Pa", 0.0, 150e5, 25e5, 10e5),
        ),
        neutral=1.0,
    ),
    pressure=pressure,
)
