"""Threshold pressure: the pressure that seals and springs need before the pads are pressed."""

import numpy as np

from calib.physics.effects.effect import Array, Card, Effect, Pair, Parameter, Parameters
from calib.physics.history import RunHistory


def pressure(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Pressure less the threshold p_0 [Pa]; zero below p_0.

    A negative pressure keeps its sign, so that sensor noise at rest keeps a mean of zero. A
    negative threshold is what a sensor reads too little: it adds to every pressure above -p_0, and
    below that less, so that a released brake stays released, read as zero or as p_0.
    """
    threshold = parameters["threshold"]
    if threshold < 0.0:
        return _read_too_low(p_f, -threshold), _read_too_low(p_r, -threshold)
    front, rear = (p - np.clip(p, -threshold, threshold) for p in (p_f, p_r))
    return front, rear


def _read_too_low(p: Array, by: float) -> Array:
    return np.asarray(p + np.minimum(np.abs(p), by))


EFFECT = Effect(
    card=Card(
        name="brake_threshold_pressure",
        cause="springs and seals of the calipers; below 0 a sensor that reads too low",
        equation="p - p_0 above |p_0|; no effect at threshold = 0",
        source="Limpert, Brake Design and Safety, ch. 5 (pushout pressure)",
        looks_like="the same loss of torque at every pressure; no torque below the threshold",
        parameters=(Parameter("threshold", "Pa", -3e5, 10e5, 1.5e5, 1e5),),
    ),
    pressure=pressure,
)
