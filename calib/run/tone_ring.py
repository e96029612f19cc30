"""A tone ring that runs out, or has a damaged tooth: an error that turns with its wheel.

    omega read = omega (1 + sum_k a_k cos(k phi) + b_k sin(k phi))      k = 1, 2

phi is the angle of the wheel, the integral of omega. A ring that is 0.05 mm off its centre on a
radius of 50 mm errs by 0.1 % once a turn, a third of what eta shows of a braking; an oval one errs
twice a turn. Over one turn it cancels: omega over its mean of the turn around it holds the error
and noise, and what turns with the angle is the error. The whole log counts: a ring has one error.

Source: the model is that of the effect `tone_ring_runout`.
"""

import numpy as np
from numpy.typing import NDArray

from calib.base.intervals import QUARTILE
from calib.car.lag import integral

Array = NDArray[np.float64]

SLOWEST = 15.0
"""Wheel speed [rad/s] below which a turn takes longer than a brake needs to build up."""

TURNS = 20
"""Least number of turns that tell an error of the ring from what the car does."""

COARSEST = 0.5 * np.pi
"""Largest angle between two samples [rad]: twice a turn must be seen."""

FEWEST = 100
"""Least number of samples that tell it."""

SURE = 6.0
"""Standard deviations of white noise past which an order is an error of the ring. Of 327 logs with
good rings the largest of eight has 2.4 in the middle, and 5 at most."""

ALIKE = 0.5
"""Difference of both halves of a log, over the error [1], up to which it is that of a ring. What
goes with the car, as noise of a slow bus, has another phase in each half."""

LEAST = 2e-4
"""Error [1] below which a ring is good."""


def without_runout(omega: Array, step: float) -> Array:
    """A wheel speed [rad/s] (n,) without the error of its ring; as it is where none is sure.

    ``step`` is the sample time [s].
    """
    time = step * np.arange(omega.size, dtype=np.float64)
    angle = integral(time, omega)
    inside = (omega > SLOWEST) & (omega * step < COARSEST)
    inside &= (angle > np.pi) & (angle < angle[-1] - np.pi)
    if np.count_nonzero(inside) < FEWEST or angle[-1] < 2.0 * np.pi * TURNS:
        return omega
    rising = np.maximum.accumulate(angle)
    turn = np.interp(angle + np.pi, rising, time) - np.interp(angle - np.pi, rising, time)
    apart = omega[inside] * turn[inside] / (2.0 * np.pi) - 1.0
    spread = float(np.median(np.abs(apart))) / QUARTILE
    near = np.abs(apart) <= 5.0 * max(spread, 1e-9)
    if np.count_nonzero(near) < FEWEST:
        return omega
    once, again = np.cos(angle), np.sin(angle)
    turning = np.stack([once, again, once**2 - again**2, 2.0 * once * again])
    columns, apart = turning[:, inside][:, near], apart[near]
    whole, half = _fitted(columns, apart), apart.size // 2
    halves = _fitted(columns[:, :half], apart[:half]), _fitted(columns[:, half:], apart[half:])
    size = _sizes(whole)
    sigma = float(np.std(apart - whole @ columns)) * np.sqrt(2.0 / apart.size)
    sure = size > max(SURE * sigma, LEAST)
    lasting = _sizes(halves[0] - halves[1]) < ALIKE * size
    kept = np.repeat(sure & lasting, 2)
    return omega / (1.0 + (whole * kept) @ turning) if kept.any() else omega


def _fitted(columns: Array, apart: Array) -> Array:
    """Factors (4,) of cosine and sine, once and twice a turn, by least squares."""
    return np.asarray(np.linalg.solve(columns @ columns.T, columns @ apart))


def _sizes(factors: Array) -> Array:
    """Size (2,) of what goes once and twice a turn."""
    return np.hypot(factors[0::2], factors[1::2])
