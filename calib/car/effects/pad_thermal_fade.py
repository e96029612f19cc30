"""Thermal fade: hot pads lose friction.

T logged ------------------------------> T --> mu_p (1 - k max(T - T_0, 0))
not logged: heat E of the run --> disc --^
"""

import numpy as np

from calib.car.disc_temperature import DISCS, heated
from calib.car.effects.effect import Array, Card, Effect, Pair, Parameter, Parameters
from calib.car.history import RunHistory


def friction(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Factor 1 - k max(T - T_0, 0) [1] on both axles.

    T is that of the disc [degC]: as logged, else of an assumed disc that is at
    ``history.start_heat`` at the first sample and is heated by the brake
    (`calib.car.disc_temperature`). There k is per kelvin of that disc, and T_0 counts from that
    start. A straight line: not valid where little friction is left.
    """
    slope, onset = parameters["fade_slope"], parameters["fade_onset"]
    front, rear = (
        1.0 - slope * np.maximum(T - onset, 0.0)
        for T in (
            _temperature(history, "f", history.temperature_f, history.energy_f),
            _temperature(history, "r", history.temperature_r, history.energy_r),
        )
    )
    return front, rear


def _temperature(history: RunHistory, axle: str, logged: Array | None, energy: Array) -> Array:
    if logged is not None:
        return logged
    front, rear = history.start_heat
    return heated(history.time, energy, DISCS[axle], front if axle == "f" else rear)


EFFECT = Effect(
    card=Card(
        name="pad_thermal_fade",
        cause="the binder of the pads decomposes above a temperature",
        equation="mu_p (1 - k max(T - T_0, 0)); no effect at fade_slope = 0",
        source="Limpert, Brake Design and Safety, ch. 3; Breuer and Bill, Brake Technology",
        looks_like=(
            "less torque at the same pressure on hot discs, no change on cold ones; without a log "
            "of T the heat at the start of each log is found with it, less exactly: log T"
        ),
        parameters=(
            Parameter("fade_slope", "1/K", 0.0, 0.005, 0.001, 0.0005),
            Parameter("fade_onset", "degC", 0.0, 500.0, 150.0, 60.0),
        ),
    ),
    friction=friction,
)
