"""Threshold pressure: the pressure that seals and springs need before the pads are pressed."""

import numpy as np

from calib.car.effects.effect import Array, Card, Effect, Pair, Parameter, Parameters
from calib.car.history import RunHistory

BOTH = 0.5
"""Share at which both axles have the same threshold [1]."""


def pressure(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Pressure less the threshold p_0 [Pa]; zero below p_0.

    The threshold of the front axle is p_0 min(1, 2 - 2 s), of the rear one p_0 min(1, 2 s):
    ``threshold_rear_share`` s is one half, both alike, where it is not given. A negative pressure
    keeps its sign, so that sensor noise at rest keeps a mean of zero. A negative threshold is what
    a sensor reads too little: it adds to every pressure above -p_0, and below that less, so that a
    released brake stays released, read as zero or as p_0.
    """
    share = parameters.get("threshold_rear_share", BOTH)
    at_most = parameters["threshold"]
    front, rear = at_most * min(1.0, 2.0 - 2.0 * share), at_most * min(1.0, 2.0 * share)
    return _less(p_f, front), _less(p_r, rear)


def _less(p: Array, threshold: float) -> Array:
    if threshold < 0.0:
        return _read_too_low(p, -threshold)
    return np.asarray(p - np.clip(p, -threshold, threshold))


def _read_too_low(p: Array, by: float) -> Array:
    return np.asarray(p + np.minimum(np.abs(p), by))


EFFECT = Effect(
    card=Card(
        name="brake_threshold_pressure",
        cause="springs and seals of the calipers; below 0 a sensor that reads too low",
        equation=(
            "p - p_0 above |p_0|; p_0 min(1, 2 - 2 s) in front, p_0 min(1, 2 s) in the rear; no "
            "effect at threshold = 0"
        ),
        source="Limpert, Brake Design and Safety, ch. 5 (pushout pressure)",
        looks_like="the same loss of torque at every pressure; no torque below the threshold",
        parameters=(
            Parameter("threshold", "Pa", -3e5, 10e5, 1.5e5, 1e5),
            Parameter("threshold_rear_share", "1", 0.0, 1.0, BOTH, 0.25, default=BOTH, share=True),
        ),
    ),
    pressure=pressure,
)
