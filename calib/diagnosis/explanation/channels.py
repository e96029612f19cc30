"""Six channels of evidence from a run, and their noise.

    a_x          accelerometer                       [m/s^2]
    v            speed against the integral of a_x   [m/s]     drift of the speed
    rim          mean wheel speed against v          [rad/s]   mean slip
    front_rear   front less rear                     [rad/s]   the split: v cancels
    front_sides  left less right, front              [rad/s]
    rear_sides   left less right, rear               [rad/s]

The noise of each channel is an AR process fitted to the unbraked parts. A residual is whitened with
it: the result is white with variance 1 if the model is right. The drift of v is a random walk under
white noise; its whitening filter is (1 - B)/(1 - 0.9 B).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.base.intervals import QUARTILE
from calib.car.braking import BITE, MOVING
from calib.diagnosis.explanation.predict import ObservedRun, Prediction
from calib.run.filters import block_mean

Array = NDArray[np.float64]

CHANNELS = ("a_x", "v", "rim", "front_rear", "front_sides", "rear_sides")
DRIFT = CHANNELS.index("v")

STEP = 0.02
"""Clock of the evidence [s]."""

ORDER = 3
"""Order of the AR noise: road-coloured noise of 0.1 s at 50 Hz needs two to three."""

WALK = 0.9
"""Pole of the whitening filter of v: allows a drift of about a tenth of the noise per step."""

FLOOR = (0.005, 0.003, 0.005, 0.003, 0.003, 0.003)
"""Lower limit of the innovation's sd by channel, in its unit; simulated logs may have no noise."""

_PARABOLA = 3
"""Coefficients of the parabola that is taken out of every unbraked part."""

_DIFFERENCED = 4
"""Samples that a third difference joins: so many count as one."""

LONG = 10 * ORDER
"""Least samples of an unbraked part that shows noise: ten for each coefficient."""


@dataclass(frozen=True)
class ChannelNoise:
    """AR coefficients (6, ORDER) and innovation sd (6,) of the channels, in their units.

    ``source`` says what it was taken from, ``freedom`` from how many independent samples.
    """

    coefficients: Array
    sigma: Array
    source: str
    freedom: int

    @property
    def at_floor(self) -> tuple[str, ...]:
        """Channels whose noise is `FLOOR`, as they show less."""
        pairs = zip(CHANNELS, self.sigma, FLOOR, strict=True)
        return tuple(name for name, sigma, floor in pairs if sigma <= floor)


def residuals(run: ObservedRun, predicted: Prediction) -> Array:
    """Measured less predicted, (6, m) at the clock of the evidence, as long as the car moves."""
    force = np.stack([run.a_x - predicted.a_x, run.v - predicted.gained])
    return thinned(run, np.vstack([force, _of_wheels(run.omega - predicted.omega)]))


def of_wheels(run: ObservedRun, omega: Array) -> Array:
    """Changes of the channels (..., 6, m) by changes of the wheel speeds (..., 4, n) [rad/s]."""
    wheels = _of_wheels(omega)
    return thinned(run, np.concatenate([0.0 * wheels[..., :2, :], wheels], axis=-2))


def _of_wheels(omega: Array) -> Array:
    """The last four channels (..., 4, n) of wheel speeds (..., 4, n)."""
    fl, fr, rl, rr = np.moveaxis(omega, -2, 0)
    rim, apart = 0.25 * (fl + fr + rl + rr), 0.5 * (fl + fr - rl - rr)
    return np.stack([rim, apart, fl - fr, rl - rr], axis=-2)


def thinned(run: ObservedRun, x: Array) -> Array:
    """Means (..., m) of signals (..., n) at the clock of the evidence, as long as the car moves."""
    n = max(1, round(STEP / run.step))
    stop = np.flatnonzero(run.v_smooth < MOVING)
    length = int(stop[0]) if stop.size else run.time.size
    return block_mean(x[..., :length], n)


def unbraked_length(run: ObservedRun) -> int:
    """Steps of evidence before the brake first bites, less a margin."""
    p = thinned(run, run.p_mc)
    braked = np.flatnonzero(p > 0.5 * BITE)
    return max(int(braked[0]) - 8, 0) if braked.size else p.size


