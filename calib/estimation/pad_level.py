"""The common pad level from the sum of forces: strong, and independent of any table.

    brake force demanded by z  =  (level + trend * (t - now)) * brake force of nominal pads

Recursive least squares with exponential forgetting (``level_memory`` of `Priors`). The trend makes
it follow pads that fade or dry without lag; its prior keeps it quiet where the force is small. All
sums are first-order recursions, so the whole run is a few passes of `scipy.signal.lfilter`.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.estimation.priors import Priors

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class PadLevel:
    """Common factor on the nominal pads, causal. Shapes (n,), [1].

    ``value`` is NaN until the first braked sample, is held after the last and NaN again when that
    is forgotten. ``sigma`` counts noise and the price of following a trend, not mass or drag; pads
    that drift by ``level_trend`` add up to a third on a faint braking
    (tests/estimation/test_pad_level.py).
    """

    value: Array
    sigma: Array


def estimate_pad_level(
    time_step: float,
    demanded: Array,
    nominal: Array,
    active: Mask,
    density: float,
    priors: Priors,
) -> PadLevel:
    """Level over a run.

    ``demanded``, ``nominal`` brake forces [N], (n,); ``active`` samples that count; ``density``
    long-run noise of ``demanded`` [N s^0.5]. The variance is that of the weighted fit under noise
    that is white over the memory: weights squared, hence the second set of sums.
    """
    u = np.where(active, nominal, 0.0)
    y = np.where(active, demanded, 0.0)
    forget = float(np.exp(-time_step / priors.level_memory))
    s = _moments(u * u, forget, time_step, 2)
    r = _moments(u * y, forget, time_step, 1)
    # prior on the trend: what the usual drift would explain over the memory
    scale = np.maximum(np.maximum.accumulate(u * u), 1e-9)
    weight = (density**2 / time_step) / priors.level_trend**2
    s2 = s[2] + weight
    determinant = s[0] * s2 - s[1] ** 2
    usable = s[0] > 1e-3 * scale
    with np.errstate(divide="ignore", invalid="ignore"):
        value = (s2 * r[0] - s[1] * r[1]) / determinant
        b = _moments(u * u, forget * forget, time_step, 2)
        noise = density**2 / time_step
        variance = (
            noise * (s2**2 * b[0] - 2.0 * s2 * s[1] * b[1] + s[1] ** 2 * b[2]) / determinant**2
        )
    value = np.where(usable, value, np.nan)
    return PadLevel(value, np.where(usable, np.sqrt(np.maximum(variance, 0.0)), np.nan))


def _moments(x: Array, forget: float, step: float, order: int) -> list[Array]:
    """Sums over the past of forget^age x (-age)^m for m = 0 .. order, age in seconds."""
    from scipy.signal import lfilter

    pole = [1.0, -forget]
    m0 = lfilter([1.0], pole, x)
    out = [m0]
    if order >= 1:
        before = np.concatenate([[0.0], m0[:-1]])
        m1 = lfilter([1.0], pole, -forget * step * before)
        out.append(m1)
    if order >= 2:
        before1 = np.concatenate([[0.0], m1[:-1]])
        m2 = lfilter([1.0], pole, forget * (step * step * before - 2.0 * step * before1))
        out.append(m2)
    return out
