"""Effects of pads and discs: factors on the pad friction mu_p, and on the torque of single wheels.

The friction over the pressure p is a straight line, or with a bend it changes most at light
braking:

    mu_p |`.
         |  `-.__
         |       `````-----___
         +----------|----------> p
                  20 bar
"""

import numpy as np

from calib.base.arrays import Array
from calib.car.effects.effect import Pair, Parameters, effect, sides
from calib.car.history import HEAT_CAPACITY, RunHistory, disc_temperature

_REFERENCE_PRESSURE = 20e5  # p_0 [Pa], at which the factor is 1: usual braking
_REFERENCE_SPEED = 20.0  # speed [m/s] of factor 1: mid-stop, where slope and level correlate least
_STRAIGHT = 1e-10  # bend [1/Pa] below which the curve is a straight line


def _faded(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Factors 1 - k max(T - T_0, 0) [1] on both axles; not valid where little friction is left.

    The disc temperature T [degC] is logged, or computed by `disc_temperature`; then k and T_0 hold
    for the assumed heat capacity.
    """
    slope, onset = parameters["fade_slope"], parameters["fade_onset"]
    start_f, start_r = history.start_heat
    T_f, T_r = history.temperature_f, history.temperature_r
    if T_f is None:
        T_f = disc_temperature(history.time, history.energy_f, HEAT_CAPACITY["f"], start_f)
    if T_r is None:
        T_r = disc_temperature(history.time, history.energy_r, HEAT_CAPACITY["r"], start_r)
    front = 1.0 - slope * np.maximum(T_f - onset, 0.0)
    return front, 1.0 - slope * np.maximum(T_r - onset, 0.0)


def _by_speed(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Factor 1 + k (v - 20 m/s) [1] on both axles; not valid far from 20 m/s."""
    factor = 1.0 + parameters["speed_slope"] * (history.v - _REFERENCE_SPEED)
    return factor, factor


def _by_pressure(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Factors 1 + k (p - p_0) [1] with the caliper pressure p.

    A ``pressure_bend`` b replaces p - p_0 by

        2 p_0 (exp(-b p_0) - exp(-b p))/(1 - exp(-2 b p_0))

    so that k is the mean slope from 0 to 2 p_0. Bends up to 0.2/bar also fit a friction that is a
    power of p, such as p^-0.1 within 3.5 % from 3 to 60 bar.
    """
    slope, bend = parameters["pressure_slope"], parameters.get("pressure_bend", 0.0)
    return 1.0 + slope * _above_reference(p_f, bend), 1.0 + slope * _above_reference(p_r, bend)


def _above_reference(p: Array, bend: float) -> Array:
    """p - p_0 [Pa] (n,), or the expression in `_by_pressure` that replaces it at a ``bend``."""
    p_0 = _REFERENCE_PRESSURE
    if bend < _STRAIGHT:
        return p - p_0
    share = (np.exp(-bend * p_0) - np.exp(-bend * p)) / -np.expm1(-2.0 * bend * p_0)
    return np.asarray(2.0 * p_0 * share)


def _drying(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Factors 1 - a exp(-E/E_0) [1] of wet pads, which the heat E of each brake dries.

    E counts from the first sample. E_0 is ``dry_energy`` in front; a rear brake has the share
    ``dry_rear_share``, by default 1, of this energy. Not valid if water comes later.
    """
    a, E_0 = parameters["wet_loss"], parameters["dry_energy"]
    E_0_rear = E_0 * parameters.get("dry_rear_share", 1.0)
    front = 1.0 - a * np.exp(-history.energy_f / E_0)
    return front, 1.0 - a * np.exp(-history.energy_r / E_0_rear)


def _uneven(parameters: Parameters, history: RunHistory) -> dict[str, Array]:
    """Factors [1] on the torques of left and right wheels; lateral forces are neglected."""
    ones, front = np.ones_like(history.time), parameters["imbalance"]
    rear = parameters["rear_share"] * front
    factors = {"fl": (1.0 + front) * ones, "fr": (1.0 - front) * ones}
    if rear != 0.0:  # at 0 the rear wheels are equal, and only the left one is computed
        factors |= {"rl": (1.0 + rear) * ones, "rr": (1.0 - rear) * ones}
    return factors


def _pulsing(parameters: Parameters, history: RunHistory) -> dict[str, Array]:
    """Factors [1] on the torques of front discs of uneven thickness, one wave a turn.

    Both discs are in step, or one is alone, see `sides`. The phase is that of `RunHistory.ripple`.
    """
    a, wave = parameters["amplitude"], history.ripple(parameters["phase"])
    left, right = sides(parameters["side"])
    return {"fl": 1.0 + a * left * wave, "fr": 1.0 + a * right * wave}


EFFECTS = (
    effect("pad_thermal_fade", friction=_faded),
    effect("pad_speed_dependence", friction=_by_speed),
    effect("pad_pressure_dependence", friction=_by_pressure),
    effect("wet_pad_recovery", friction=_drying),
    effect("side_imbalance", wheels=_uneven),
    effect("disc_thickness_variation", wheels=_pulsing),
)
