r"""Forms that the force of a tyre takes over its slip, each as its inverse in closed form.

    slip = c m X(u)        u = F/m,  X(u) -> u as u -> 0        0 <= u < 1

c the compliance at small slip, m the peak, F the normalised force: Pacejka's similarity (Tyre and
Vehicle Dynamics, ch. 4). The published forms bound what tyres do between a third and all of their
peak; a mean of their inverses, with weights that add up to 1, is a tyre, too. Rising branch only.

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
"""Share of its peak above which a tyre is no longer taken to roll [1]."""


def inverse_forms(use: Array) -> Array:
    """X of every form at the used share of the peak ``use`` [1] (...), shape (..., 5).

    Above `NEAR_PEAK` the value there: the caller has to leave such forces out.
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
_OVER_USE = np.vstack([np.ones(len(FORMS)), inverse_forms(_USE[1:]) / _USE[1:, None]])
_RISE = np.diff(_OVER_USE, axis=0)


def mean_inverse(use: Array, weights: Array) -> Array:
    """X of the tyres with ``weights`` (n, 5) of the forms, at ``use`` (n, k) [1].

    A wheel that drives slips the other way.
    X/u by linear interpolation over the root of 1 - u, faster than the forms: 1e-5 off at most.
    """
    u = np.minimum(np.abs(use), NEAR_PEAK)
    at = (1.0 - np.sqrt(1.0 - u)) * (_NODES / (1.0 - _Q_END))
    cell = np.minimum(at.astype(np.int64), _NODES - 1)
    forms = _OVER_USE[cell] + (at - cell)[..., None] * _RISE[cell]
    return np.asarray(np.copysign(u, use) * np.einsum("nkf,nf->nk", forms, weights))
