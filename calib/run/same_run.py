"""Whether two logs are one run: saved in another format, rounded, cut or resampled.

Two runs have independent noise, even if a robot drives both; a copy has the noise of its original.
Means a and b over 50 ms are aligned by the wheel speeds. Their difference is compared with their
noise, sigma. Where D is close to 1, third differences, which are noise alone, decide by r:

    D = spread of (a - b), squared, over sigma_a^2 + sigma_b^2     one run: 0 to 0.9; two: 1 or more
    r = sin(pi/2 * mean(sign(a''') * sign(b''')))                  one run: 0.3 to 1; two: about 0

A copy with most channels rounded to more than five times their noise counts as another run.

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
_LAG_STEPS = 3  # Newton steps to a lag that is not a whole number of means
VERSION = 1
_FINE = 0.25  # unit of the whole numbers over the noise [1]: rounding adds 0.3 % to its square
_MOST = 2.0**40  # largest whole number of a channel that has no noise

_View = dict[str, Array]  # means of the channels [SI]; ``wheels`` is that of the four wheel speeds


@dataclass(frozen=True)
class _FingerprintChannel:
    """A channel as whole multiples of a unit."""

    name: str
    unit: float  # [SI]
    differences: str  # second differences of the multiples, as text


@dataclass(frozen=True)
class Fingerprint:
    """Means over ``step`` [s] of the channels of a run; ValueError if they have another format."""

    version: int
    step: float
    channels: tuple[_FingerprintChannel, ...]

    def __post_init__(self) -> None:
        names = {channel.name for channel in self.channels}
        sizes = {_decoded(channel.differences).size for channel in self.channels}
        units = (self.step, *(channel.unit for channel in self.channels))
        has_names = names.issuperset(WHEEL_SPEEDS) and names.issubset(_COMPARED)
        has_values = len(sizes) == 1 and all(0.0 < unit < math.inf for unit in units)
        if not (self.version == VERSION and has_names and has_values):
            raise ValueError(f"no fingerprint of a run in version {VERSION} of its format")

    @cached_property
    def view(self) -> _View:
        """The means of the channels and of the wheels [SI], each (n,)."""
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
    """Whether the channels agree at the best lag.

    The lag is first a whole number of means over ``step`` [s]. The means of ``other`` are then
    computed again from a later time on, until the means of both runs begin together.
    """
    b = _view_of(other, step)
    if min(a["wheels"].size, b["wheels"].size) < LIMITS.run_fewest:
        return False
    lag = _best_lag(a["wheels"], b["wheels"])
    exact_lag = float(lag)
    for _ in range(_LAG_STEPS):
        change, spread = _residual_lag(a["wheels"], b["wheels"], lag)
        if spread > LIMITS.run_far:
            return False
        if _is_one_run(a, b, lag):
            return True
        exact_lag += change
        lag = int(np.ceil(exact_lag))
        b = _view_of(other, step, (lag - exact_lag) * step)
        shorter, longer = sorted((a["wheels"].size, b["wheels"].size))
        if min(shorter, longer - abs(lag)) < LIMITS.run_fewest:
            return False
    return _is_one_run(a, b, lag)


def _is_one_run(view: _View, other: _View, lag: int) -> bool:
    """Whether D, the median over the channels, and r show one run; ``lag`` as in `_overlap`."""
    pairs: dict[str, tuple[Array, Array]] = {}
    for name in (channel for channel in _COMPARED if channel in view and channel in other):
        if np.ptp(view[name]) > 0.0 or np.ptp(other[name]) > 0.0:
            pairs[name] = _overlap(view[name], other[name], lag)
    spreads = {name: _spread(a, b) for name, (a, b) in pairs.items()}
    wheels = [spreads.pop(name) for name in WHEEL_SPEEDS if name in spreads]
    if wheels:  # they count as one channel
        spreads["wheels"] = float(np.median(wheels))
    spread = float(np.median(list(spreads.values()))) if spreads else np.inf
    if spread < LIMITS.run_alike:
        return True
    r = _sign_correlation(list(pairs.values()))
    return bool(spread < LIMITS.run_two and r > LIMITS.run_together)


def _overlap(view: Array, other: Array, lag: int) -> tuple[Array, Array]:
    """Parts of two signals at the same time, if ``other`` begins ``lag`` means after ``view``."""
    a, b = view[max(lag, 0) :], other[max(-lag, 0) :]
    n = min(a.size, b.size)
    return a[:n], b[:n]


def _spread(a: Array, b: Array) -> float:
    """Return D [1] of the head of the file for one channel."""
    square = scatter(a - b) ** 2
    noise = _noise_of(a) ** 2 + _noise_of(b) ** 2
    if noise == 0.0:
        return 0.0 if square == 0.0 else np.inf
    return square / noise


def _sign_correlation(pairs: list[tuple[Array, Array]]) -> float:
    """Correlation r [1] of third differences, by their signs, as the bite is large in all runs."""
    signs = [np.sign(np.diff(a, 3)) * np.sign(np.diff(b, 3)) for a, b in pairs]
    products = np.concatenate(signs)
    products = products[products != 0.0]
    if products.size < LIMITS.run_fewest:
        return 0.0
    return float(np.sin(0.5 * np.pi * np.mean(products)))


def _residual_lag(view: Array, other: Array, lag: int) -> tuple[float, float]:
    """Lag beyond ``lag`` [means], at most 1, by the slope of the signals; and D at that lag."""
    a, b = _overlap(view, other, lag)
    slope = np.gradient(b)
    square = float(slope @ slope)
    change = float(np.clip(slope @ (b - a) / square, -1.0, 1.0)) if square > 0.0 else 0.0
    return change, _spread(a, b - change * slope)


def _best_lag(a: Array, b: Array) -> int:
    """Lag [means], as in `_overlap`, with the least mean square difference.

    The sum of (a - b)^2 over the overlap is that of a^2 + b^2 less twice that of a b, a correlation
    that the Fourier transform gives for all lags at once.
    """
    least = max(LIMITS.run_fewest, int(LIMITS.run_overlap * min(a.size, b.size)))
    centre = float(a.mean())
    a, b = a - centre, b - centre
    lags = np.arange(least - b.size, a.size - least + 1)
    size = 1 << int(np.ceil(np.log2(a.size + b.size)))  # a power of two; zeros fill both signals
    product = np.fft.irfft(np.fft.rfft(a, size) * np.conj(np.fft.rfft(b, size)), size)[lags]
    first, last = np.maximum(lags, 0), np.minimum(lags + b.size, a.size)
    squares_a, squares_b = (np.concatenate([[0.0], np.cumsum(x**2)]) for x in (a, b))
    squares = squares_a[last] - squares_a[first]
    squares += squares_b[last - lags] - squares_b[first - lags]
    return int(lags[np.argmin((squares - 2.0 * product) / (last - first))])


def fingerprint_of(log: Log) -> Fingerprint:
    """Return the fingerprint of a run, which must have its wheel speeds."""
    view, channels = _view_of(log), []
    for name in (channel for channel in _COMPARED if channel in view):
        x = view[name]
        least = max(_FINE * _noise_of(x), float(np.max(np.abs(x), initial=0.0)) / _MOST)
        # a power of two, so that a product with it is exact
        unit = 2.0 ** math.floor(math.log2(least)) if least > 0.0 else 1.0
        differences = np.diff(np.round(x / unit).astype(np.int64), 2, prepend=[0, 0])
        channels.append(_FingerprintChannel(name, unit, " ".join(map(str, differences))))
    return Fingerprint(VERSION, LIMITS.run_means, tuple(channels))


def _decoded(text: str) -> Array:
    """Whole numbers (n,) from their second differences as text; ValueError for another text."""
    try:
        differences = np.array([int(word) for word in text.split()], dtype=np.int64)
    except OverflowError as error:
        raise ValueError("a number of a fingerprint is too large") from error
    return np.cumsum(np.cumsum(differences)).astype(float)


def _view_of(log: Log, step: float = LIMITS.run_means, offset: float = 0.0) -> _View:
    """Means of the channels over every ``step`` [s], from ``offset`` [s] on."""
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
        refuse_copy(log, fitted[:i], "given twice")
    leak = "which is among the calibration logs: it is no hold-out and proves nothing"
    for i, log in enumerate(held_out):
        refuse_copy(log, fitted, leak, "hold out a run of its own")
        refuse_copy(log, held_out[:i])


def refuse_copy(
    log: Log, others: Sequence[Log], flaw: str = "held out twice", do: str = "give each run once"
) -> None:
    """Raise LogError with the ``flaw`` and what to ``do`` if ``log`` is a copy of one of others."""
    for other in others:
        if same_run(other, log):
            text = f"the same run as {other.source}, {flaw}"
            raise LogError(text, where=log.source, do=do)
