"""Least squares with few evaluations: finite differences once, then Broyden's secant updates.

    f at x + h e_i --> J      J <- J + (f1 - f0 - J dx) dx' / (dx' dx)      SciPy's least_squares

One evaluation of a diagnosis predicts every run, and finite differences at each step would need one
for every parameter. Source: Broyden 1965, "good" update. It holds where the residuals are nearly
linear over a step; where they are not, the fit needs many steps, and begins anew with fresh
differences.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Residuals = Callable[[Array], Array]

DIFFERENCE = 1e-3
"""Step of the finite differences, in the unit of the vector."""

_EASY = 10
"""Steps in which secant updates from the first derivatives must converge."""

TOLERANCE = 1e-5
"""Relative change of the sum of squares, or of the vector, at which a fit ends."""


class Least(NamedTuple):
    """The vector (k,) and its residuals (n,).

    ``promised`` is the sum of squares to which one more step would come with the last derivatives
    and what is inside its bounds; that of the residuals where the steps converged.
    """

    x: Array
    residuals: Array
    promised: float


def least_squares(
    residuals: Residuals,
    start: Array,
    low: Array,
    high: Array,
    scale: Array,
    steps: int,
    known: Array | None = None,
    rough: bool = False,
) -> Least:
    """The vector within its bounds that minimises the squares.

    ``known`` (n, j) are derivatives by the first elements of the vector nearby, where there are
    any. Where the secant updates do not converge soon, at most ``steps`` steps with fresh ones;
    not so if it shall be ``rough``.
    """
    from scipy import optimize

    x = start
    for nearby, most in ((known, min(_EASY, steps)), (None, steps))[: 1 if rough else 2]:
        secant = _Secant(residuals, high, nearby)
        result = optimize.least_squares(
            secant.value,
            x,
            jac=secant.jacobian,
            bounds=(low, high),
            x_scale=scale,
            max_nfev=most,
            ftol=TOLERANCE,
            xtol=TOLERANCE,
        )
        x = result.x
        if result.status > 0:
            return Least(x, np.asarray(result.fun), float(result.fun @ result.fun))
    inside = np.asarray(result.active_mask) == 0
    return Least(x, np.asarray(result.fun), secant.promised(result.fun, inside))


def columns(residuals: Residuals, x: Array, at: Array, high: Array, first: int = 0) -> Array:
    """Derivatives (n, k) of the residuals by the vector ``x``, where they are ``at`` (n,).

    By its elements from ``first`` on.
    """
    out = []
    for i in range(first, x.size):
        step = DIFFERENCE if x[i] + DIFFERENCE < high[i] else -DIFFERENCE
        moved = x.copy()
        moved[i] += step
        out.append((residuals(moved) - at) / step)
    return np.stack(out, axis=1)


class _Secant:
    """Residuals with a Jacobian that follows from the steps taken."""

    def __init__(self, residuals: Residuals, high: Array, nearby: Array | None) -> None:
        self.residuals, self.high, self.nearby = residuals, high, nearby
        self.last: tuple[Array, Array] | None = None  # the vector asked last, with its residuals
        self.known: tuple[Array, Array, Array] | None = None  # vector, residuals, Jacobian

    def value(self, x: Array) -> Array:
        """Residuals at ``x``."""
        self.last = (x.copy(), self.residuals(x))
        return self.last[1]

    def jacobian(self, x: Array) -> Array:
        """Derivatives at ``x``, at which the residuals were asked before."""
        if self.last is not None and np.array_equal(self.last[0], x):
            value = self.last[1]
        else:
            value = self.value(x)
        if self.known is None:
            J = self._first(x, value)
        else:
            before, then, J = self.known
            step = x - before
            if (length := float(step @ step)) > 0.0:
                J = J + np.outer(value - then - J @ step, step) / length
        self.known = (x.copy(), value, J)
        return J

    def promised(self, residuals: Array, inside: NDArray[np.bool_]) -> float:
        """Sum of squares that one more step would leave, with the elements ``inside`` (k,)."""
        assert self.known is not None
        directions = np.linalg.qr(self.known[2][:, inside])[0]
        return float(residuals @ residuals - np.sum((directions.T @ residuals) ** 2))

    def _first(self, x: Array, value: Array) -> Array:
        if self.nearby is None:
            return columns(self.residuals, x, value, self.high)
        further = columns(self.residuals, x, value, self.high, self.nearby.shape[1])
        return np.concatenate([self.nearby, further], axis=1)
