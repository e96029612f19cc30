r"""What the bulk of a metric says of its tails: skewness, tail length and scale, all uncertain.

Tukey's g-and-h distribution (Hoaglin, in Exploring Data Tables, Trends, and Shapes, 1985, ch. 11):

    x = median + B T(z),   T = (exp(g z) - 1)/g exp(h z^2/2)      z standard normal

g = h = 0 is the normal distribution, h = 0 a lognormal one, h = 0.1 has about the tails of a t
distribution with 4 degrees of freedom. A few dozen cars cannot tell the shape, so none is chosen:
every shape of a grid counts by its likelihood. Values outside `Bulk.low` to `Bulk.high` count
only as a number on their side, so that outliers do not lengthen the tails by which they are judged.
"""

from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np

from calib.base.arrays import Array

SKEW = np.array([-0.9, -0.7, -0.5, -0.35, -0.2, 0.0, 0.2, 0.35, 0.5, 0.7, 0.9])
_SKEW_PRIOR = np.array([0.5, 0.5, 1.0, 1.5, 2.5, 988.0, 2.5, 1.5, 1.0, 0.5, 0.5]) / 1000.0
TAIL = np.array([0.0, 0.1, 0.2, 0.3])
TAIL_PRIOR = np.array([0.70, 0.18, 0.08, 0.04])
"""Weight of each g and h before any value is seen (`tests/studies/results/fleet_alarms.md`): with
more weight on long tails fewer bad cars are found, with less more good cars are named."""

_SCALES = 9
"""Number of scales B of the grid, over three standard deviations of log B."""

_MOST = 300
"""Most values that the likelihood takes; of more, as many quantiles stand for all."""

QUARTILE = 0.67449
_Z = np.linspace(-9.0, 9.0, 1801)
_STEP, _REACH = 0.01, 14.0
"""Grid of asinh(x/B), on which all shapes are tabulated."""


@dataclass(frozen=True)
class Bulk:
    """Cars by which a metric is judged: ``distance`` (k,) from the median, sorted.

    ``scale`` about that of B; ``low``, ``high`` ends of the values that count in full; ``below``,
    ``above`` number of cars outside them.
    """

    distance: Array
    scale: float
    low: float
    high: float
    below: int
    above: int

    @property
    def count(self) -> int:
        """All cars, with those outside."""
        return self.distance.size + self.below + self.above

    @property
    def _scales(self) -> Array:
        """Scales B of the grid: log B from quartiles has a standard deviation of 1.17/sqrt(n)."""
        reach = 3.0 * 1.17 / np.sqrt(self.count)
        return np.asarray(self.scale * np.exp(np.linspace(-reach, reach, _SCALES)))

    @cached_property
    def log_likelihood(self) -> Array:
        """Log likelihood by g, h and B, (11, 4, `_SCALES`), up to a constant."""
        from scipy.special import log_ndtr

        z, density = _tables()
        B = self._scales[:, None]
        x, weight = self.distance, 1.0
        if x.size > _MOST:
            weight = x.size / _MOST
            x = np.quantile(x, (np.arange(_MOST) + 0.5) / _MOST)
        inside = weight * np.sum(_at(density, x / B) - np.log(B), axis=2)
        ends = _at(z, np.array([self.low, self.high]) / B)
        outside = self.below * log_ndtr(ends[:, :, 0]) + self.above * log_ndtr(-ends[:, :, 1])
        return np.asarray((inside + outside).reshape(SKEW.size, TAIL.size, _SCALES))

    @property
    def evidence(self) -> Array:
        """Log evidence of each h, (4,), over g and B, the largest zero."""
        from scipy.special import logsumexp

        out = logsumexp(self.log_likelihood + np.log(_SKEW_PRIOR)[:, None, None], axis=(0, 2))
        return np.asarray(out - out.max())

    def two_sided(self, tail_prior: Array, distance: Array) -> Array:
        """Two-sided p (n,) of cars at a ``distance`` (n,) from the median, over all shapes.

        ``tail_prior`` (4,): weight of each h.
        """
        from scipy.special import ndtr, softmax

        prior = np.log(_SKEW_PRIOR)[:, None, None] + np.log(tail_prior)[None, :, None]
        weight = softmax(self.log_likelihood + prior).reshape(-1, _SCALES)
        used = weight.sum(axis=1) > 1e-9
        # the median is uncertain too: its variance is pi/2n of that of one car
        B = self._scales[:, None] * np.sqrt(1.0 + 0.5 * np.pi / self.count)
        z = _at(_tables()[0][used], distance / B)
        lower = np.einsum("sb,sbn->n", weight[used], ndtr(z))
        upper = np.einsum("sb,sbn->n", weight[used], ndtr(-z))
        return np.asarray(np.minimum(2.0 * np.minimum(lower, upper), 1.0))


@cache
def _tables() -> tuple[Array, Array]:
    """z and log density of each shape over the grid of asinh(x/B), each (44, k), g by g.

    B is that of the quartiles.
    """
    x = np.sinh(np.arange(-_REACH, _REACH + _STEP, _STEP))
    z, densities = [], []
    for g in SKEW:
        for h in TAIL:
            grown = np.exp(0.5 * h * _Z**2)
            body = _Z if g == 0.0 else np.expm1(g * _Z) / g
            slope = grown * (np.exp(g * _Z) + h * _Z * body)
            ends = np.interp([-QUARTILE, QUARTILE], _Z, body * grown)
            c = (ends[1] - ends[0]) / (2.0 * QUARTILE)
            density = -0.5 * _Z**2 - np.log(np.maximum(slope, 1e-300) / c)
            place = body * grown / c
            z.append(np.interp(x, place, _Z))
            densities.append(np.interp(x, place, density, left=-1e3, right=-1e3))
    return np.array(z), np.array(densities)


def _at(tables: Array, u: Array) -> Array:
    """Values of all ``tables`` (s, k) at x/B = ``u``, shape (s, *u.shape)."""
    at = np.clip((np.arcsinh(u) + _REACH) / _STEP, 0.0, tables.shape[1] - 1.001)
    i = at.astype(np.intp)
    low, high = tables.take(i, axis=1), tables.take(i + 1, axis=1)
    return np.asarray(low + (high - low) * (at - i))
