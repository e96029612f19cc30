"""Forms of tyre curves that a fit mixes, each as its inverse in closed form.

    slip = c m X(u)        u = F/m,  X(u) -> u as u -> 0        0 <= u < 1

with the compliance c at small slip, the peak m and the normalised force F (similarity method:
Pacejka, Tyre and Vehicle Dynamics, ch. 4). A tyre is a weighted mean of these inverses. Real tyres
lie between these forms from a third of the peak on. Valid on the rising branch only.

    brush          1 - (1 - x/3)^3            3 (1 - (1 - u)^(1/3))
    exponential    1 - e^-x                   -ln(1 - u)                    Burckhardt, without fall
    Dugoff         x, then 1 - 1/(4 x)        u, then 1/(4 (1 - u))         Dugoff et al. 1970
    magic_sharp    sin(C atan(x/C)), 1.65     C tan(asin(u)/C)              Pacejka, E = 0
    magic_round    the same with 1.25
"""

import numpy as np

from calib.base.arrays import Array

FORMS = ("brush", "exponential", "dugoff", "magic_sharp", "magic_round")
"""Names of the forms, in the order of `inverse_forms`."""

NEAR_PEAK = 0.97
"""Share of its peak above which a tyre no longer counts as rolling [1]."""


def inverse_forms(use: Array) -> Array:
    """X of each form at the used share of the peak ``use`` [1] (...), shape (..., 5).

    Above `NEAR_PEAK` it is the value there: the caller leaves such forces out.
    """
    u = np.clip(use, 0.0, NEAR_PEAK)
    angle = np.arcsin(u)
    return np.stack(
        [
            3.0 * (1.0 - np.cbrt(1.0 - u)),
            -np.log1p(-u),
            np.where(u < 0.5, u, 0.25 / (1.0 - u)),
            1.65 * np.tan(angle / 1.65),
            1.25 * np.tan(angle / 1.25),
        ],
        axis=-1,
    )


_NODES = 2048
_Q_END = np.sqrt(1.0 - NEAR_PEAK)
_USE = 1.0 - np.linspace(1.0, _Q_END, _NODES + 1) ** 2
_OVER_USE = np.vstack([np.ones(len(FORMS)), inverse_forms(_USE[1:]) / _USE[1:, None]]).T.copy()
_RISE = np.diff(_OVER_USE, axis=1)


def mean_inverse(use: Array, weights: Array) -> Array:
    """X of tyres with ``weights`` (n, 5) of the forms, at ``use`` (..., n, k) [1]; odd in it.

    X/u is interpolated linearly over the root of 1 - u: faster than the forms, and within 1e-5.
    """
    u = np.minimum(np.abs(use), NEAR_PEAK)
    position = (1.0 - np.sqrt(1.0 - u)) * (_NODES / (1.0 - _Q_END))
    cell = np.minimum(position.astype(np.int64), _NODES - 1)
    position -= cell
    mean = np.zeros_like(u)
    for over, rise, weight in zip(_OVER_USE, _RISE, weights.T, strict=True):
        form = rise.take(cell)  # in place: one form at a time stays in the cache
        form *= position
        form += over.take(cell)
        form *= weight[:, None]
        mean += form
    return np.asarray(np.copysign(u, use) * mean)
