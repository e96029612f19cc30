"""A hypothesis fitted to all logs by a few rounds of Gauss and Newton.

The derivatives follow by Broyden's secant updates, so a round costs one prediction of every log.
"""

from dataclasses import replace

import numpy as np

from calib.diagnosis.explanation.columns import seen
from calib.diagnosis.explanation.explanation import (
    Explanation,
    marginal,
    objective,
    of_all,
    own_columns,
)
from calib.diagnosis.explanation.hypothesis import Columns, Hypothesis, State, bounds_of
from calib.diagnosis.explanation.problem import Problem
from calib.diagnosis.explanation.vector import bounds

ALMOST, SETTLED, ROUGHLY = 0.1, 2.0, 20.0
"""Falls of the sum of squares from which a fit goes on: the last one, one that is compared, and one
that only tells what to try."""

_ROUNDS, _REFRESHED, _DAMPING, _MOST_DAMPED = 20, 3, 1e-3, 1e4

_FAR, _FAR_EFFECT = 0.3, 1.5
"""Longest step of an element that a linear model holds: of base and form, and of an effect [1]."""


def fit(
    problem: Problem,
    hypothesis: Hypothesis,
    state: State,
    near: Columns | None = None,
    settled: float = SETTLED,
) -> Explanation:
    """Fit a hypothesis from a state. ``near`` are columns nearby, by the first elements of x.

    It has ``settled`` where the sum of squares promises to fall by no more. The evidence is that of
    the linear model, which is believed no larger fall.
    """
    low, high = bounds_of(problem, hypothesis)
    state = replace(state, x=np.clip(state.x, low + 1e-6, high - 1e-6))
    at = _settled(seen(problem, hypothesis, state, near), settled, fresh=near is None)
    if settled <= SETTLED:
        at = _proved(at, settled)
    elif near is not None and at.state.x.size > problem.base_size:
        base = at.columns.kept(np.arange(at.state.x.size) < problem.base_size)
        at = _settled(seen(problem, hypothesis, at.state, replace(base, form=[])), settled)
    price = hypothesis.price(len(problem.runs))
    return replace(at, log_evidence=at.marginal().evidence(settled) - price)


def _refreshed(at: Explanation) -> Explanation:
    return seen(at.problem, at.hypothesis, at.state)


def _proved(at: Explanation, least: float) -> Explanation:
    """Settled with columns of its own place: secant ones may promise too little."""
    for _ in range(_REFRESHED):
        before = at.state
        at = _settled(_refreshed(at), least, fresh=True)
        if at.state is before:
            break
    return at


def _settled(at: Explanation, least: float, *, fresh: bool = False) -> Explanation:
    """Damped steps of Gauss and Newton until they promise nothing more (Levenberg 1944).

    Secant updates between them; columns are computed anew where a step brings less than a quarter
    of its promise.
    """
    left, damping, square = _REFRESHED, 0.0, objective(at)
    for _ in range(_ROUNDS):
        state, promised = _step(at, 0.0)
        if promised < least:
            return at
        while damping < _MOST_DAMPED:
            if damping:
                state, promised = _step(at, damping)
            other = replace(at, state=state, innovations=of_all(at.problem, at.hypothesis, state))
            value = objective(other)
            if value < square:
                break
            damping = max(10.0 * damping, _DAMPING)
        else:
            other, value, damping = at, square, _DAMPING
        fall = square - value
        if fall > 0.0:
            at = replace(other, columns=_secant(at, other))
            square, fresh, damping = value, False, 0.1 * damping
            if fall < 0.5 * least:
                return at
        if fall < 0.25 * promised:
            if fresh or left == 0:
                return at
            at, fresh, left = _refreshed(at), True, left - 1
    return at


def _step(at: Explanation, damping: float) -> tuple[State, float]:
    """The state after a damped step, and the fall of the squares that it promises.

    What would leave its bounds, or be longer than a linear model holds, ends there.
    """
    low, high = bounds_of(at.problem, at.hypothesis)
    m = at.state.x.size
    most = np.full(m + at.state.form.size, _FAR)
    most[at.problem.base_size : bounds(at.problem, at.names)[0].size] = _FAR_EFFECT
    least = np.append(np.maximum(low - at.state.x, -most[:m]), -most[m:])
    most[:m] = np.minimum(high - at.state.x, most[:m])
    whole = marginal(at, at.products, at.hypothesis.sizes, damping)
    H, g = whole.information, whole.gradient
    H = H + damping * np.diag(np.diag(H))
    free, step = np.ones(g.size, bool), np.zeros(g.size)
    for _ in range(g.size):
        step[free] = -np.linalg.solve(H[np.ix_(free, free)], (g + H @ (step * ~free))[free])
        past = free & ((step < least) | (step > most))
        if not past.any():
            break
        step = np.clip(step, least, most)
        free &= ~past
    own = np.stack([one @ np.append(step, 1.0) for one in whole.steps])
    x, form = at.state.x + step[:m], at.state.form + step[m:]
    fall = objective(at) - whole.squares - (2.0 * g @ step + step @ H @ step)
    return State(np.clip(x, low, high), form, at.state.own - own), float(fall)


def _secant(at: Explanation, other: Explanation) -> Columns:
    """Columns by x at ``other``, by Broyden's good update."""
    dx = other.state.x - at.state.x
    df = other.state.form - at.state.form
    length = float(dx @ dx)
    if length == 0.0:
        return at.columns
    J = []
    for i, (a, b) in enumerate(zip(at.innovations, other.innovations, strict=True)):
        du = other.state.own[i] - at.state.own[i]
        told = dx @ at.columns.x[i] + df @ at.columns.form[i] + du @ own_columns(at, i)
        J.append(at.columns.x[i] + np.outer(dx, b - a - told) / length)
    return replace(at.columns, x=J)
