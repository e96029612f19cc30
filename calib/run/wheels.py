"""The four wheels compared: radii, sign of a_x, ABS, locked wheels."""

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
from calib.run.filters import (
    block_mean,
    centred_mean,
    median_of_three,
    samples_in,
    sliding_minimum,
    true_intervals,
)

LOW, HIGH = 0.1, 0.5  # range of deceleration in which the wheels are compared [1]


@dataclass(frozen=True)
class IntervalEstimate:
    """A value with the half width of its 95 % interval."""

    value: float
    half: float


def mismatch(a: Array, b: Array, mask: Mask, step: float) -> IntervalEstimate | None:
    """Ratio b/a - 1 of two wheel speeds within ``mask`` [1]; None with fewer than three blocks.

    The interval takes the blocks of 0.2 s as independent: a slow drift, as on a bend, is not in it.
    """
    ratio = _ratios(a, b, mask, step)
    if ratio.size < 3:
        return None
    return IntervalEstimate(float(np.mean(ratio)), float(half_width(ratio)))


def half_width(rolling: Array, braked: float = np.inf) -> Array:
    """Half width of the 95 % interval of the mean of ``rolling`` (..., k).

    With ``braked`` blocks: of the change to their mean, with the same noise.
    """
    from scipy.special import stdtrit

    count = rolling.shape[-1]
    share = np.sqrt(1.0 / count + 1.0 / braked)
    return np.asarray(stdtrit(count - 1, 0.975) * np.std(rolling, axis=-1, ddof=1) * share)


def wheel_means(x: Array, mask: Mask, step: float) -> Array:
    """Means over `wheel_block` within ``mask``; empty if that is short."""
    return block_mean(x[..., mask], samples_in(LIMITS.wheel_block, step))


def _ratios(a: Array, b: Array, mask: Mask, step: float) -> Array:
    """``b/a - 1`` of means [1], without those in which the first wheel does not turn."""
    first, second = wheel_means(np.stack([a, b]), mask, step)
    turns = first > 0.0
    return np.asarray(second[turns] / first[turns] - 1.0)


@dataclass(frozen=True)
class Axles:
    """Comparison of the wheels; None where a part is too short.

    Attributes
    ----------
    front_rear : eta - 1 on the unbraked part [1]: positive if the rear radius is the smaller.
    left_right_f, left_right_r : right over left wheel speed - 1, unbraked [1].
    radius : ``v`` over the wheel speed while rolling unbraked, the median [m].
    slope : change of ``-a_x`` with the wheels' deceleration [m]: the rolling radius if all is
        correct; negative for a wrong sign.
    eta_braked : eta over its unbraked value - 1, mean while braking with 0.2 to 0.5 g [1].
    eta_most : the same in the third of a braking with 0.1 to 0.5 g in which it is farthest from 0
        [1]: eta rises and falls again, so its mean may be 0.
    """

    front_rear: IntervalEstimate | None
    left_right_f: IntervalEstimate | None
    left_right_r: IntervalEstimate | None
    radius: float | None
    slope: float | None
    eta_braked: IntervalEstimate | None
    eta_most: IntervalEstimate | None


def axles_of(log: Log, driving: DrivingRecord, slips: Mapping[str, Array]) -> Axles:
    """Compare the wheels of a log with ``a_x`` and four wheel speeds; ``slips`` as `slips_of`."""
    fl, fr, rl, rr = (log[f"omega_{w}"] for w in WHEELS)
    front, rear, free = 0.5 * (fl + fr), 0.5 * (rl + rr), driving.unbraked
    zero = mismatch(front, rear, free, driving.step)
    braking = driving.braked & (driving.wheel_z < HIGH) & (driving.speed > 5.0)
    braked = mismatch(front, rear, braking & (driving.wheel_z > 0.2), driving.step)
    if braked is not None and zero is not None:
        half = float(np.hypot(braked.half, zero.half))
        braked = IntervalEstimate(braked.value - zero.value, half)
    return Axles(
        front_rear=zero,
        left_right_f=mismatch(fl, fr, free, driving.step),
        left_right_r=mismatch(rl, rr, free, driving.step),
        radius=rolling_radius(log, driving),
        slope=_against_wheels(driving, _all_roll(slips, driving)),
        eta_braked=braked if zero is not None else None,
        eta_most=_most(front, rear, free, braking & (driving.wheel_z > LOW), driving.step),
    )


def _most(
    front: Array, rear: Array, free: Mask, braking: Mask, step: float
) -> IntervalEstimate | None:
    """Largest change of eta from ``free`` rolling to a third of ``braking`` [1]."""
    rolling, slipping = (_ratios(front, rear, mask, step) for mask in (free, braking))
    if min(rolling.size, slipping.size) < 3:
        return None
    thirds = np.array_split(slipping, 3)
    changes = [float(np.mean(third) - np.mean(rolling)) for third in thirds]
    largest = int(np.argmax(np.abs(changes)))
    return IntervalEstimate(changes[largest], float(half_width(rolling, thirds[largest].size)))


