"""Hydraulic delay: the pressure reaches the brakes after a dead time, or is logged late."""

import numpy as np

from calib.car.effects.effect import Array, Card, Effect, Pair, Parameter, Parameters
from calib.car.history import RunHistory


def pressure(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Pressure [Pa] of ``delay`` [s] earlier, linear between samples.

    A ``delay`` below zero is that of a pressure which is logged late against all other channels.
    Outside the log the pressure is that of the nearest sample.
    """
    then = history.time - parameters["delay"]
    return np.interp(then, history.time, p_f), np.interp(then, history.time, p_r)


EFFECT = Effect(
    card=Card(
        name="hydraulic_delay",
        cause="dead time between the pressure sensor and the brakes, or between their clocks",
        equation="p(t) = p_mc(t - T_d); no effect at delay = 0",
        source="Breuer and Bill, Brake Technology Handbook",
        looks_like="torque that follows the pressure later, with unchanged shape",
        parameters=(Parameter("delay", "s", -0.05, 0.5, 0.05, 0.03),),
    ),
    pressure=pressure,
)
