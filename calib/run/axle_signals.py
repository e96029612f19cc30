r"""Axle signals of a log on one clock.

    log --> axle means, z --> blocks of 50 ms (causal: a block is complete at its end)
                         \-> lead-in: the unbraked part before the first braking
                          \-> noise: of each sensor, white and coloured

Wheel speeds of an axle are averaged left and right: steering and road crown cancel to first order.
A tone ring with run-out or a damaged tooth has an error that repeats with the wheel angle phi:

    omega read = omega (1 + sum_k a_k cos(k phi) + b_k sin(k phi))      k = 1, 2

Run-out of 0.05 mm on a radius of 50 mm makes 0.1 % once a turn, a third of what a braking changes
eta; an oval ring errs twice a turn. A mean over one turn is free of it, so omega over that mean
shows error and noise. a_k and b_k are constant over a log.
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
from calib.car.lag import integral
from calib.logs.log import Log
from calib.run.driving_record import NOMINAL_RADIUS, SETTLE, rolls
from calib.run.filters import centred_mean, samples_in, trailing_mean
from calib.run.speed_delay import IN_TIME, SpeedDelay, in_time, speed_delay


@dataclass(frozen=True, kw_only=True)
class AxleSignals:
    """Signals by axle, shapes (n,), SI.

    ``p_f``, ``p_r`` pressures (of the wheels where logged, else of the master cylinder);
    ``drive_f``, ``drive_r`` torque of engine or motor [N m per axle], zero where not logged;
    ``z`` (5); ``v`` reference speed, its delay corrected; None where it is missing, held for
    longer than `_HELD`, or its delay is uncertain; ``speed`` v, else that of the rear wheels.
    """

    p_f: Array
    p_r: Array
    drive_f: Array
    drive_r: Array
    z: Array
    omega_f: Array
    omega_r: Array
    v: Array | None
    speed: Array
    lead_in: Mask


@dataclass(frozen=True, kw_only=True)
class Signals(AxleSignals):
    """Axle signals at the samples of a log; ``time`` and ``sample_time`` [s], ``delay`` of v."""

    time: Array
    sample_time: float
    delay: SpeedDelay = IN_TIME

    def take(self, rows: Index) -> "Signals":
        """The samples at ``rows`` alone."""
        arrays: dict[str, Any] = {k: x[rows] for k, x in vars(self).items() if np.ndim(x)}
        return replace(self, **arrays)


def eta_of(omega_f: Array, omega_r: Array) -> Array:
    """omega_r/omega_f of (22) [1]; 1 where the front wheels stand still."""
    return np.divide(omega_r, omega_f, out=np.ones_like(omega_f), where=omega_f > 0.0)


def signals(log: Log, radius: float = NOMINAL_RADIUS) -> Signals:
    """Axle signals of a log, ``radius`` of its rear wheels [m]; LogError if it hardly moves."""
    read, step = causal_signals(log, radius), log.sample_time
    omega_f, omega_r = (
        0.5
        * (_without_runout(log[f"omega_{a}l"], step) + _without_runout(log[f"omega_{a}r"], step))
        for a in AXLES
    )
    v, delay = _reference_speed(log)
    speed = radius * omega_r if v is None else v
    if np.max(speed) < MOVING:
        raise LogError(
            f"the car hardly moves: at most {np.max(speed):.1f} m/s",
            where=log.source,
            expected="a braking from more than 8 m/s",
        )
    rolling = _lead_in(log.time, np.maximum(read.p_f, read.p_r), read.z, speed, step)
    rolling &= _undisturbed(eta_of(omega_f, omega_r), rolling, step)
    return replace(
        read,
        omega_f=omega_f,
        omega_r=omega_r,
        v=v,
        speed=speed,
        lead_in=rolling,
        delay=delay,
    )


def causal_signals(log: Log, radius: float) -> Signals:
    """Axle signals as an ECU has them, causal: wheel speeds as read, no v, no lead-in."""
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


def _reference_speed(log: Log) -> tuple[Array | None, SpeedDelay]:
    """The reference speed [m/s] (n,), its delay corrected (None if unusable), and that delay."""
    if "v" not in log or held_time(log) > _HELD:
        return None, IN_TIME
    clock, v, a_x = log.time, log["v"], log["a_x"]
    delay = speed_delay(clock, v, a_x, log.sample_time)
    if not delay.late:
        return v, delay
    return in_time(clock, v, a_x, delay) if delay.sharp else None, delay


def rolling_radii(s: Signals) -> tuple[float, float] | None:
    """Rolling radii [m] of front and rear wheels on the lead-in; None without v or a lead-in."""
    if s.v is None or not s.lead_in.any():
        return None
    speed = np.mean(s.v[s.lead_in])
    front, rear = (float(speed / np.mean(omega[s.lead_in])) for omega in (s.omega_f, s.omega_r))
    return front, rear


_HELD = 0.06
"""Longest time between two values of v [s]: a 10 Hz satellite receiver, held in between, is late
by half its step, and its steps are 1 % of the speed."""

_SLOWING = 1.0  # deceleration at which a speed changes from sample to sample [m/s^2]


def held_time(log: Log, channel: str = "v", moving: float = MOVING) -> float:
    """Mean time [s] for which a channel above ``moving`` holds a value while it slows, or 0."""
    if channel not in log or "a_x" not in log:
        return 0.0
    x, slowing = log[channel], log["a_x"] < -_SLOWING
    slowing &= x > moving
    count = int(slowing.sum())
    if count * log.sample_time < 0.5:
        return 0.0
    changes = int(np.count_nonzero(np.diff(x)[slowing[1:]]))
    return count * log.sample_time / max(changes, 1)


def wheels_held(log: Log) -> float:
    """Mean time [s] for which a wheel speed holds a value while the car slows; median of four."""
    times = [held_time(log, f"omega_{w}", MOVING / NOMINAL_RADIUS) for w in WHEELS]
    return float(np.median(times))


def axle_pressure(log: Log, axle: str) -> Array:
    """Mean of both wheel pressures [Pa] if both are logged, else the master cylinder's."""
    left, right = f"p_{axle}l", f"p_{axle}r"
    if left in log and right in log:
        return 0.5 * (log[left] + log[right])
    return log["p_mc"]


