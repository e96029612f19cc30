"""Signals of the axles of a log: pressures, deceleration, wheel speeds, v, and the lead-in.

    log --signals--> Signals           with the lead-in and with v, the delay of v corrected
    log --causal_signals--> Signals    as an ECU has them

The lead-in is the unbraked rolling before the first braking, on which eta is zeroed. The speed of
an axle is the mean of left and right wheel: steering and road crown cancel to first order.
"""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.base.errors import LogError
from calib.base.intervals import scatter
from calib.base.names import AXLES, WHEELS
from calib.car.braking import BITE, MOVING
from calib.car.forces import deceleration
from calib.logs.log import Log
from calib.run.driving_record import NOMINAL_RADIUS, SETTLE, is_rolling
from calib.run.filters import centred_mean, samples_in, trailing_mean
from calib.run.runout import without_runout
from calib.run.speed_delay import IN_TIME, SpeedDelay, in_time, speed_delay

_HELD = 0.06
"""Longest time between two values of v [s] for which v is used. The value of a 10 Hz satellite
receiver, held in between, is late by half its step, and its steps are 1 % of the speed."""
_SLOWING = 1.0  # deceleration at which a speed changes from sample to sample [m/s^2]
_SHORT = 0.05  # width of the means of pressure and eta by which the lead-in is judged [s]
_DISTURBED = 4.0
"""Deviation of eta from its usual value, over its scatter [1], beyond which it is no noise: an
engine still drives an axle, or a wheel runs over something."""
_FINEST = 1e-5  # least scatter of eta [1]: simulated logs may have none
_LAST = 0.5  # end of a lead-in that gives the usual eta [s]; shorter lead-ins are not judged


@dataclass(frozen=True, kw_only=True)
class AxleSignals:
    """Signals by axle, shapes (n,), SI."""

    p_f: Array  # pressure of the wheels if logged, else of the master cylinder [Pa]
    p_r: Array
    drive_f: Array  # torque of engine or motor at the axle, zero if not logged [N m]
    drive_r: Array
    z: Array  # deceleration (5) [1]
    omega_f: Array
    omega_r: Array
    v: Array | None  # reference speed, its delay corrected [m/s]; None without a usable one
    speed: Array  # v, or without v that of the rear wheels [m/s]
    lead_in: Mask


@dataclass(frozen=True, kw_only=True)
class Signals(AxleSignals):
    """Axle signals at the samples of a log."""

    time: Array  # [s]
    sample_time: float  # [s]
    delay: SpeedDelay = IN_TIME  # of v as read

    def take(self, rows: Index) -> "Signals":
        """Return the samples at ``rows`` alone."""
        arrays: Any = {k: x[rows] for k, x in vars(self).items() if isinstance(x, np.ndarray)}
        return replace(self, **arrays)


def eta_of(omega_f: Array, omega_r: Array) -> Array:
    """omega_r/omega_f of (22) [1]; 1 where the front wheels stand still."""
    return np.divide(omega_r, omega_f, out=np.ones_like(omega_f), where=omega_f > 0.0)


def signals(log: Log, radius: float = NOMINAL_RADIUS) -> Signals:
    """Axle signals of a log with rear wheels of a ``radius`` [m]; LogError if it hardly moves."""
    causal, step = causal_signals(log, radius), log.sample_time
    wheels = {w: without_runout(log[f"omega_{w}"], step) for w in WHEELS}
    omega_f, omega_r = (0.5 * (wheels[f"{a}l"] + wheels[f"{a}r"]) for a in AXLES)
    v, delay = _reference_speed(log)
    speed = radius * omega_r if v is None else v
    if np.max(speed) < MOVING:
        raise LogError(
            f"the car hardly moves: at most {np.max(speed):.1f} m/s",
            where=log.source,
            expected="a braking from more than 8 m/s",
        )
    rolling = _before_braking(log.time, np.maximum(causal.p_f, causal.p_r), step)
    rolling &= is_rolling(trailing_mean(causal.z, samples_in(0.1, step))) & (speed > MOVING)
    rolling &= _undisturbed(eta_of(omega_f, omega_r), rolling, step)
    return replace(
        causal, omega_f=omega_f, omega_r=omega_r, v=v, speed=speed, lead_in=rolling, delay=delay
    )


