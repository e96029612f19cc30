"""Properties of the sensor of each channel: range, resolution, noise, stuck values, saturation."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from calib.base.arrays import Array
from calib.base.names import CHANNELS
from calib.base.warning import LIMITS
from calib.logs.log import Log
from calib.run.driving_record import SMOOTHING, DrivingRecord
from calib.run.filters import true_intervals

_RESTING = ("T_drive_f", "T_drive_r")  # at rest at the highest value if a motor only brakes


@dataclass(frozen=True, eq=False, repr=False)
class Sensor:
    """Sensor of a ``channel`` of a ``log``, SI; without ``driving`` all counts as unbraked."""

    channel: str
    log: Log
    driving: DrivingRecord | None

    @property
    def _x(self) -> Array:
        return self.log[self.channel]

    @cached_property
    def _quiet(self) -> Array:
        """Values while the car rolls unbraked."""
        return self._x if self.driving is None else self._x[self.driving.unbraked]

    @cached_property
    def low(self) -> float:
        """Lowest value."""
        return float(self._x.min())

    @cached_property
    def high(self) -> float:
        """Highest value."""
        return float(self._x.max())

    @cached_property
    def resolution(self) -> float:
        """Step of the values; 0 if there is none, or for an interpolated channel."""
        return 0.0 if self.channel in self.log.interpolated else resolution_of(self._x)

    @cached_property
    def noise(self) -> float:
        """Standard deviation of the white noise, unbraked, without outliers; NaN if too short."""
        if self._quiet.size < LIMITS.noise_fewest:
            return float("nan")
        change = np.diff(self._quiet, 3)  # almost no motion, and 20 times the variance of the noise
        usual = np.abs(change) <= 5.0 * np.quantile(np.abs(change), 0.84)  # 0.84: about one sigma
        return float(np.sqrt(np.mean(change[usual] ** 2) / 20.0))

    @cached_property
    def flat(self) -> float:
        """Share of the unbraked samples that have their most frequent value [1]."""
        return _flatness(self._quiet)

    @cached_property
    def stuck(self) -> tuple[tuple[float, float], ...]:
        """Start and end [s] of each interval of over a second in which the value is stuck."""
        driving = self.driving
        if driving is None:
            return ()
        same = np.concatenate([[False], np.diff(self._x) == 0])
        constant = [
            (start - 1, end)  # the value is that of the sample before
            for start, end in true_intervals(same)
            if (end - start) * driving.step >= LIMITS.hanging
        ]
        return tuple(
            (float(driving.time[start]), float(driving.time[end - 1]))
            for start, end in constant
            if _others_move(self.channel, self.log, driving, slice(start, end))
        )

    @cached_property
    def saturated(self) -> float:
        """Time for which the value stays at the end of its range [s], 0 if that is usual."""
        name, x = self.channel, self._x
        if name in _RESTING or (name.startswith("p_") and _is_held(x, self.driving)):
            return 0.0
        return _saturation(-x if name == "a_x" else x, self.log.sample_time)


# properties of a `Sensor` that a JSON document has
FIGURES = ("channel", "low", "high", "resolution", "noise", "flat", "stuck", "saturated")


def sensors_of(log: Log, driving: DrivingRecord | None) -> tuple[Sensor, ...]:
    """Return the sensors of all measured channels except ``time``."""
    names = (name for name in CHANNELS if name in log and name != "time")
    return tuple(Sensor(name, log, driving) for name in names)


def resolution_of(x: Array) -> float:
    """Smallest difference of two values, if all others are multiples of it; else 0."""
    gaps = np.diff(np.unique(x))
    gaps = gaps[gaps > 1e-9 * max(np.ptp(x), 1e-12)]
    if gaps.size < 3:
        return 0.0
    step = float(gaps.min())
    multiples = gaps[gaps < 100 * step] / step
    return step if np.all(np.abs(multiples - np.round(multiples)) < 0.1) else 0.0


def _flatness(x: Array) -> float:
    """Share of the samples that have the most frequent value [1]; 0 without samples."""
    return float(np.unique(x, return_counts=True)[1].max() / x.size) if x.size else 0.0


def _saturation(x: Array, step: float) -> float:
    """Time at the highest value [s], if no other value is constant for nearly as long; else 0."""
    top = x.max()
    if not 10 <= np.count_nonzero(x == top) < x.size:
        return 0.0
    edges = np.concatenate([[0], np.flatnonzero(np.diff(x)) + 1, [x.size]])
    length, value = np.diff(edges), x[edges[:-1]]  # of each interval of equal values [samples]
    at_top = value == top
    at_top[0] = False  # a value from the first sample on is that of a signal at rest
    longest = int(length[at_top].max(initial=0))
    longest_other = int(length[value < top].max(initial=1))
    is_long = longest >= 10 and longest * step >= LIMITS.held and longest >= 5 * longest_other
    return longest * step if is_long else 0.0


def _is_held(pressure: Array, driving: DrivingRecord | None) -> bool:
    """Whether the driver holds the highest pressure: beyond the sensor's range z would rise on."""
    if driving is None:
        return False
    at_highest = true_intervals(pressure == pressure.max())
    start, end = max(at_highest, key=lambda interval: interval[1] - interval[0])
    start += round(LIMITS.followed / driving.step)
    followed = slice(start, end - round(SMOOTHING / driving.step))
    z = driving.z[followed][driving.moving[followed]]
    return z.size > 0 and float(z.max() - z[0]) < LIMITS.presses * float(z.max())


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
    """Whether no driver can have held the constant pressure of ``part``; ``z`` [g] within it.

    The deceleration must have changed. A pressure of zero is then stuck in a strong braking, any
    other if the brakes were released, if it goes on with a jump, or if it has noise elsewhere: no
    driver holds the noise still.
    """
    if z.size == 0 or float(np.ptp(z)) <= 0.15:
        return False
    if p[part.start] == 0:
        return float(z.max()) > 0.3
    quiet = p[driving.unbraked]
    is_noisy = quiet.size >= LIMITS.noise_fewest and _flatness(quiet) <= LIMITS.rustles
    was_released = float(z.min()) < LIMITS.released
    return was_released or is_noisy or _returns_with_a_jump(p, part.stop)


def _returns_with_a_jump(x: Array, end: int) -> bool:
    """Whether the step of ``x`` at ``end`` is over five times the median of the five after it."""
    if end + 5 >= x.size:
        return False
    after = np.abs(np.diff(x[end : end + 6]))
    return bool(abs(x[end] - x[end - 1]) > 5.0 * max(float(np.median(after)), 1.0))
