"""Effects of pads and discs: factors on the pad friction, and on the torque of single wheels.

Fade:     T logged ------------------------------> T --> mu_p (1 - k max(T - T_0, 0))
          not logged: heat E of the run --> disc --^

Pressure: mu  |`.
              |  `-.__                  bend > 0: most of the change at light braking
              |       `````-----___
              +----------|----------> p
                       20 bar
"""

import numpy as np

from calib.base.arrays import Array
from calib.car.effects.effect import Pair, Parameters, effect
from calib.car.history import HEAT_CAPACITY, RunHistory, disc_temperature

_REFERENCE_PRESSURE = 20e5
"""Pressure [Pa] at which the pad friction is that of the model: the middle of usual braking."""

_REFERENCE_SPEED = 20.0
"""Speed [m/s] at which the pad friction is that of the model: the middle of a stop, where slope and
level are least correlated."""

_STRAIGHT = 1e-10
"""Bend [1/Pa] below which the curve is a straight line."""


def _faded(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Factors 1 - k max(T - T_0, 0) [1] on both axles.

    T of the disc [degC] is logged, or else by `disc_temperature`; k and T_0 are then those of the
    assumed disc. A straight line: not valid where little friction is left.
    """
    slope, onset = parameters["fade_slope"], parameters["fade_onset"]
    start_f, start_r = history.start_heat
    T_f, T_r = history.temperature_f, history.temperature_r
    if T_f is None:
        T_f = disc_temperature(history.time, history.energy_f, HEAT_CAPACITY["f"], start_f)
    if T_r is None:
        T_r = disc_temperature(history.time, history.energy_r, HEAT_CAPACITY["r"], start_r)
    front, rear = (1.0 - slope * np.maximum(T - onset, 0.0) for T in (T_f, T_r))
    return front, rear


def _by_speed(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Factor 1 + k (v - 20 m/s) [1] on both axles: a straight line, wrong far from 20 m/s."""
    factor = 1.0 + parameters["speed_slope"] * (history.v - _REFERENCE_SPEED)
    return factor, factor


def _by_pressure(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Factors 1 + k (p - 20 bar) [1] with p of the caliper.

    A ``pressure_bend`` b replaces p - 20 bar by 40 bar (exp(-20 bar b) - exp(-p b))/(1 - exp(-40
    bar b)), so that k is the mean slope from 0 to 40 bar. Bends of 0 to 0.2/bar cover linings that
    are described by powers of p: p^-0.1 within 3.5 % from 3 to 60 bar.
    """
    slope, bend = parameters["pressure_slope"], parameters.get("pressure_bend", 0.0)
    return 1.0 + slope * _with_bend(p_f, bend), 1.0 + slope * _with_bend(p_r, bend)


def _with_bend(p: Array, bend: float) -> Array:
    middle = _REFERENCE_PRESSURE
    if bend < _STRAIGHT:
        return p - middle
    part = (np.exp(-bend * middle) - np.exp(-bend * p)) / -np.expm1(-2.0 * bend * middle)
    return np.asarray(2.0 * middle * part)


def _drying(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Factors 1 - k exp(-E/E_d) [1] with the energy E of each axle's brake since the first sample.

    E_d of the rear is ``dry_rear_share`` of it, by default 1. Not valid if water comes later.
    """
    loss, dry = parameters["wet_loss"], parameters["dry_energy"]
    dry_rear = dry * parameters.get("dry_rear_share", 1.0)
    front = 1.0 - loss * np.exp(-history.energy_f / dry)
    return front, 1.0 - loss * np.exp(-history.energy_r / dry_rear)


def _uneven(parameters: Parameters, history: RunHistory) -> dict[str, Array]:
    """Factors on the torques of left and right wheels; side forces are neglected."""
    ones, x = np.ones_like(history.time), parameters["imbalance"]
    y = parameters["rear_share"] * x
    left_right = {"fl": 1.0 + x, "fr": 1.0 - x, "rl": 1.0 + y, "rr": 1.0 - y}
    if y == 0.0:  # both rear wheels are equal: only one of them is computed
        del left_right["rl"], left_right["rr"]
    return {wheel: factor * ones for wheel, factor in left_right.items()}


def _pulsing(parameters: Parameters, history: RunHistory) -> dict[str, Array]:
    """Factors on the torques of front discs of uneven thickness, once a turn.

    ``side`` is 0 for both discs in step, 1 for the left one only, -1 for the right one. The angle
    counts from the first sample, or from the origin that the ripple of the run sets.
    """
    wave = history.ripple(parameters["phase"])
    a, side = parameters["amplitude"], parameters["side"]
    left, right = min(1.0, 1.0 + side), min(1.0, 1.0 - side)
    return {"fl": 1.0 + a * left * wave, "fr": 1.0 + a * right * wave}


FADE = effect("pad_thermal_fade", friction=_faded)
EFFECTS = (
    FADE,
    effect("pad_speed_dependence", friction=_by_speed),
    effect("pad_pressure_dependence", friction=_by_pressure),
    effect("wet_pad_recovery", friction=_drying),
    effect("side_imbalance", wheels=_uneven),
    effect("disc_thickness_variation", wheels=_pulsing),
)
