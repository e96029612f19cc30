"""What remains on the hold-outs: their open-loop replays less the measurement, over the noise.

A replay uses pressure and first speed only (a ripple follows the angle of the wheels, too), so a
small lasting error, which an innovation of one step hides, adds up there. Means over half a second
hold the lasting errors alone: the noise of the sensors and the ripple of a disc that no effect
explains cancel in them.

    replays less logs --> means over blocks --> less what the parameters' own errors can do --> left

The model's parameters are known within their covariance. What a change within it explains is no
remainder and is taken out. The noise of the means is
that of their second differences, so noise that is correlated over a block counts as it is.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.base.intervals import QUARTILE
from calib.diagnosis.replays.gap import CHANNELS, noises_of
from calib.logs.log import Log
from calib.run.filters import block_mean

Array = NDArray[np.float64]

BLOCK = 0.5
"""Span of a mean [s]: several times the correlation time of a road's noise, a part of a stop."""

LEAST = 3.0
"""Rms of the lasting errors over the noise of the sensors from which something is left [1]. With
nothing hidden, on a plant with other forms of tyre than here, up to 1.3 is left; see
tests/studies/naming.py."""

_SURE = 5.0
"""Least distance of the sum of squares from that of noise, in its standard deviations."""

_FARTHEST = 2.0
"""Largest move along a direction of the parameters' covariance, in standard deviations: 95 %."""


@dataclass(frozen=True)
class Remainder:
    """What remains in the replays.

    ``size`` rms of the lasting errors over the noise of the sensors, noise and the parameters' own
    errors taken out [1]; ``sigma`` distance of their sum of squares from noise alone, in standard
    deviations; ``channel``, ``log`` where it is largest, and its ``largest`` rms there [1];
    ``pressure`` [Pa], ``speed`` [m/s], ``time`` [s since the start] ranges of 80 % of it there.
    """

    size: float
    sigma: float
    channel: str
    log: str
    largest: float
    pressure: tuple[float, float]
    speed: tuple[float, float]
    time: tuple[float, float]

    @property
    def significant(self) -> bool:
        """Whether it is more than noise, parameters and the usual form of a tyre can do."""
        return self.size > LEAST and self.sigma > _SURE


_Moved = Callable[[], Sequence[Sequence[Log]]]
"""Replays of all logs with the parameters moved along each direction of their covariance."""


def remainder_of(replays: Sequence[Log], measured: Sequence[Log], moved: _Moved) -> Remainder:
    """Judge replays of ``measured``; ``moved`` is called only where something seems to be left."""
    plain = _as_replayed(replays, measured)
    return apart_from_parameters(replays, measured, moved) if plain.significant else plain


def _as_replayed(replays: Sequence[Log], measured: Sequence[Log]) -> Remainder:
    """What remains with the parameters as they are."""
    return judged(*_lasting(replays, measured), measured)


def apart_from_parameters(
    replays: Sequence[Log], measured: Sequence[Log], moved: _Moved
) -> Remainder:
    """What remains, less what a change of the parameters within their covariance explains."""
    errors, noise, spread = _lasting(replays, measured)
    directions = [
        [lasting(sim, log) for log, sim in zip(replays, other, strict=True)] for other in moved()
    ]
    kept = without(errors, directions, spread) if directions else errors
    return judged(kept, noise, spread, measured)


def _lasting(replays: Sequence[Log], measured: Sequence[Log]) -> tuple[list[Array], Array, Array]:
    """The lasting errors (6, m) of each log; noise of the sensors and of the means, (6,)."""
    errors = [lasting(sim, log) for sim, log in zip(replays, measured, strict=True)]
    noise = noises_of(measured)
    spread = np.maximum(_noise_of_means(errors), noise / np.sqrt(_samples_of(measured)))
    return errors, noise, spread