_SMOOTH = 0.05  # time over which a pressure, or eta, is averaged before it is compared [s]


def _lead_in(time: Array, pressure: Array, z: Array, speed: Array, step: float) -> Mask:
    """Mask (n,) of steady rolling until ``SETTLE`` [s] before the first braking, if there is one.

    It ends earlier where the pressure leaves its level at rest: a slow pedal brakes long before
    ``BITE``. Acceleration is left out: driven wheels slip, so that eta cannot be zeroed there.
    """
    smooth = trailing_mean(pressure, samples_in(_SMOOTH, step))
    braked = np.flatnonzero(smooth > BITE)
    first = np.inf
    if braked.size:
        unbraked = smooth[: braked[0] + 1]
        level = float(np.median(unbraked))
        leaves = np.flatnonzero(unbraked <= level + 3.0 * scatter(unbraked - level))[-1]
        first = min(time[braked[0]] - SETTLE, time[leaves]) - _SMOOTH
    rolling = rolls(trailing_mean(z, samples_in(0.1, step)))
    return np.asarray((time < first) & rolling & (speed > MOVING))


_DISTURBED = 4.0
"""Deviation of eta from its median at the end of the lead-in, over its scatter, beyond which it is
no noise: the engine still drives an axle, or a wheel runs over something."""
FINEST = 1e-5  # least scatter of eta [1]: simulated logs may have none
_LEAST = 0.5  # shortest lead-in with a known scatter; length of its end that gives the median [s]


def _undisturbed(eta: Array, rolling: Mask, step: float) -> Mask:
    """Mask (n,) without the samples in which ``eta`` is disturbed while ``rolling``; ``step`` [s].

    A clutch that opens late drives an axle with 0.1 % slip, which would move the zero of eta.
    """
    if np.count_nonzero(rolling) * step < _LEAST:
        return np.ones_like(rolling)
    width = samples_in(_SMOOTH, step)
    smooth = centred_mean(eta, width)
    lead_in = smooth[rolling]
    bite = 0 if rolling[-1] else -round(_LEAST / step)  # a coast has none: all of it counts alike
    away = np.abs(smooth - np.median(lead_in[bite:]))
    apart = np.abs(lead_in[4 * width :] - lead_in[: -4 * width])  # a step is in few of them
    usual = scatter(apart) / math.sqrt(2.0)
    odd = away > _DISTURBED * max(usual, FINEST)
    return np.asarray(centred_mean(odd.astype(float), 2 * width) == 0.0)


_SLOWEST = 15.0  # wheel speed [rad/s] below which a turn takes longer than a brake to build up
_TURNS = 20  # fewest turns that separate an error of the ring from motion of the car
_COARSEST = 0.5 * np.pi  # largest angle between two samples [rad]: twice a turn must be seen
_FEWEST = 100  # samples
_LEAST_ERROR = 2e-4  # error below which a ring is good [1]
_SURE = 6.0
"""Amplitude over its sigma by white noise from which an order is an error of the ring. In 327 logs
with good rings the largest of a log (eight orders) has a median of 2.4, and is at most 5."""
_ALIKE = 0.5
"""Largest difference between both halves of a log over the error [1] of a ring. What is not of the
ring, as the noise of a slow bus, has another phase in each half."""


def _without_runout(omega: Array, step: float) -> Array:
    """A wheel speed [rad/s] (n,) without the error of its ring, if that is sure; ``step`` [s]."""
    time = step * np.arange(omega.size, dtype=np.float64)
    angle = integral(time, omega)
    inside = (omega > _SLOWEST) & (omega * step < _COARSEST)
    inside &= (angle > np.pi) & (angle < angle[-1] - np.pi)
    if np.count_nonzero(inside) < _FEWEST or angle[-1] < 2.0 * np.pi * _TURNS:
        return omega
    rising = np.maximum.accumulate(angle)
    angles = angle[inside]
    turn = np.interp(angles + np.pi, rising, time) - np.interp(angles - np.pi, rising, time)
    apart = omega[inside] * turn / (2.0 * np.pi) - 1.0
    near = np.abs(apart) <= 5.0 * max(scatter(apart), 1e-9)
    if np.count_nonzero(near) < _FEWEST:
        return omega
    apart, columns = apart[near], _turning(angles[near])
    first, second = slice(apart.size // 2), slice(apart.size // 2, None)
    whole, early, late = (
        np.linalg.solve(columns[:, of] @ columns[:, of].T, columns[:, of] @ apart[of])
        for of in (slice(None), first, second)
    )
    size, changed = (np.hypot(x[0::2], x[1::2]) for x in (whole, early - late))
    sigma = float(np.std(apart - whole @ columns)) * np.sqrt(2.0 / apart.size)
    sure = (size > max(_SURE * sigma, _LEAST_ERROR)) & (changed < _ALIKE * size)
    return omega / (1.0 + (whole * np.repeat(sure, 2)) @ _turning(angle)) if sure.any() else omega


def _turning(angle: Array) -> Array:
    """Cosine and sine (4, n) of once and twice the ``angle`` (n,)."""
    once, again = np.cos(angle), np.sin(angle)
    return np.stack([once, again, once**2 - again**2, 2.0 * once * again])
