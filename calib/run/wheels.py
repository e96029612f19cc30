"""Comparison of the four wheels of a log, by their slips.

`axles_of` gives the ratios of the wheel speeds, the radii and the sign of a_x, `slipping` the ABS
cycles and the locked wheels.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array, Mask
from calib.base.names import WHEELS, G
from calib.base.warning import LIMITS
from calib.car.braking import MOVING
from calib.logs.log import Log
from calib.run.driving_record import NOMINAL_RADIUS, DrivingRecord
from calib.run.filters import block_mean, centred_mean, median_of_three, samples_in, true_intervals

LOW, HIGH = 0.1, 0.5  # range of deceleration in which the wheels are compared [1]


def slips_of(log: Log, driving: DrivingRecord) -> dict[str, Array]:
    """Slip of each wheel [1] (n,), smoothed over 30 ms, without errors of single samples.

    With ``v`` and unbraked rolling, each slip is zeroed while the car rolls. Otherwise the speed of
    the fastest wheel stands for that of the car.
    """
    width = samples_in(0.03, driving.step) | 1
    omega = {w: centred_mean(median_of_three(log[f"omega_{w}"]), width) for w in WHEELS}
    free = driving.unbraked
    speed, radius = np.max(list(omega.values()), axis=0), dict.fromkeys(WHEELS, 1.0)
    if "v" in log and free.any():
        speed = centred_mean(log["v"], width)
        for w in WHEELS:
            radius[w] = float(np.median(speed[free] / np.maximum(omega[w][free], 1e-6)))
    floor = np.maximum(speed, 1e-6)
    return {w: 1.0 - radius[w] * omega[w] / floor for w in WHEELS}


@dataclass(frozen=True)
class IntervalEstimate:
    """A value with the half width of its 95 % interval."""

    value: float
    half: float


def mismatch(a: Array, b: Array, mask: Mask, step: float) -> IntervalEstimate | None:
    """Mean of b/a - 1 of two wheel speeds within ``mask`` [1]; None with fewer than three blocks.

    The interval takes the blocks as independent: it does not count a slow drift, as in a bend.
    """
    ratio = _ratios(a, b, mask, step)
    if ratio.size < 3:
        return None
    return IntervalEstimate(float(np.mean(ratio)), float(half_width(ratio)))


def half_width(x: Array, other_count: float = np.inf) -> Array:
    """Half width of the 95 % interval of the mean of k independent values ``x`` (..., k).

    With ``other_count`` it is for this mean less another mean, of so many values of equal noise.
    """
    from scipy.special import stdtrit

    count = x.shape[-1]
    share = np.sqrt(1.0 / count + 1.0 / other_count)
    return np.asarray(stdtrit(count - 1, 0.975) * np.std(x, axis=-1, ddof=1) * share)


def wheel_means(x: Array, mask: Mask, step: float) -> Array:
    """Means of ``x`` (..., n) within ``mask`` (n,) over blocks of 0.2 s, (..., k)."""
    return block_mean(x[..., mask], samples_in(LIMITS.wheel_block, step))


def _ratios(a: Array, b: Array, mask: Mask, step: float) -> Array:
    """b/a - 1 of the block means of two wheel speeds [1] (k,), without blocks where a is zero."""
    first, second = wheel_means(np.stack([a, b]), mask, step)
    turns = first > 0.0
    return np.asarray(second[turns] / first[turns] - 1.0)


@dataclass(frozen=True)
class Axles:
    """Comparison of the wheels; a field is None where its part of the log is too short."""

    front_rear: IntervalEstimate | None  # eta - 1, unbraked [1]: positive for a small rear radius
    left_right_f: IntervalEstimate | None  # right over left wheel speed - 1, unbraked [1]
    left_right_r: IntervalEstimate | None
    radius: float | None  # median of v over the wheel speed, unbraked [m]
    slope: float | None  # -a_x over the wheels' deceleration [m]: a radius, < 0 with a wrong sign
    eta_braked: IntervalEstimate | None  # mean eta at 0.2 to 0.5 g less that unbraked [1]
    eta_most: IntervalEstimate | None  # the same at 0.1 to 0.5 g, of the third where it is largest


def axles_of(log: Log, driving: DrivingRecord, slips: Mapping[str, Array]) -> Axles:
    """Compare the wheels of a log with ``a_x`` and four wheel speeds; ``slips`` of `slips_of`."""
    fl, fr, rl, rr = (log[f"omega_{w}"] for w in WHEELS)
    front, rear, free = 0.5 * (fl + fr), 0.5 * (rl + rr), driving.unbraked
    zero = mismatch(front, rear, free, driving.step)
    moderate = driving.braked & (driving.wheel_z < HIGH) & (driving.speed > 5.0)
    braked = mismatch(front, rear, moderate & (driving.wheel_z > 0.2), driving.step)
    braking = moderate & (driving.wheel_z > LOW)
    change = None
    if braked is not None and zero is not None:
        half = float(np.hypot(braked.half, zero.half))
        change = IntervalEstimate(braked.value - zero.value, half)
    return Axles(
        front_rear=zero,
        left_right_f=mismatch(fl, fr, free, driving.step),
        left_right_r=mismatch(rl, rr, free, driving.step),
        radius=rolling_radius(log, driving),
        slope=_slope_over_wheels(driving, _no_deep_slip(slips, driving)),
        eta_braked=change,
        eta_most=_largest_change(front, rear, free, braking, driving.step),
    )


def _largest_change(
    front: Array, rear: Array, free: Mask, braking: Mask, step: float
) -> IntervalEstimate | None:
    """Largest change of eta from ``free`` rolling to a third of the ``braking`` [1]."""
    rolling, slipping = (_ratios(front, rear, mask, step) for mask in (free, braking))
    if min(rolling.size, slipping.size) < 3:
        return None
    thirds = np.array_split(slipping, 3)  # eta rises and falls again: its mean may not change
    changes = [float(np.mean(third) - np.mean(rolling)) for third in thirds]
    largest = int(np.argmax(np.abs(changes)))
    return IntervalEstimate(changes[largest], float(half_width(rolling, thirds[largest].size)))


def rolling_radius(log: Log, driving: DrivingRecord) -> float | None:
    """Median of v over the median wheel speed [m], unbraked, (19) at zero slip; None without v."""
    if "v" not in log:
        return None
    wheel = np.median([log[f"omega_{w}"] for w in WHEELS], axis=0)
    rolling = ~driving.braked & (wheel * NOMINAL_RADIUS > MOVING)
    if rolling.sum() < LIMITS.noise_fewest:
        return None
    # an engine in gear makes a slip of 0.1 % at 0.03 g, which is in the result
    return float(np.median(log["v"][rolling] / wheel[rolling]))


def _slope_over_wheels(driving: DrivingRecord, use: Mask) -> float | None:
    """Slope of the measured deceleration over that of the wheels [m]; None without correlation."""
    width = samples_in(LIMITS.slope_time, driving.step) | 1
    use = driving.moving & use
    slowing = centred_mean(driving.wheel_z * G / NOMINAL_RADIUS, width)[use]  # [rad/s^2]
    a = centred_mean(driving.z * G, width)[use]  # [m/s^2]
    if slowing.size < 20 or np.ptp(slowing) < 3.0 or np.ptp(a) == 0.0:  # 3 rad/s^2: about 0.1 g
        return None
    if abs(np.corrcoef(a, slowing)[0, 1]) < 0.8:
        return None
    return float(np.cov(a, slowing)[0, 1] / np.var(slowing, ddof=1))


def _no_deep_slip(slips: Mapping[str, Array], driving: DrivingRecord) -> Mask:
    """Mask (n,): no wheel slips deeply within `LIMITS.near_lock`, so the wheels show the speed."""
    slip = np.array(list(slips.values()))
    free = driving.unbraked
    zero = np.median(slip[:, free], axis=1, keepdims=True) if free.any() else 0.0
    deep = np.any(slip - zero > LIMITS.deep, axis=0)
    width = samples_in(2.0 * LIMITS.near_lock, driving.step) | 1
    return np.asarray(centred_mean(deep.astype(float), width) == 0.0)


@dataclass(frozen=True)
class Slipping:
    """ABS cycles and wheels that lock."""

    cycles: tuple[tuple[str, float], ...]  # wheel, start [s]
    locked: tuple[str, ...]
    first: float  # start of the first deep slip [s], or inf


def slipping(slips: Mapping[str, Array], driving: DrivingRecord) -> Slipping:
    """Find ABS cycles and locked wheels. Without ``v``, four wheels that slip alike are not found.

    A cycle is a deep slip that the wheel leaves within `LIMITS.abs_cycle`, or, on a wheel without
    one, any of its `_swings`.
    """
    braking = driving.braked & driving.moving
    cycles: list[tuple[str, float]] = []
    locked, first = [], math.inf
    for wheel, slip in slips.items():
        starts = []
        for start, end in true_intervals(braking & (slip > LIMITS.deep_back)):
            deepest, length = slip[start:end].max(), (end - start) * driving.step
            if deepest > LIMITS.locked:
                locked.append(wheel)
            if deepest > LIMITS.deep:
                first = min(first, float(driving.time[start]))
                rolls_again = end < braking.size and braking[end]
                if rolls_again and length < LIMITS.abs_cycle:
                    starts.append(float(driving.time[start]))
        if not starts:
            starts = _swings(slip, driving, braking)
        cycles += [(wheel, start) for start in starts]
    cycles.sort(key=lambda cycle: cycle[1])
    return Slipping(tuple(cycles), tuple(dict.fromkeys(locked)), first)


def _swings(slip: Array, driving: DrivingRecord, braking: Mask) -> list[float]:
    """Starts [s] of slip that comes and goes repeatedly, as by ABS; none if it does so rarely."""
    width = samples_in(LIMITS.swing_time, driving.step) | 1
    padded = np.pad(slip, width // 2, constant_values=np.inf)
    lowest = np.min(np.lib.stride_tricks.sliding_window_view(padded, width), axis=1)  # (n,)
    swings = braking & (slip - lowest > LIMITS.swing)
    starts = [float(driving.time[start]) for start, _ in true_intervals(swings)]
    near = np.diff(starts) < LIMITS.abs_cycle
    return starts if np.count_nonzero(near) + 1 >= LIMITS.swings else []