def lasting(simulated: Log, measured: Log) -> Array:
    """Means over blocks of replay less measurement, (6, m), over their common samples."""
    n = min(simulated.time.size, measured.time.size)
    error = np.stack([simulated[c][:n] - measured[c][:n] for c in CHANNELS])
    return block_mean(error, _block_of(measured))


def _block_of(log: Log) -> int:
    """Samples in a block."""
    return max(1, round(BLOCK / log.sample_time))


def _samples_of(logs: Sequence[Log]) -> float:
    """Samples in a block, of the log with the fewest."""
    return float(min(_block_of(log) for log in logs))


def _noise_of_means(errors: Sequence[Array]) -> Array:
    """Sd of the noise of the means by channel (6,), from their second differences."""
    bends = [np.diff(e, 2, axis=1) for e in errors if e.shape[1] > 2]
    if not bends:
        return np.zeros(len(CHANNELS))
    typical = np.median(np.abs(np.concatenate(bends, axis=1)), axis=1)
    return np.asarray(typical / QUARTILE / np.sqrt(6.0))


def without(errors: list[Array], directions: list[list[Array]], spread: Array) -> list[Array]:
    """Errors less what moves of at most `_FARTHEST` along the directions explain."""
    from scipy.optimize import lsq_linear

    y = _flat(errors, errors, spread)
    A = np.stack([_flat(one, errors, spread) for one in directions], axis=1)
    moves = lsq_linear(A, y, bounds=(-_FARTHEST, _FARTHEST)).x
    out = []
    for i, own in enumerate(errors):
        m = min([own.shape[1], *(one[i].shape[1] for one in directions)])
        change = sum(u * one[i][:, :m] for u, one in zip(moves, directions, strict=True))
        out.append(own[:, :m] - change)
    return out


def _flat(values: list[Array], like: list[Array], spread: Array) -> Array:
    """All blocks over their noise, as one array; blocks that a replay lacks count nothing."""
    out = []
    for value, whole in zip(values, like, strict=True):
        full = np.zeros_like(whole)
        m = min(value.shape[1], whole.shape[1])
        full[:, :m] = value[:, :m]
        out.append((full / spread[:, None]).ravel())
    return np.concatenate(out)


def judged(
    errors: list[Array],
    noise: Array,
    spread: Array,
    measured: Sequence[Log],
) -> Remainder:
    """Size, certainty and place of what the means (6, m) of each log hold beyond their noise."""
    squares = np.array([np.mean(e**2, axis=1) for e in errors])
    excess = np.maximum(squares - spread**2, 0.0) / noise**2
    count = sum(e.size for e in errors)
    chi2 = sum(float(np.sum((e / spread[:, None]) ** 2)) for e in errors)
    row, column = divmod(int(np.argmax(excess)), len(CHANNELS))
    log, weight = measured[row], errors[row][column] ** 2
    grown = np.abs(np.diff(errors[row][column], prepend=0.0)) if column == V else weight
    size = _block_of(log)
    return Remainder(
        size=float(np.sqrt(np.mean(excess))),
        sigma=float((chi2 - count) / np.sqrt(2.0 * count)),
        channel=CHANNELS[column],
        log=log.name,
        largest=float(np.sqrt(excess[row, column])),
        pressure=range_of(block_mean(log["p_mc"], size), grown),
        speed=range_of(block_mean(log["v"], size), grown),
        time=range_of(block_mean(log.time - log.time[0], size), grown),
    )


V = CHANNELS.index("v")
"""The speed keeps an error of force: its growth tells where the force is wrong."""


def range_of(driver: Array, weight: Array) -> tuple[float, float]:
    """The range of a driver that holds the middle 80 % of the weight."""
    driver = driver[: weight.size]
    order = np.argsort(driver)
    share = np.cumsum(weight[order]) / max(float(np.sum(weight)), 1e-12)
    low, high = np.searchsorted(share, [0.1, 0.9])
    last = driver.size - 1
    return float(driver[order[min(low, last)]]), float(driver[order[min(high, last)]])
