"""Outliers of a fleet, with a limited share of false ones also in a large fleet.

    z = (x - median)/(1.4826 MAD)      robust: outliers do not increase the scale

From 100 cars on, a metric whose bulk is clearly skewed or long-tailed is first transformed to a
normal one, see `calib.fleet.tails`; z is that of the transformed metric. In a small fleet the scale
is uncertain: without outliers z has nearly a t distribution with 0.37 (n - 1) degrees of freedom,
because the MAD has 37 % of the efficiency of a standard deviation (Huber, Robust Statistics, 1981,
ch. 5). By the rule of Benjamini and Hochberg (1995) at most a share `SHARE` of the named cars is
named wrongly, over all metrics and cars, if the bulk is nearly normal: without outliers, up to 8 %
of the fleets name a car. Other distributions name more good cars; compare `Spread.expected` with
`Spread.beyond`. A lognormal metric (g = 0.5) names 2.5 of 99 cars on average, 0.9 of 100 and 0.8 of
500; a t distribution with 5 degrees of freedom 1.2 of 99, 7 of 1000 and 0.3 of 10,000. A bimodal
metric may name more in a fleet of any size.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.fleet.tails import Shape, shape

Array = NDArray[np.float64]

SHARE = 0.05
"""Expected share of false ones among the named cars, if the bulk is nearly normal."""

FEWEST = 8
"""Fewest cars for a scale that can name outliers."""

FAR = 3.0
"""|z| beyond which cars are counted and compared with the number by chance."""

_MAD = 1.4826
_NORMAL = Shape(1.0, 0.0, 0.0)


@dataclass(frozen=True)
class Spread:
    """Centre and scale of one metric, and the position of each car.

    ``count`` finite values; ``median``, ``scale`` in the metric's unit; ``z`` (n,) NaN if the
    metric is not known or has no scale; ``p`` two-sided (n,), NaN likewise; ``beyond`` cars past
    `FAR`, ``expected`` as many by chance; ``quantiles`` 5, 25, 75 and 95 %; ``shape`` of the bulk.
    """

    count: int
    median: float
    scale: float
    z: Array
    p: Array
    beyond: int
    expected: float
    quantiles: tuple[float, float, float, float]
    shape: Shape


def spread(values: Array) -> Spread:
    """Spread of one metric over the fleet, ``values`` (n,), NaN if a car does not have it."""
    from scipy.stats import median_abs_deviation

    known = values[np.isfinite(values)]
    n = known.size
    if n == 0:
        nothing = np.full(values.size, np.nan)
        return Spread(0, np.nan, np.nan, nothing, nothing, 0, 0.0, (np.nan,) * 4, _NORMAL)
    median = float(np.median(known))
    scale = _MAD * _small(n) * float(median_abs_deviation(known))
    form = shape(known, median, scale)
    if n < FEWEST or scale <= 1e-12 * abs(median):
        z = p = np.full(values.size, np.nan)
        expected = 0.0
    else:
        straight = form.z(values - median)
        z = np.where(np.isfinite(values), straight, np.nan)
        p = _two_sided(z, n)
        expected = n * float(_two_sided(np.array([FAR]), n)[0])
    q = [float(x) for x in np.quantile(known, [0.05, 0.25, 0.75, 0.95])]
    beyond = int(np.sum(np.abs(z) > FAR))
    return Spread(n, median, scale, z, p, beyond, expected, (q[0], q[1], q[2], q[3]), form)


def named(p: Array, share: float = SHARE) -> NDArray[np.bool_]:
    """Which of ``p`` (any shape) are discoveries by Benjamini and Hochberg; NaN never is.

    >>> named(np.array([0.001, 0.02, 0.9, 0.04]))
    array([ True,  True, False, False])
    """
    from scipy.stats import false_discovery_control

    known = np.isfinite(p)
    out = np.zeros(p.shape, dtype=np.bool_)
    out[known] = false_discovery_control(p[known]) <= share
    return out


def _small(n: int) -> float:
    """Small-sample correction of the MAD of ``n`` normal numbers: about n/(n - 0.8)."""
    return n / (n - 0.8)


def _two_sided(z: Array, n: int) -> Array:
    from scipy.stats import t

    # the median is uncertain too: its variance is pi/2n of that of one car
    wide = np.sqrt(1.0 + 0.5 * np.pi / n)
    return np.asarray(2.0 * t.sf(np.abs(z) / wide, 0.37 * (n - 1)))
