"""Thermal fade: hot pads lose friction."""

import numpy as np

from calib.physics.effects.effect import Array, Card, Effect, Pair, Parameter, Parameters
from calib.physics.history import RunHistory


def friction(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Factor 1 - k max(T - T_0, 0) [1] on both axles; 1 where the temperature is not known.

    T is that of the disc [degC]. A straight line: not valid where little friction is left.
    """
    slope, onset = parameters["fade_slope"], parameters["fade_onset"]
    front, rear = (
        np.ones_like(p) if T is None else 1.0 - slope * np.maximum(T - onset, 0.0)
        for T, p in ((history.temperature_f, p_f), (history.temperature_r, p_r))
    )
    return front, rear


EFFECT = Effect(
    card=Card(
        name="pad_thermal_fade",
        cause="the binder of the pads decomposes above a temperature",
        equation="mu_p (1 - k max(T - T_0, 0)); no effect at fade_slope = 0",
        source="Limpert, Brake Design and Safety, ch. 3; Breuer and Bill, Brake Technology",
        looks_like="less torque at the same pressure on hot discs, no change on cold ones",
        parameters=(
            Parameter("fade_slope", "1/K", 0.0, 0.005, 0.001, 0.0005),
            Parameter("fade_onset", "degC", 0.0, 500.0, 150.0, 60.0),
        ),
    ),
    friction=friction,
)
