"""The sensor of each channel of a log: range, resolution, noise, stuck values, saturation."""

from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array
from calib.base.names import CHANNELS
from calib.base.warning import LIMITS
from calib.logs.log import Log
from calib.run.driving_record import SMOOTHING, DrivingRecord
from calib.run.filters import true_intervals

# a motor that only brakes has its highest torque, zero, at rest: that is no end of a range
_HIGHEST_AT_REST = ("T_drive_f", "T_drive_r")


@dataclass(frozen=True)
class Sensor:
    """Properties of the sensor of a ``channel``, by the values of a log, in SI."""

    channel: str
    low: float  # lowest value
    high: float  # highest value
    resolution: float  # step of the values; 0 if there is none, or for an interpolated channel
    noise: float  # standard deviation of the white noise, unbraked; NaN if that part is too short
    flat: float  # share of the unbraked samples that have their most frequent value [1]
    stuck: tuple[tuple[float, float], ...]  # start and end [s] of each time with a stuck value
    saturated: float  # time at the end of the range [s]; 0 if the value may stay there


def sensors_of(log: Log, driving: DrivingRecord | None) -> tuple[Sensor, ...]:
    """Return the sensors of all measured channels except ``time``."""
    names = [name for name in CHANNELS if name in log and name != "time"]
    return tuple(_sensor(name, log, driving) for name in names)


def _sensor(name: str, log: Log, driving: DrivingRecord | None) -> Sensor:
    """Without a driving record all samples count as unbraked, and no value as stuck."""
    x = log[name]
    unbraked = x if driving is None else x[driving.unbraked]
    magnitude = -x if name == "a_x" else x  # of a braking
    return Sensor(
        channel=name,
        low=float(x.min()),
        high=float(x.max()),
        resolution=0.0 if name in log.interpolated else resolution_of(x),
        noise=_noise(unbraked),
        flat=_flatness(unbraked),
        stuck=() if driving is None else _stuck(name, log, driving),
        saturated=0.0 if _may_stay(name, x, driving) else _saturation(magnitude, log.sample_time),
    )


def resolution_of(x: Array) -> float:
    """Smallest difference of two values, if all others are multiples of it; else 0."""
    gaps = np.diff(np.unique(x))
    gaps = gaps[gaps > 1e-9 * max(np.ptp(x), 1e-12)]
    if gaps.size < 3:
        return 0.0
    step = float(gaps.min())
    multiples = gaps[gaps < 100 * step] / step
    return step if np.all(np.abs(multiples - np.round(multiples)) < 0.1) else 0.0


def _noise(unbraked: Array) -> float:
    """Standard deviation of the white noise of a channel (n,), without outliers."""
    if unbraked.size < LIMITS.noise_fewest:
        return float("nan")
    change = np.diff(unbraked, 3)  # almost no motion, and 20 times the variance of the noise
    usual = np.abs(change) <= 5.0 * np.quantile(np.abs(change), 0.84)  # 0.84: about one sigma
    return float(np.sqrt(np.mean(change[usual] ** 2) / 20.0))


def _flatness(x: Array) -> float:
    """Share of the samples that have the most frequent value [1]; 0 without samples."""
    return float(np.unique(x, return_counts=True)[1].max() / x.size) if x.size else 0.0


def _saturation(x: Array, step: float) -> float:
    """Time at the highest value [s], if no other value is constant for nearly as long; else 0."""
    top = x.max()
    count = np.count_nonzero(x == top)
    if count < 10 or count == x.size:
        return 0.0
    edges = np.concatenate([[0], np.flatnonzero(np.diff(x)) + 1, [x.size]])
    length, value = np.diff(edges), x[edges[:-1]]  # of each interval of equal values [samples]
    at_top = value == top
    at_top[0] = False  # a value from the first sample on is that of a signal at rest
    longest = int(length[at_top].max(initial=0))
    longest_other = int(length[value < top].max(initial=1))
    is_long = longest >= max(10, 5 * longest_other) and longest * step >= LIMITS.saturated_time
    return longest * step if is_long else 0.0


def _may_stay(name: str, x: Array, driving: DrivingRecord | None) -> bool:
    """Whether a channel may stay at its highest value: a motor at rest, a pressure that is held."""
    if name in _HIGHEST_AT_REST:
        return True
    if driving is None or not name.startswith("p_"):
        return False
    at_highest = true_intervals(x == x.max())
    start, end = max(at_highest, key=lambda interval: interval[1] - interval[0])
    start += round(LIMITS.response_time / driving.step)
    after_response = slice(start, end - round(SMOOTHING / driving.step))
    # while a driver holds the pressure, z stays; at the end of the sensor's range it would rise
    z = driving.z[after_response][driving.moving[after_response]]
    return z.size > 0 and float(z.max() - z[0]) < LIMITS.constant_z * float(z.max())


def _stuck(name: str, log: Log, driving: DrivingRecord) -> tuple[tuple[float, float], ...]:
    """Start and end [s] of each interval of over a second in which the value is stuck."""
    stuck = []
    is_same = np.concatenate([[False], np.diff(log[name]) == 0])
    for start, end in true_intervals(is_same):
        constant = slice(start - 1, end)  # the sample before has the same value
        is_long = (end - start) * driving.step >= LIMITS.stuck_time
        if is_long and _others_move(name, log, driving, constant):
            stuck.append((float(driving.time[start - 1]), float(driving.time[end - 1])))
    return tuple(stuck)


def _others_move(name: str, log: Log, driving: DrivingRecord, part: slice) -> bool:
    """Whether the other channels show that ``name`` should have changed in ``part``."""
    # at the ends smoothing mixes in other samples, and the wheels do not stop together
    edge = round(SMOOTHING / driving.step)
    inside = slice(part.start + edge, part.stop - edge)
    if name == "v" or name.startswith("omega"):
        others = [w for w in log.channels if w.startswith("omega") and w != name]
        wheel = np.mean([log[w][inside] for w in others], axis=0)
        return bool(np.ptp(wheel) > max(1.0, 0.05 * wheel.max()))
    moving = driving.moving[inside]
    if name == "a_x":
        wheel_z = driving.wheel_z[inside][moving]
        return wheel_z.size > 0 and bool(np.ptp(wheel_z) > 0.1)
    if name == "p_mc":
        return _is_stuck_pressure(log[name], driving, part, driving.z[inside][moving])
    return False


def _is_stuck_pressure(p: Array, driving: DrivingRecord, part: slice, z: Array) -> bool:
    """Whether no driver can have held the constant pressure of ``part``, where ``z`` [g] was felt.

    The deceleration must have changed. A pressure of zero is then stuck in a strong braking. Any
    other pressure is stuck if the brakes were released, if it goes on with a jump, or if it has
    noise elsewhere, which no driver can hold still.
    """
    if z.size == 0 or float(np.ptp(z)) <= 0.15:
        return False
    if p[part.start] == 0:
        return float(z.max()) > 0.3
    quiet = p[driving.unbraked]
    is_noisy = quiet.size >= LIMITS.noise_fewest and _flatness(quiet) <= LIMITS.noise_flatness
    was_released = float(z.min()) < LIMITS.released_z
    return was_released or is_noisy or _returns_with_a_jump(p, part.stop)


def _returns_with_a_jump(x: Array, end: int) -> bool:
    """Whether the step of ``x`` at ``end`` is over five times the median of the five after it."""
    if end + 5 >= x.size:
        return False
    after = np.abs(np.diff(x[end : end + 6]))
    return bool(abs(x[end] - x[end - 1]) > 5.0 * max(float(np.median(after)), 1.0))
