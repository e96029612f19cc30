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
from calib.car.disc_temperature import DISCS, heated
from calib.car.effects.effect import Pair, Parameter, Parameters, effect
from calib.car.history import RunHistory

_REFERENCE_PRESSURE = 20e5
"""Pressure [Pa] at which the pad friction is that of the model; the middle of usual braking."""

_REFERENCE_SPEED = 20.0
"""Speed [m/s] at which the pad friction is that of the model; the middle of a usual stop, where
the estimates of slope and level are least correlated."""

_STRAIGHT = 1e-10
"""Bend [1/Pa] below which the curve is a straight line to the last digits."""


def faded(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Factors 1 - k max(T - T_0, 0) [1] on both axles.

    T is that of the disc [degC]: as logged, else of an assumed disc that is at
    ``history.start_heat`` at the first sample and is heated by the brake
    (`calib.car.disc_temperature`). There k is per kelvin of that disc, and T_0 counts from that
    start. A straight line: not valid where little friction is left.
    """
    slope, onset = parameters["fade_slope"], parameters["fade_onset"]
    start_f, start_r = history.start_heat
    T_f, T_r = history.temperature_f, history.temperature_r
    if T_f is None:
        T_f = heated(history.time, history.energy_f, DISCS["f"], start_f)
    if T_r is None:
        T_r = heated(history.time, history.energy_r, DISCS["r"], start_r)
    front, rear = (1.0 - slope * np.maximum(T - onset, 0.0) for T in (T_f, T_r))
    return front, rear


def _by_speed(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """A straight line, wrong far from 20 m/s."""
    factor = 1.0 + parameters["speed_slope"] * (history.v - _REFERENCE_SPEED)
    return factor, factor


def _by_pressure(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Factor 1 + k (p - 20 bar), p of the caliper, bent with the ``pressure_bend`` b.

    Instead of p - 20 bar, 40 bar (exp(-20 bar b) - exp(-p b))/(1 - exp(-40 bar b)), so that k is
    the mean slope from 0 to 40 bar. A bend of 0 to 0.2/bar covers the powers of p by which linings
    are described: p^-0.1 within 3.5 % from 3 to 60 bar.
    """
    slope, bend = parameters["pressure_slope"], parameters.get("pressure_bend", 0.0)
    return 1.0 + slope * _beyond(p_f, bend), 1.0 + slope * _beyond(p_r, bend)


def _beyond(p: Array, bend: float) -> Array:
    middle = _REFERENCE_PRESSURE
    if bend < _STRAIGHT:
        return p - middle
    part = (np.exp(-bend * middle) - np.exp(-bend * p)) / -np.expm1(-2.0 * bend * middle)
    return np.asarray(2.0 * middle * part)


def _drying(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Each axle with the heat of its own; ``wet_loss`` at the first sample of every run.

    A rear brake has less disc and pad to dry: ``dry_rear_share`` of the energy; all of it where it
    is not given, as in older files. Not valid if water comes later.
    """
    loss, dry = parameters["wet_loss"], parameters["dry_energy"]
    dry_rear = dry * parameters.get("dry_rear_share", 1.0)
    front = 1.0 - loss * np.exp(-history.energy_f / dry)
    return front, 1.0 - loss * np.exp(-history.energy_r / dry_rear)


def _uneven(parameters: Parameters, history: RunHistory) -> dict[str, Array]:
    """The driver keeps the car straight; side forces are neglected."""
    one, x = np.ones_like(history.time), parameters["imbalance"]
    y = parameters["rear_share"] * x
    left_right = {"fl": 1.0 + x, "fr": 1.0 - x, "rl": 1.0 + y, "rr": 1.0 - y}
    if y == 0.0:  # both rear wheels are equal: only one of them is computed
        del left_right["rl"], left_right["rr"]
    return {wheel: factor * one for wheel, factor in left_right.items()}


def _pulsing(parameters: Parameters, history: RunHistory) -> dict[str, Array]:
    """``side`` is 0 when both discs pulse in step, 1 when only the left one does, -1 the right one.

    The angle counts from the first sample, unless its origin was set by the ripple of the run.
    """
    turned = history.ripple(parameters["phase"])
    a, side = parameters["amplitude"], parameters["side"]
    left, right = min(1.0, 1.0 + side), min(1.0, 1.0 - side)
    return {"fl": 1.0 + a * left * turned, "fr": 1.0 + a * right * turned}


FADE = effect(
    "pad_thermal_fade",
    Parameter("fade_slope", "1/K", 0.0, 0.005, 0.001, 0.0005),
    Parameter("fade_onset", "degC", 0.0, 500.0, 150.0, 60.0),
    cause="the binder of the pads decomposes above a temperature",
    equation="mu_p (1 - k max(T - T_0, 0)); no effect at fade_slope = 0",
    source="Limpert, Brake Design and Safety, ch. 3; Breuer and Bill, Brake Technology",
    looks_like="less torque at the same pressure on hot discs, no change on cold ones; without "
    "a log of T the heat at the start of each log is found with it, less exactly: log T",
    friction=faded,
)
EFFECTS = (
    FADE,
    effect(
        "pad_speed_dependence",
        Parameter("speed_slope", "s/m", -0.02, 0.02, -0.004, 0.004),
        cause="pad friction changes with the sliding speed",
        equation="mu_p (1 + k (v - 20 m/s)); no effect at speed_slope = 0",
        source="Limpert, Brake Design and Safety, ch. 3; ISO 15484",
        looks_like="torque that grows (k < 0) towards the end of a stop at constant pressure",
        friction=_by_speed,
    ),
    effect(
        "pad_pressure_dependence",
        Parameter("pressure_slope", "1/Pa", -1e-7, 1e-7, -2e-8, 2e-8),
        Parameter("pressure_bend", "1/Pa", 0.0, 4e-6, 2e-7, 4e-7, default=0.0),
        cause="pad friction changes with the contact pressure",
        equation="mu_p (1 + k (p - 20 bar)), most of it at light braking with a bend b > 0; no "
        "effect at pressure_slope = 0",
        source="Limpert, Brake Design and Safety, ch. 3; ISO 15484",
        looks_like="torque that is not proportional to pressure, at any speed and temperature",
        friction=_by_pressure,
    ),
    effect(
        "wet_pad_recovery",
        Parameter("wet_loss", "1", 0.0, 0.95, 0.3, 0.15),
        Parameter("dry_energy", "J", 1e3, 1e6, 60e3, 40e3),
        Parameter("dry_rear_share", "1", 0.2, 2.0, 0.8, 0.3, default=1.0),
        cause="a film of water on disc and pads that the heat of braking removes",
        equation="mu_p (1 - a exp(-E/E_0)), E heat of one brake, E_0 less at the rear; "
        "no effect at wet_loss = 0",
        source="Breuer and Bill, Brake Technology Handbook",
        looks_like="weak brakes at the first application that recover with energy, not with time",
        friction=_drying,
    ),
    effect(
        "side_imbalance",
        Parameter("imbalance", "1", -0.5, 0.5, 0.08, 0.05),
        Parameter("rear_share", "1", -0.2, 1.2, 0.5, 0.5),
        cause="pads, pistons or discs that differ between left and right",
        equation="front T_b (1 +- x), rear T_b (1 +- r x), left +; no effect at imbalance = 0",
        source="Limpert, Brake Design and Safety, ch. 7; UN R13-H, annex 3",
        looks_like="left and right slips differ in proportion to torque, only while braked",
        wheels=_uneven,
    ),
    effect(
        "disc_thickness_variation",
        Parameter("amplitude", "1", 0.0, 0.3, 0.03, 0.02),
        Parameter("phase", "rad", -np.pi, np.pi, 0.0, 0.5),
        Parameter("side", "1", -1.0, 1.0, 0.0, 0.8),
        cause="front discs whose thickness varies around the turn (judder)",
        equation="front T_b (1 + a sin(angle + phase)), 1 or 2 discs; no effect at amplitude = 0",
        source="Jacobsson, Aspects of Disc Brake Judder, Proc. IMechE D 217 (2003)",
        looks_like="a_x and front wheel speeds that pulse with the wheel's turn while braking",
        wheels=_pulsing,
    ),
)
