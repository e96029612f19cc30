"""The four wheels compared: radii, exchanged axles and sides, sign of a_x, ABS, locked wheels.

What braking changes of the four slips s is split into three parts, each 0 but for the first on a
car that brakes alike left and right:

    E = (fl + fr - rl - rr)/2      front against rear: the front wheels slip more
    L = (fl - fr + rl - rr)/2      left against right: a bend, unlike brakes, unlike tyres
    X = (fl - fr - rl + rr)/2      one diagonal against the other

Columns that change places change the parts: fl with rl makes X = -E and E = 0, fr with rr X = E,
fl with rr L = -E, fr with rl L = E. One wheel that brakes more or less moves |X| and |L| alike, so
X alone is no brake and no tyre, and no bend.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

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
    runs,
    samples_in,
    sliding_minimum,
    without_single,
)


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
    return IntervalEstimate(float(np.mean(ratio)), float(_half(ratio)))


def _half(rolling: Array, braked: float = np.inf) -> Array:
    """Half width of the 95 % interval of the mean of ``rolling`` (..., k).

    With ``braked`` blocks: of the change to their mean, with the same noise.
    """
    from scipy.special import stdtrit

    count = rolling.shape[-1]
    share = np.sqrt(1.0 / count + 1.0 / braked)
    return np.asarray(stdtrit(count - 1, 0.975) * np.std(rolling, axis=-1, ddof=1) * share)


def _means(x: Array, mask: Mask, step: float) -> Array:
    """Means over `wheel_block` within ``mask``; empty if that is short."""
    return block_mean(x[..., mask], samples_in(LIMITS.wheel_block, step))


def _ratios(a: Array, b: Array, mask: Mask, step: float) -> Array:
    """``b/a - 1`` of means [1], without those in which the first wheel does not turn."""
    first, second = _means(np.stack([a, b]), mask, step)
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
    braking = driving.braked & (driving.wheel_z < _HIGH) & (driving.speed > 5.0)
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
        eta_most=_most(front, rear, free, braking & (driving.wheel_z > _LOW), driving.step),
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
    return IntervalEstimate(changes[largest], float(_half(rolling, thirds[largest].size)))


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
        for start, end in runs(inside & (slip > LIMITS.deep_back)):
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
    starts = [float(driving.time[start]) for start, _ in runs(above)]
    near = np.diff(starts) < LIMITS.abs_cycle
    return starts if np.count_nonzero(near) + 1 >= LIMITS.swings else []


def slips_of(log: Log, driving: DrivingRecord) -> dict[str, Array]:
    """Slip of each wheel [1], without single wild samples, smoothed over 30 ms.

    Zero on the unbraked part if there is one.
    """
    width = samples_in(0.03, driving.step) | 1
    omega = {w: centred_mean(without_single(log[f"omega_{w}"]), width) for w in WHEELS}
    free = driving.unbraked
    v, scale = np.max(list(omega.values()), axis=0), dict.fromkeys(WHEELS, 1.0)
    if "v" in log and free.any():
        v = centred_mean(log["v"], width)
        scale = {w: float(np.median(v[free] / np.maximum(omega[w][free], 1e-6))) for w in WHEELS}
    floor = np.maximum(v, 1e-6)
    return {w: 1.0 - scale[w] * omega[w] / floor for w in WHEELS}


_PARTS = np.array([[1, 1, -1, -1], [1, -1, 1, -1], [1, -1, -1, 1]]) / 2.0  # E, L, X over wheels

_LOW, _HIGH = 0.1, 0.5  # range of deceleration in which the wheels are compared [1]


@dataclass(frozen=True)
class WheelParts:
    """E, L and X while braking less those of the rolling car [1]; ``z`` mean deceleration [1]."""

    axles: IntervalEstimate
    sides: IntervalEstimate
    diagonals: IntervalEstimate
    z: float


class _Crossed(NamedTuple):
    """A front and a rear wheel whose columns are exchanged, and the ``part`` that shows it [1].

    ``others``: the two wheels that slip more than the rest, as text.
    """

    wheels: tuple[str, str]
    part: float
    others: str

    def __str__(self) -> str:
        front, rear = self.wheels
        return (
            f"omega_{front} and omega_{rear} have changed places: while braking {self.others} slip "
            f"{100 * abs(self.part):.2f} % more than the other two, and front and rear alike"
        )


def wheel_parts(log: Log, driving: DrivingRecord) -> WheelParts | None:
    """Compare the wheels; None with fewer than three blocks of 0.2 s that roll, or that brake."""
    braking = driving.braked & (driving.wheel_z > _LOW) & (driving.wheel_z < _HIGH)
    braking &= driving.speed > 5.0
    wheels = np.array([log[f"omega_{w}"] for w in WHEELS])
    means = [_means(wheels, mask, driving.step) for mask in (driving.unbraked, braking)]
    free, braked = (_PARTS @ (1.0 - x / x.mean(axis=0)) for x in means)
    if min(free.shape[1], braked.shape[1]) < 3:
        return None
    change = np.mean(braked, axis=1) - np.mean(free, axis=1)
    half = _half(free, braked.shape[1])
    axles, sides, diagonals = map(IntervalEstimate, change.tolist(), half.tolist())
    return WheelParts(axles, sides, diagonals, float(np.mean(driving.wheel_z[braking])))


def _alone(part: IntervalEstimate, others: float, z: float) -> bool:
    """Whether X or L exceeds the ``others``, and the effect of unlike brakes at ``z``."""
    least = max(LIMITS.crossed_alone * others, LIMITS.crossed_least * z)
    return bool(abs(part.value) - part.half >= least)


def crossed_side(parts: WheelParts | None, alone: str | None = None) -> _Crossed | None:
    """Exchanged wheels of one side, if sure; ``alone`` the axle that brakes alone, or None."""
    if parts is None:
        return None
    x = parts.diagonals
    if not _alone(x, max(abs(parts.axles.value), abs(parts.sides.value)), parts.z):
        return None
    wheels = ("fl", "rl") if (x.value < 0.0) is (alone != "r") else ("fr", "rr")
    return _Crossed(wheels, x.value, "fl and rr" if x.value > 0.0 else "fr and rl")


def crossed_diagonal(parts: WheelParts | None, expected: float) -> _Crossed | None:
    """Exchanged wheels of a diagonal, if likely; ``expected`` E [1] by the table of the car.

    A bend changes L too, but not E.
    """
    if parts is None:
        return None
    part, e, x = parts.sides, abs(parts.axles.value), abs(parts.diagonals.value)
    low, high = abs(expected) / LIMITS.crossed_alone, LIMITS.crossed_alone * abs(expected)
    if not (_alone(part, max(e, x), parts.z) and low < abs(part.value) < high and e < low):
        return None
    wheels = ("fl", "rr") if (part.value < 0.0) is (expected > 0.0) else ("fr", "rl")
    return _Crossed(wheels, part.value, "fl and rl" if part.value > 0.0 else "fr and rr")
