"""Hydraulic oscillation: the mass of the fluid on the compliance of hoses and calipers."""

import numpy as np

from calib.car.effects.effect import Array, Card, Effect, Pair, Parameter, Parameters
from calib.car.history import RunHistory
from calib.car.lag import second_order


def pressure(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Pressure [Pa] after a second-order lag that overshoots, the same on both axles.

    T = 1/w of the undamped mode. Steady state at the first sample. It does not swing below zero,
    where nothing clamps. Not valid for a strongly damped line: that is `hydraulic_lag`.
    """
    T, damping = parameters["response_time"], parameters["line_damping"]
    if T <= 0.0:
        return p_f, p_r
    front = _swinging(history.time, p_f, 1.0 / T, damping)
    return front, front if p_r is p_f else _swinging(history.time, p_r, 1.0 / T, damping)


def _swinging(time: Array, p: Array, frequency: float, damping: float) -> Array:
    return np.maximum(second_order(time, p, frequency, damping), np.minimum(p, 0.0))


EFFECT = Effect(
    card=Card(
        name="hydraulic_oscillation",
        cause="mass of the fluid in the lines on the compliance of hoses, calipers or a booster",
        equation="T^2 p'' + 2 D T p' + p = p_mc; no effect at response_time = 0",
        source="Limpert, Brake Design and Safety, ch. 5; Breuer and Bill, Brake Technology",
        looks_like=(
            "torque that follows a step of pressure late and overshoots; on ramps the same as a "
            "delay of 2 D T: only steps or quick releases tell them apart"
        ),
        parameters=(
            Parameter("response_time", "s", 0.0, 0.5, 0.06, 0.04),
            Parameter("line_damping", "1", 0.05, 0.98, 0.5, 0.2),
        ),
    ),
    pressure=pressure,
)
