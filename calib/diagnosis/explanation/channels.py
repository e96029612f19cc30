"""Six channels of evidence from a run, and their noise.

    a_x          accelerometer                       [m/s^2]
    v            speed against its predicted change  [m/s]     drift of the speed
    rim          mean wheel speed against v          [rad/s]   mean slip
    front_rear   front less rear                     [rad/s]   the split: v cancels
    front_sides  left less right, front              [rad/s]
    rear_sides   left less right, rear               [rad/s]

The channels have a clock of 20 ms. The noise of each channel is an autoregressive (AR) process
fitted to the unbraked parts. A filter turns residuals into innovations, which are white with
variance 1 if the model is right. The residual of v is white noise plus a random walk, its drift;
its filter is (1 - B)/(1 - 0.9 B), where B delays by a sample.
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
A_X, SPEED, FRONT_REAR = (CHANNELS.index(name) for name in ("a_x", "v", "front_rear"))

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
"""Coefficients (6, 4) of the channels on the wheel speeds, in the order of `WHEELS`."""
_FLOOR = (0.005, 0.003, 0.005, 0.003, 0.003, 0.003)
"""Least standard deviations (6,) of the noise, in the channels' units: a simulation has none."""
STEP = 0.02  # clock of the channels [s]
ORDER = 3  # order of the AR noise: a road, correlated over 0.1 s, needs 2 to 3 at 50 Hz
_POLE = 0.9  # of the filter of v, for a drift per step of a tenth of the noise
_LEAST_SAMPLES = 10 * ORDER  # of an unbraked part that shows noise: ten for each coefficient
_PARABOLA = 3  # coefficients of the parabola that is taken out of every unbraked part


@dataclass(frozen=True)
class ChannelNoise:
    """AR process of the noise of each channel."""

    coefficients: Array  # (6, ORDER), of the oldest sample first
    sigma: Array  # standard deviations of the white noise that drives it, in channel units (6,)
    freedom: int  # number of independent samples from which the noise was estimated


def residuals(run: ObservedRun, predicted: Prediction) -> Array:
    """Measured less predicted readings (6, m), as long as the car moves."""
    r = of_wheels(run, run.omega - predicted.omega)
    r[A_X] = thinned(run, run.a_x - predicted.a_x)
    # the first speed is still in it: a constant, which the filter of v takes out
    r[SPEED] = thinned(run, run.v_read - predicted.speed_gain)
    return r


def of_wheels(run: ObservedRun, omega: Array) -> Array:
    """Channels (..., 6, m) of wheel speeds ``omega`` (..., 4, n), or their changes."""
    return np.asarray(_OF_WHEELS @ thinned(run, omega))


def thinned(run: ObservedRun, x: Array) -> Array:
    """Means (..., m) of signals (..., n) over `STEP`, as long as the car moves."""
    n = samples_in(STEP, run.step)
    slow = np.flatnonzero(run.v < MOVING)
    length = int(slow[0]) if slow.size else run.time.size
    return block_mean(x[..., :length], n)


def noise_of(unbraked: list[Array], whole: list[Array]) -> ChannelNoise:
    """Estimate the noise, not below `_FLOOR`, from the ``unbraked`` residuals (6, m) of each run.

    A parabola is taken out of the residuals of each run. If all unbraked parts are too short, white
    noise is estimated from the residuals (6, n) of the ``whole`` runs.
    """
    parts = [r for r in unbraked if r.shape[1] >= _LEAST_SAMPLES]
    if not parts:
        return _white_noise_of(whole)
    curves = [_parabola(r.shape[1]) for r in parts]
    straight = [r - r @ curve @ curve.T for r, curve in zip(parts, curves, strict=True)]
    windows = [sliding_window_view(r, ORDER + 1, axis=1) for r in straight]
    coefficients = np.array(
        [lstsq(x[:, :-1], x[:, -1], rcond=None)[0] for x in np.concatenate(windows, axis=1)]
    )
    freedom = sum(r.shape[1] - ORDER - _PARABOLA for r in straight) - ORDER
    noise = ChannelNoise(coefficients, np.ones(len(CHANNELS)), freedom)
    squares = sum(np.sum(by_channel(whiten(r, noise)) ** 2, axis=1) for r in straight)
    freedoms = np.full(len(CHANNELS), float(freedom))
    freedoms[SPEED] = sum(_freedom_of_drift(r.shape[1]) for r in straight)
    return replace(noise, sigma=np.maximum(np.sqrt(squares / freedoms), _FLOOR))


def _white_noise_of(whole: list[Array]) -> ChannelNoise:
    """White noise by third differences of residuals (6, n), which contain almost no motion."""
    medians = [np.median(np.abs(np.diff(r, 3, axis=1)), axis=1) for r in whole]
    # the median over the runs: a bite or a release does not move it
    sigma = np.maximum(np.median(medians, axis=0) / QUARTILE / np.sqrt(20.0), _FLOOR)
    freedom = sum(r.shape[1] for r in whole) // 4  # a third difference joins four samples
    return ChannelNoise(np.zeros((len(CHANNELS), ORDER)), sigma, freedom)


def _parabola(size: int) -> Array:
    """Orthonormal columns (m, `_PARABOLA`) that span the parabolas over ``size`` samples."""
    return np.asarray(qr(np.vander(np.linspace(-1.0, 1.0, size), _PARABOLA))[0])


def _freedom_of_drift(size: int) -> float:
    """Expected sum of squares [1] of v, if its ``size`` samples are noise of variance 1, whitened.

    A parabola is taken out first. A whitened sample is a sum of the responses to all noise samples
    up to it, so its variance is the sum of the squared responses. All noise samples but the first
    have the same response, shifted.
    """
    first, later = _whitened_drift(np.eye(2, size)) ** 2  # squared responses to samples 0 and 1
    of_parabola = np.sum(_whitened_drift(_parabola(size).T) ** 2, axis=0)
    variances = first + np.cumsum(later) - of_parabola
    return float(np.sum(variances[ORDER - 1 :]))


def _whitened_drift(x: Array) -> Array:
    """Whitened v (..., m - 1) [m/s] of the residual (..., m); white noise keeps its variance."""
    from scipy.signal import lfilter

    # differences of white noise, filtered, have 2/(1 + _POLE) of its variance
    smoothed = lfilter([1.0], [1.0, -_POLE], np.diff(x))
    return np.asarray(smoothed / np.sqrt(2.0 / (1.0 + _POLE)))


def whiten(residual: Array, noise: ChannelNoise) -> Array:
    """Innovations (..., 6 (m - ORDER)) of residuals (..., 6, m), channel after channel."""
    size = residual.shape[-1] - ORDER
    terms = (noise.coefficients[:, k, None] * residual[..., k : k + size] for k in range(ORDER))
    innovations = residual[..., ORDER:] - sum(terms)
    innovations[..., SPEED, :] = _whitened_drift(residual[..., SPEED, :])[..., -size:]
    return np.asarray(innovations / noise.sigma[:, None]).reshape(*residual.shape[:-2], -1)


def by_channel(innovations: Array) -> Array:
    """Innovations (n,) of a run by channel, (6, m - ORDER)."""
    return innovations.reshape(len(CHANNELS), -1)
