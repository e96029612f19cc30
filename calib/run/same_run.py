"""Whether two logs are one run: saved in another format, rounded, cut or resampled.

Two runs have independent noise, even if a robot drives both; a copy has that of its original. Means
over 50 ms are aligned by the wheel speeds, and their difference is compared with their noise. Where
that is close, the signs of the third differences decide, which are noise:

    D = spread of (a - b), squared, over sigma_a^2 + sigma_b^2     one run: 0 to 0.9; two: 1 or more
    r = sin(pi/2 * mean(sign(a''') * sign(b''')))                  one run: 0.3 to 1; two: about 0

Wrong where most channels of a copy are rounded to more than five times their noise: it counts as
another run.

A table holds the `Fingerprint` of its runs: the means, rounded to a quarter of their noise, as the
second differences of whole numbers. A run of 10 s takes about 5 kB.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import LogError
from calib.base.intervals import scatter, white_noise
from calib.base.names import WHEEL_SPEEDS
from calib.base.warning import LIMITS
from calib.car.lag import integral
from calib.logs.log import Log
from calib.run.sensors import resolution_of

_COMPARED = ("p_mc", "a_x", *WHEEL_SPEEDS, "v")
_ROUNDS = 3  # steps of Newton's method to a lag between the samples
VERSION = 1
_FINE = 0.25  # unit of the whole numbers over the noise [1]: rounding adds 0.3 % to its square
_MOST = 2.0**40  # largest whole number of a channel that has no noise

_View = dict[str, Array]
"""Means of the channels [SI], and of the four ``wheels``."""


@dataclass(frozen=True)
class _FingerprintChannel:
    """A channel as multiples of ``unit`` [SI]; ``differences`` their second differences as text."""

    name: str
    unit: float
    differences: str


@dataclass(frozen=True)
class Fingerprint:
    """Consecutive means over ``step`` [s] of the channels of a run; ``version`` of the format."""

    version: int
    step: float
    channels: tuple[_FingerprintChannel, ...]

    def __post_init__(self) -> None:
        """Raise ValueError for a fingerprint that is not one of this format."""
        names = {channel.name for channel in self.channels}
        sizes = {_decoded(channel.differences).size for channel in self.channels}
        units = (self.step, *(channel.unit for channel in self.channels))
        if (
            self.version != VERSION
            or not set(WHEEL_SPEEDS) <= names <= set(_COMPARED)
            or not all(0.0 < unit < math.inf for unit in units)
            or len(sizes) != 1
        ):
            raise ValueError(f"no fingerprint of a run in version {VERSION} of its format")

    @cached_property
    def view(self) -> _View:
        """The means of the channels [SI], each (n,), and of the wheels."""
        return _with_wheels({c.name: _decoded(c.differences) * c.unit for c in self.channels})


def same_run(log: Log, other: Log) -> bool:
    """Whether two logs hold one run, or parts of it that overlap by half of the shorter one."""
    if log.digest and log.digest == other.digest:
        return True
    return _agree(_view_of(log), other, LIMITS.run_means)


def same_as(fingerprint: Fingerprint, log: Log) -> bool:
    """Whether a log holds the run of a fingerprint, or parts of it, as `same_run`."""
    return _agree(fingerprint.view, log, fingerprint.step)


def _agree(a: _View, other: Log, step: float) -> bool:
    """Whether the channels agree at the best lag; ``other`` is read again between its steps."""
    b = _view_of(other, step)
    if min(a["wheels"].size, b["wheels"].size) < LIMITS.run_fewest:
        return False
    lag = _best_lag(a["wheels"], b["wheels"])
    late = float(lag)
    for _ in range(_ROUNDS):
        step_left, far = _residual_lag(a["wheels"], b["wheels"], lag)
        if far > LIMITS.run_far:
            return False
        if _alike(a, b, lag):
            return True
        late += step_left
        lag = int(np.ceil(late))
        b = _view_of(other, step, (lag - late) * step)
        sizes = a["wheels"].size, b["wheels"].size
        if min(min(sizes), max(sizes) - abs(lag)) < LIMITS.run_fewest:
            return False
    return _alike(a, b, lag)


def _alike(view: _View, other: _View, lag: int) -> bool:
    """Whether D and r show one run, where ``other`` begins ``lag`` samples after ``view``."""
    pairs = {
        name: _over(view[name], other[name], lag)
        for name in _COMPARED
        if name in view and name in other and np.ptp(view[name]) + np.ptp(other[name]) > 0.0
    }
    each = {name: _apart(a, b) for name, (a, b) in pairs.items()}
    wheels = [apart for name, apart in each.items() if name.startswith("omega_")]
    kinds = [apart for name, apart in each.items() if not name.startswith("omega_")]
    kinds += [float(np.median(wheels))] if wheels else []
    apart = float(np.median(kinds)) if kinds else np.inf
    together = apart < LIMITS.run_two and _together(list(pairs.values())) > LIMITS.run_together
    return bool(apart < LIMITS.run_alike or together)


def _over(view: Array, other: Array, lag: int) -> tuple[Array, Array]:
    a, b = view[max(lag, 0) :], other[max(-lag, 0) :]
    n = min(a.size, b.size)
    return a[:n], b[:n]


def _apart(a: Array, b: Array) -> float:
    between = scatter(a - b) ** 2
    noise = _noise_of(a) ** 2 + _noise_of(b) ** 2
    if noise == 0.0:
        return 0.0 if between == 0.0 else np.inf
    return between / noise


def _together(pairs: list[tuple[Array, Array]]) -> float:
    """Correlation r [1] of third differences by their signs: the bite is large and always alike."""
    signs = [np.sign(np.diff(a, 3)) * np.sign(np.diff(b, 3)) for a, b in pairs]
    products = np.concatenate(signs)
    products = products[products != 0.0]
    return (
        float(np.sin(0.5 * np.pi * np.mean(products)))
        if products.size >= LIMITS.run_fewest
        else 0.0
    )


def _residual_lag(view: Array, other: Array, lag: int) -> tuple[float, float]:
    """Steps by which ``other`` is later than ``lag``, by the slope of the wheels, and D then."""
    a, b = _over(view, other, lag)
    slope = np.gradient(b)
    square = float(slope @ slope)
    step = float(np.clip(slope @ (b - a) / square, -1.0, 1.0)) if square > 0.0 else 0.0
    return step, _apart(a, b - step * slope)


def _best_lag(a: Array, b: Array) -> int:
    """The lag of ``b`` in ``a`` [steps] with the least mean square difference."""
    least = max(LIMITS.run_fewest, int(LIMITS.run_overlap * min(a.size, b.size)))
    centre = float(a.mean())
    a, b = a - centre, b - centre
    lags = np.arange(least - b.size, a.size - least + 1)
    size = 1 << int(np.ceil(np.log2(a.size + b.size)))
    product = np.fft.irfft(np.fft.rfft(a, size) * np.conj(np.fft.rfft(b, size)), size)[lags]
    first, last = np.maximum(lags, 0), np.minimum(lags + b.size, a.size)
    squares = [np.concatenate([[0.0], np.cumsum(x**2)]) for x in (a, b)]
    total = squares[0][last] - squares[0][first]
    total += squares[1][last - lags] - squares[1][first - lags]
    return int(lags[np.argmin((total - 2.0 * product) / (last - first))])


def fingerprint_of(log: Log) -> Fingerprint:
    """The fingerprint of a run, which must have its wheel speeds."""
    view, channels = _view_of(log), []
    for name in (channel for channel in _COMPARED if channel in view):
        x = view[name]
        least = max(_FINE * _noise_of(x), float(np.max(np.abs(x), initial=0.0)) / _MOST)
        # a power of two, so that no rounding enters a product with it
        unit = 2.0 ** math.floor(math.log2(least)) if least > 0.0 else 1.0
        differences = np.diff(np.round(x / unit).astype(np.int64), 2, prepend=[0, 0])
        channels.append(_FingerprintChannel(name, unit, " ".join(map(str, differences))))
    return Fingerprint(VERSION, LIMITS.run_means, tuple(channels))


def _decoded(text: str) -> Array:
    """Values of second differences as text. Raises ValueError for no whole numbers."""
    try:
        differences = np.array([int(word) for word in text.split()], dtype=np.int64)
    except OverflowError as error:
        raise ValueError("a number of a fingerprint is too large") from error
    return np.cumsum(np.cumsum(differences)).astype(float)


def _view_of(log: Log, step: float = LIMITS.run_means, offset: float = 0.0) -> _View:
    """Means over every ``step`` [s] of the channels, from ``offset`` [s] on."""
    time = np.arange(log.time[0] + offset, log.time[-1] + 1e-9, step)
    integrals = {name: integral(log.time, log[name]) for name in _COMPARED if name in log}
    return _with_wheels(
        {name: np.diff(np.interp(time, log.time, x)) / step for name, x in integrals.items()}
    )


def _with_wheels(channels: dict[str, Array]) -> _View:
    return channels | {"wheels": np.mean([channels[name] for name in WHEEL_SPEEDS], axis=0)}


def _noise_of(x: Array) -> float:
    """Standard deviation of the noise of a channel and of its rounding, by third differences."""
    return max(white_noise(x), resolution_of(x) / math.sqrt(12.0))


def refuse_copies(fitted: Sequence[Log], held_out: Sequence[Log] = ()) -> None:
    """Raise LogError for a run that is given twice, among the ``fitted`` and ``held_out`` logs."""
    for i, log in enumerate(fitted):
        refuse_copy(log, fitted[:i])
    for i, log in enumerate(held_out):
        refuse_copy(log, fitted, held_out[:i])


def refuse_copy(log: Log, fitted: Sequence[Log], held_out: Sequence[Log] | None = None) -> None:
    """Raise LogError if ``log`` is one of ``fitted``, or, itself held out, of ``held_out``."""
    copied = next((k for k in (*fitted, *(held_out or ())) if same_run(k, log)), None)
    if copied is None:
        return
    reason, do = "given twice", "give each run once"
    if held_out is not None:
        reason = "held out twice"
        if any(copied is one for one in fitted):
            reason = "which is among the calibration logs: it is no hold-out and proves nothing"
            do = "hold out a run of its own"
    raise LogError(f"the same run as {copied.source}, {reason}", where=log.source, do=do)