def noise_of(parts: list[Array], wholes: list[Array]) -> ChannelNoise:
    """Noise from unbraked residuals, (6, m) each; a parabola is subtracted from every part.

    Where no part is long enough, from the third differences of the ``wholes``, (6, n) each: these
    hold almost no motion, and the noise then counts as white. Never below `FLOOR`.
    """
    long = [part for part in parts if part.shape[1] >= LONG]
    if not long:
        return _noise_of_differences(wholes)
    coefficients, sigma = [], []
    freedom = sum(part.shape[1] - ORDER - _PARABOLA for part in long) - ORDER
    for c in range(len(CHANNELS)):
        rows, sides = [], []
        for part in long:
            x, m = _straightened(part[c]), part.shape[1]
            rows.append(np.stack([x[ORDER - k - 1 : m - k - 1] for k in range(ORDER)], axis=1))
            sides.append(x[ORDER:])
        A, y = np.vstack(rows), np.concatenate(sides)
        fitted = np.linalg.lstsq(A, y, rcond=None)[0]
        coefficients.append(fitted)
        sigma.append(float(np.sqrt(np.sum((y - A @ fitted) ** 2) / freedom)))
    sigma[DRIFT] = _noise_of_drift([part[DRIFT] for part in long])
    return ChannelNoise(np.array(coefficients), np.maximum(sigma, FLOOR), "unbraked parts", freedom)


def _straightened(x: Array) -> Array:
    """An unbraked part (m,) of a channel without its parabola."""
    parabola = _parabola(x.size)
    return np.asarray(x - parabola @ np.linalg.lstsq(parabola, x, rcond=None)[0])


def _parabola(size: int) -> Array:
    """Columns (m, `_PARABOLA`) that span the parabolas over ``size`` samples."""
    return np.vander(np.linspace(-1.0, 1.0, size), _PARABOLA)


def _noise_of_drift(parts: list[Array]) -> float:
    """Sd of v as its own filter shows it: a speed that is sent seldom has little white noise."""
    shown = [_kept_drift(_straightened(part)) for part in parts]
    freedom = sum(_freedom_of_drift(part.size) for part in parts)
    return float(np.sqrt(sum(float(x @ x) for x in shown) / freedom))


def _freedom_of_drift(size: int) -> float:
    """Sum of squares that the filter of v leaves of ``size`` samples of unit white noise.

    That of its rows, (1, w - 1, w (w - 1), ... -w^i) back in time for row i with w = `WALK`, less
    that of the parabola, which is taken out before.
    """
    power = WALK ** (2.0 * np.arange(size - 1))
    rows = 1.0 + (1.0 / WALK - 1.0) ** 2 * (np.cumsum(power) - 1.0) + power
    parabola = np.linalg.qr(_parabola(size))[0]
    return float(np.sum(rows) * (1.0 + WALK) / 2.0 - np.sum(_kept_drift(parabola.T) ** 2))


def _kept_drift(x: Array) -> Array:
    """Whitened v (..., m - 1), in its unit, of the residual (..., m): white noise keeps its sd."""
    from scipy.signal import lfilter

    # a difference of white noise, smoothed back: variance 2/(1 + WALK) of the noise
    kept = lfilter([1.0], [1.0, -WALK], np.diff(x))
    return np.asarray(kept / np.sqrt(2.0 / (1.0 + WALK)))


def _noise_of_differences(wholes: list[Array]) -> ChannelNoise:
    """White noise, its sd the median over the runs; a bite or a release does not move that."""
    found = [np.median(np.abs(np.diff(x, 3, axis=1)), axis=1) for x in wholes if x.shape[1] > 3]
    typical = np.median(found, axis=0) if found else np.zeros(len(CHANNELS))
    sigma = np.maximum(typical / QUARTILE / np.sqrt(20.0), FLOOR)
    freedom = max(sum(x.shape[1] for x in wholes) // _DIFFERENCED, 1)
    source = "differences between samples"
    return ChannelNoise(np.zeros((len(CHANNELS), ORDER)), sigma, source, freedom)


def whiten(residual: Array, noise: ChannelNoise) -> Array:
    """Innovations (..., n) over their sigma of residuals (..., 6, m), channel after channel."""
    m, parts = residual.shape[-1], []
    for c, coefficients in enumerate(noise.coefficients):
        x = residual[..., c, :]
        if c == DRIFT:
            kept = _kept_drift(x)
        else:
            told = (a * x[..., ORDER - 1 - k : m - 1 - k] for k, a in enumerate(coefficients))
            kept = x[..., ORDER:] - sum(told)
        parts.append(kept / noise.sigma[c])
    return np.concatenate(parts, axis=-1)


def by_channel(innovations: Array) -> list[Array]:
    """Innovations (n,) of a run, channel after channel, as one array each."""
    steps = (innovations.size + (len(CHANNELS) - 1) * ORDER + 1) // len(CHANNELS)
    sizes = [steps - (1 if c == DRIFT else ORDER) for c in range(len(CHANNELS))]
    return np.split(innovations, np.cumsum(sizes)[:-1])
