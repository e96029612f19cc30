"""Forms of tyre curves as functions of the force. A fit takes a weighted mean of the forms.

    slip = c m X(u)        u = F/m,  X(u) -> u as u -> 0        0 <= u < 1

with the compliance c = slip/F at small slip, the peak m and the normalised force F (similarity
method: Pacejka, Tyre and Vehicle Dynamics, ch. 4). From a third of the peak on, real tyres lie
between these forms. Valid on the rising branch only.

    form           F/m over x = slip/(c m)    its inverse X(u)
    brush          1 - (1 - x/3)^3            3 (1 - (1 - u)^(1/3))
    exponential    1 - e^-x                   -ln(1 - u)                    Burckhardt, rising part
    Dugoff         x, then 1 - 1/(4 x)        u, then 1/(4 (1 - u))         Dugoff et al. 1970
    magic_sharp    sin(C atan(x/C))           C tan(asin(u)/C)              Pacejka, C = 1.65, E = 0
    magic_round    the same with C = 1.25
"""

import numpy as np

from calib.base.arrays import Array

FORMS = ("brush", "exponential", "dugoff", "magic_sharp", "magic_round")  # as in `inverse_forms`
NEAR_PEAK = 0.97  # share u of the peak above which a tyre counts as sliding [1]


def inverse_forms(share: Array) -> Array:
    """Return X of each form, (..., 5), at the ``share`` u = F/m of the peak [1] (...).

    Above `NEAR_PEAK` X is constant; the caller leaves such forces out.
    """
    u = np.clip(share, 0.0, NEAR_PEAK)
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


# X/u of the forms at nodes that are evenly spaced in q = sqrt(1 - u), from u = 0 to NEAR_PEAK
_CELLS = 2048
_Q_END = np.sqrt(1.0 - NEAR_PEAK)
_U_NODES = 1.0 - np.linspace(1.0, _Q_END, _CELLS + 1) ** 2
_AT_ZERO = np.ones((1, len(FORMS)))  # X/u -> 1
_X_OVER_U = np.vstack([_AT_ZERO, inverse_forms(_U_NODES[1:]) / _U_NODES[1:, None]]).T.copy()
_RISES = np.diff(_X_OVER_U, axis=1)  # (5, _CELLS)


def mean_inverse(share: Array, weights: Array) -> Array:
    """Return X of n tyres, whose forms have ``weights`` (n, 5), at ``share`` u (..., n, k) [1].

    X is odd in u. X/u is interpolated linearly over the root of 1 - u, which is faster than the
    forms themselves, with a relative error below 1e-5.
    """
    u = np.minimum(np.abs(share), NEAR_PEAK)
    position = (1.0 - np.sqrt(1.0 - u)) * (_CELLS / (1.0 - _Q_END))  # in cells from u = 0
    cell = np.minimum(position.astype(np.int64), _CELLS - 1)
    position -= cell  # within the cell, 0 to 1
    mean = np.zeros_like(u)
    for x_over_u, rises, weight in zip(_X_OVER_U, _RISES, weights.T, strict=True):
        ratio = rises.take(cell)  # X/u of a form; operations in place keep it in the cache
        ratio *= position
        ratio += x_over_u.take(cell)
        ratio *= weight[:, None]
        mean += ratio
    return np.asarray(np.copysign(u, share) * mean)