def causal_signals(log: Log, radius: float) -> Signals:
    """Axle signals as an ECU has them: wheel speeds as read, no v, no lead-in."""
    omega_f, omega_r = (0.5 * (log[f"omega_{a}l"] + log[f"omega_{a}r"]) for a in AXLES)
    drive_f, drive_r = (log.channels.get(f"T_drive_{a}", np.zeros_like(log.time)) for a in AXLES)
    return Signals(
        time=log.time,
        p_f=axle_pressure(log, "f"),
        p_r=axle_pressure(log, "r"),
        drive_f=drive_f,
        drive_r=drive_r,
        z=deceleration(log["a_x"]),
        omega_f=omega_f,
        omega_r=omega_r,
        v=None,
        speed=radius * omega_r,
        lead_in=np.zeros(log.time.size, bool),
        sample_time=log.sample_time,
    )


def axle_pressure(log: Log, axle: str) -> Array:
    """Mean of both wheel pressures [Pa] if both are logged, else the master cylinder's."""
    left, right = f"p_{axle}l", f"p_{axle}r"
    if left in log and right in log:
        return 0.5 * (log[left] + log[right])
    return log["p_mc"]


def _reference_speed(log: Log) -> tuple[Array | None, SpeedDelay]:
    """Return `AxleSignals.v` and the delay of v as read."""
    if "v" not in log or held_time(log) > _HELD:
        return None, IN_TIME
    time, v, a_x = log.time, log["v"], log["a_x"]
    delay = speed_delay(time, v, a_x, log.sample_time)
    if not delay.late:
        return v, delay
    if not delay.sharp:
        return None, delay
    return in_time(time, v, a_x, delay), delay


def held_time(log: Log, channel: str = "v", moving: float = MOVING) -> float:
    """Mean time [s] for which a speed above ``moving`` keeps a value while the car slows, or 0."""
    if channel not in log or "a_x" not in log:
        return 0.0
    x, slowing = log[channel], log["a_x"] < -_SLOWING
    slowing &= x > moving
    count = int(slowing.sum())
    if count * log.sample_time < 0.5:
        return 0.0
    changes = int(np.count_nonzero(np.diff(x)[slowing[1:]]))
    return count * log.sample_time / max(changes, 1)


def _before_braking(time: Array, pressure: Array, step: float) -> Mask:
    """Mask (n,) until `SETTLE` before the first braking; all true without one.

    It ends earlier if the pressure leaves its level at rest earlier, as with a slow pedal, and
    another `_SHORT` earlier, since the pressure is averaged over that time.
    """
    smooth = trailing_mean(pressure, samples_in(_SHORT, step))
    braked = np.flatnonzero(smooth > BITE)
    if not braked.size:
        return np.ones(time.size, bool)
    unbraked = smooth[: braked[0] + 1]
    level = float(np.median(unbraked))
    last_at_rest = np.flatnonzero(unbraked <= level + 3.0 * scatter(unbraked - level))[-1]
    return np.asarray(time < min(time[braked[0]] - SETTLE, time[last_at_rest]) - _SHORT)


def _undisturbed(eta: Array, rolling: Mask, step: float) -> Mask:
    """Mask (n,) that is false where ``eta`` is disturbed, as by a clutch that opens late.

    The usual eta is the median over the last `_LAST` before a braking, or over all of a coast.
    """
    if np.count_nonzero(rolling) * step < _LAST:
        return np.ones_like(rolling)
    width = samples_in(_SHORT, step)
    smooth = centred_mean(eta, width)
    lead_in = smooth[rolling]
    is_coast = rolling[-1]
    usual = np.median(lead_in if is_coast else lead_in[-round(_LAST / step) :])
    # Means 4 widths apart share no sample: their difference has sqrt(2) of the noise of one. A jump
    # of eta lies within few of the differences, which `scatter` ignores.
    differences = np.abs(lead_in[4 * width :] - lead_in[: -4 * width])
    sigma = max(scatter(differences) / math.sqrt(2.0), _FINEST)
    disturbed = np.abs(smooth - usual) > _DISTURBED * sigma
    return np.asarray(centred_mean(disturbed.astype(float), 2 * width) == 0.0)
