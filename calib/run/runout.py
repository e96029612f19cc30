"""Remove the error of a tone ring from a wheel speed.

The ring of a wheel speed sensor that has run-out or a damaged tooth makes an error that repeats
with the wheel angle phi:

    omega read = omega (1 + sum_k a_k cos(k phi) + b_k sin(k phi))      k = 1, 2

Run-out of 0.05 mm on a radius of 50 mm makes an error of 0.1 % once a turn, a third of the change
of eta in a braking; an oval ring errs twice a turn. The mean speed over one turn has no such error,
so omega over that mean shows the error and the noise. a_k and b_k are constant over a log.
"""

import numpy as np

from calib.base.arrays import Array
from calib.base.intervals import scatter
from calib.car.lag import integral

_SLOWEST = 15.0  # least wheel speed [rad/s]: in a slower turn the brakes may build up fully
_TURNS = 20  # fewest turns that separate an error of the ring from motion of the car
_COARSEST = 0.5 * np.pi  # largest angle between two samples [rad]: the second order must be seen
_FEWEST = 100  # fewest samples of a fit
_SMALLEST = 2e-4  # amplitude below which a ring is good [1]
_SURE = 6.0
"""Amplitude over its sigma by white noise from which an order k is an error of the ring. Logs with
good rings have 2.4 in the median and 5 at most (327 logs, the largest of 8 orders of each)."""
_ALIKE = 0.5
"""Largest change of a ring's error between both halves of a log, over its amplitude [1]. The noise
of a slow bus has another phase in each half."""


def without_runout(omega: Array, step: float) -> Array:
    """Return a wheel speed [rad/s] (n,) without significant errors of its ring; ``step`` [s]."""
    time = step * np.arange(omega.size, dtype=np.float64)
    angle = integral(time, omega)
    use = (omega > _SLOWEST) & (omega * step < _COARSEST)
    use &= (angle > np.pi) & (angle < angle[-1] - np.pi)
    if np.count_nonzero(use) < _FEWEST or angle[-1] < 2.0 * np.pi * _TURNS:
        return omega
    rising = np.maximum.accumulate(angle)
    angles = angle[use]
    turn_start, turn_end = (np.interp(angles + x, rising, time) for x in (-np.pi, np.pi))
    # omega over its mean in the turn around the sample, less 1
    error = omega[use] * (turn_end - turn_start) / (2.0 * np.pi) - 1.0
    near = np.abs(error) <= 5.0 * max(scatter(error), 1e-9)
    if np.count_nonzero(near) < _FEWEST:
        return omega
    error, columns = error[near], _orders(angles[near])
    middle = error.size // 2
    fitted = _coefficients(columns, error)
    early = _coefficients(columns[:, :middle], error[:middle])
    late = _coefficients(columns[:, middle:], error[middle:])
    amplitude, change = (np.hypot(x[0::2], x[1::2]) for x in (fitted, early - late))  # (2,) orders
    sigma = float(np.std(error - fitted @ columns)) * np.sqrt(2.0 / error.size)
    significant = (amplitude > max(_SURE * sigma, _SMALLEST)) & (change < _ALIKE * amplitude)
    if not significant.any():
        return omega
    return np.asarray(omega / (1.0 + (fitted * np.repeat(significant, 2)) @ _orders(angle)))


def _coefficients(columns: Array, error: Array) -> Array:
    """Least squares a_1, b_1, a_2, b_2 of ``error`` (n,) on ``columns`` (4, n)."""
    return np.asarray(np.linalg.solve(columns @ columns.T, columns @ error))


def _orders(angle: Array) -> Array:
    """Cosine and sine (4, n) of once and twice the ``angle`` (n,)."""
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.stack([cosine, sine, cosine**2 - sine**2, 2.0 * cosine * sine])
