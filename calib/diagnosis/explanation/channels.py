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

from dataclasses import dataclass, replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.linalg import lstsq, qr

from calib.base.arrays import Array
from calib.base.intervals import QUARTILE
from calib.car.braking import MOVING
from calib.diagnosis.explanation.predict import ObservedRun, Prediction
from calib.run.filters import block_mean, samples_in

CHANNELS = ("a_x", "v", "rim", "front_rear", "front_sides", "rear_sides")
A_X, DRIFT, FRONT_REAR = (CHANNELS.index(name) for name in ("a_x", "v", "front_rear"))

_OF_WHEELS = np.array(
    [
        [0.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 0.0],
        [0.25, 0.25, 0.25, 0.25],
        [0.5, 0.5, -0.5, -0.5],
        [1.0, -1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, -1.0],
    ]
)
"""Channels by wheel speeds, in the order of `WHEELS`."""

_FLOOR = (0.005, 0.003, 0.005, 0.003, 0.003, 0.003)
"""Lower limit of the innovation's sd by channel, in its unit; simulated logs may have no noise."""

STEP = 0.02  # clock of the evidence [s]
ORDER = 3  # of the AR noise: road-coloured noise of 0.1 s at 50 Hz needs two to three
WALK = 0.9  # pole of the whitening filter of v: a drift of a tenth of the noise per step
LONG = 10 * ORDER  # least samples of an unbraked part that shows noise: ten for each coefficient
_PARABOLA = 3  # coefficients of the parabola that is taken out of every unbraked part


@dataclass(frozen=True)
class ChannelNoise:
    """AR coefficients (6, ORDER), of the oldest sample first, and innovation sd (6,), in its units.

    ``freedom`` is the number of independent samples that it was taken from.
    """

    coefficients: Array
    sigma: Array
    freedom: int


def residuals(run: ObservedRun, predicted: Prediction) -> Array:
    """Measured less predicted, (6, m) at the clock of the evidence, as long as the car moves."""
    r = of_wheels(run, run.omega - predicted.omega)
    r[:2] = thinned(run, np.stack([run.a_x - predicted.a_x, run.v_read - predicted.gained]))
    return r


def of_wheels(run: ObservedRun, omega: Array) -> Array:
    """Changes of the channels (..., 6, m) by changes of the wheel speeds (..., 4, n) [rad/s]."""
    return np.asarray(_OF_WHEELS @ thinned(run, omega))


def thinned(run: ObservedRun, x: Array) -> Array:
    """Means (..., m) of signals (..., n) at the clock of the evidence, as long as the car moves."""
    n = samples_in(STEP, run.step)
    stop = np.flatnonzero(run.v < MOVING)
    length = int(stop[0]) if stop.size else run.time.size
    return block_mean(x[..., :length], n)


def noise_of(parts: list[Array], wholes: list[Array]) -> ChannelNoise:
    """Noise from unbraked residuals, (6, m) each; a parabola is subtracted from every part.

    Where no part is long enough, from the third differences of the ``wholes``, (6, n) each: these
    hold almost no motion, and the noise then counts as white. Never below `_FLOOR`.
    """
    curves = ((part, _parabola(part.shape[1])) for part in parts if part.shape[1] >= LONG)
    long = [part - part @ curve @ curve.T for part, curve in curves]
    if long:
        rows = [sliding_window_view(part, ORDER + 1, axis=1) for part in long]
        coefficients = np.array(
            [lstsq(c[:, :-1], c[:, -1], rcond=None)[0] for c in np.concatenate(rows, axis=1)]
        )
        freedom = sum(part.shape[1] - ORDER - _PARABOLA for part in long) - ORDER
        unit = ChannelNoise(coefficients, np.ones(len(CHANNELS)), freedom)
        squares = sum(np.sum(by_channel(whiten(part, unit)) ** 2, axis=1) for part in long)
        each = np.full(len(CHANNELS), float(freedom))
        each[DRIFT] = sum(_freedom_of_drift(part.shape[1]) for part in long)
        return replace(unit, sigma=np.maximum(np.sqrt(squares / each), _FLOOR))
    scatter = [np.median(np.abs(np.diff(x, 3, axis=1)), axis=1) for x in wholes]
    # the median over the runs: a bite or a release does not move it
    sigma = np.maximum(np.median(scatter, axis=0) / QUARTILE / np.sqrt(20.0), _FLOOR)
    freedom = sum(x.shape[1] for x in wholes) // 4  # a third difference joins four samples
    return ChannelNoise(np.zeros((len(CHANNELS), ORDER)), sigma, freedom)


def _parabola(size: int) -> Array:
    """Orthonormal columns (m, `_PARABOLA`) that span the parabolas over ``size`` samples."""
    return np.asarray(qr(np.vander(np.linspace(-1.0, 1.0, size), _PARABOLA))[0])


def _freedom_of_drift(size: int) -> float:
    """Sum of squares that is kept of v where ``size`` samples of unit white noise are straightened.

    Each is the sum of the answers to all samples before, which are alike but for the first one.
    """
    first, later = _kept_drift(np.eye(2, size)) ** 2
    straight = np.sum(_kept_drift(_parabola(size).T) ** 2, axis=0)
    return float(np.sum((first + np.cumsum(later) - straight)[ORDER - 1 :]))


def _kept_drift(x: Array) -> Array:
    """Whitened v (..., m - 1), in its unit, of the residual (..., m): white noise keeps its sd."""
    from scipy.signal import lfilter

    # a difference of white noise, smoothed back: variance 2/(1 + WALK) of the noise
    smoothed = lfilter([1.0], [1.0, -WALK], np.diff(x))
    return np.asarray(smoothed / np.sqrt(2.0 / (1.0 + WALK)))


def whiten(residual: Array, noise: ChannelNoise) -> Array:
    """Innovations (..., n) over their sigma of residuals (..., 6, m), channel after channel."""
    size = residual.shape[-1] - ORDER
    terms = (noise.coefficients[:, k, None] * residual[..., k : k + size] for k in range(ORDER))
    innovations = residual[..., ORDER:] - sum(terms)
    innovations[..., DRIFT, :] = _kept_drift(residual[..., DRIFT, :])[..., -size:]
    return np.asarray(innovations / noise.sigma[:, None]).reshape(*residual.shape[:-2], -1)


def by_channel(innovations: Array) -> Array:
    """Innovations (n,) of a run by channel (6, m - ORDER)."""
    return innovations.reshape(len(CHANNELS), -1)