def rolling_radius(log: Log, driving: DrivingRecord) -> float | None:
    """Median of ``v`` over the median wheel speed [m] unbraked, (19) at zero slip; None without v.

    It contains the slip by an engine in gear: 0.1 % at 0.03 g.
    """
    if "v" not in log:
        return None
    wheel = np.median([log[f"omega_{w}"] for w in WHEELS], axis=0)
    rolls = ~driving.braked & (wheel * NOMINAL_RADIUS > MOVING)
    if rolls.sum() < LIMITS.noise_fewest:
        return None
    return float(np.median(log["v"][rolls] / wheel[rolls]))


def _against_wheels(driving: DrivingRecord, rolling: Mask) -> float | None:
    """Slope of the measured deceleration over that of the rolling wheels [m].

    None for a correlation below 0.8: a wet road with much slip, or a wrong ``a_x``.
    """
    width = samples_in(LIMITS.slope_time, driving.step) | 1
    use = driving.moving & rolling
    spin = centred_mean(driving.wheel_z * G / NOMINAL_RADIUS, width)[use]
    a = centred_mean(driving.z * G, width)[use]
    if spin.size < 20 or np.ptp(spin) < 3.0 or np.ptp(a) == 0.0:  # 3 rad/s^2 are about 0.1 g
        return None
    if abs(np.corrcoef(a, spin)[0, 1]) < 0.8:
        return None
    return float(np.cov(a, spin)[0, 1] / np.var(spin, ddof=1))


def _all_roll(slips: Mapping[str, Array], driving: DrivingRecord) -> Mask:
    """Mask (n,): no wheel slips deeply within `near_lock`: a wheel near lock is not the speed."""
    slip = np.array(list(slips.values()))
    free = driving.unbraked
    zero = np.median(slip[:, free], axis=1, keepdims=True) if free.any() else 0.0
    deep = np.any(slip - zero > LIMITS.deep, axis=0)
    width = samples_in(2.0 * LIMITS.near_lock, driving.step) | 1
    return np.asarray(centred_mean(deep.astype(float), width) == 0.0)


@dataclass(frozen=True)
class Slipping:
    """ABS cycles as (wheel, start [s]), locked wheels, and the ``first`` deep slip [s] or inf."""

    cycles: tuple[tuple[str, float], ...]
    locked: tuple[str, ...]
    first: float


def slipping(slips: Mapping[str, Array], driving: DrivingRecord) -> Slipping:
    """Find ABS cycles and locked wheels; without ``v`` not where all four slip at once."""
    inside = driving.braked & driving.moving
    cycles, locked, first = [], [], math.inf
    for wheel, slip in slips.items():
        for start, end in true_intervals(inside & (slip > LIMITS.deep_back)):
            deepest, time = slip[start:end].max(), (end - start) * driving.step
            if deepest > LIMITS.deep:
                first = min(first, float(driving.time[start]))
            if deepest > LIMITS.locked:
                locked.append(wheel)
            comes_back = end < inside.size and inside[end] and time < LIMITS.abs_cycle
            if deepest > LIMITS.deep and comes_back:
                cycles.append((wheel, float(driving.time[start])))
        if not any(w == wheel for w, _ in cycles):
            cycles += [(wheel, at) for at in _swings(slip, driving, inside)]
    cycles.sort(key=lambda cycle: cycle[1])
    return Slipping(tuple(cycles), tuple(dict.fromkeys(locked)), first)


def _swings(slip: Array, driving: DrivingRecord, inside: Mask) -> list[float]:
    """Starts [s] of slip that repeats while braking, as by ABS; none of single or long slip."""
    width = samples_in(LIMITS.swing_time, driving.step) | 1
    above = inside & (driving.speed > MOVING)
    above &= slip - sliding_minimum(slip, width) > LIMITS.swing
    starts = [float(driving.time[start]) for start, _ in true_intervals(above)]
    near = np.diff(starts) < LIMITS.abs_cycle
    return starts if np.count_nonzero(near) + 1 >= LIMITS.swings else []


def slips_of(log: Log, driving: DrivingRecord) -> dict[str, Array]:
    """Slip of each wheel [1], without single wild samples, smoothed over 30 ms.

    Zero on the unbraked part if there is one.
    """
    width = samples_in(0.03, driving.step) | 1
    omega = {w: centred_mean(median_of_three(log[f"omega_{w}"]), width) for w in WHEELS}
    free = driving.unbraked
    v, scale = np.max(list(omega.values()), axis=0), dict.fromkeys(WHEELS, 1.0)
    if "v" in log and free.any():
        v = centred_mean(log["v"], width)
        scale = {w: float(np.median(v[free] / np.maximum(omega[w][free], 1e-6))) for w in WHEELS}
    floor = np.maximum(v, 1e-6)
    return {w: 1.0 - scale[w] * omega[w] / floor for w in WHEELS}
