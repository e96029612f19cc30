"""A hypothesis fitted to all logs by a few rounds of Gauss and Newton.

The derivatives follow by Broyden's secant updates, so a round costs one prediction of every log.
"""

from dataclasses import dataclass, replace

import numpy as np

from calib.base.arrays import Array
from calib.diagnosis.explanation.columns import columns_by_form, columns_by_heat, columns_by_x
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
    r = of_all(problem, hypothesis, state)
    known = near.x[0].shape[0] if near else 0
    more = columns_by_x(problem, hypothesis, state, r, known)
    J = [np.vstack([a, b]) for a, b in zip(near.x, more, strict=True)] if near else more
    form = near.form if near else columns_by_form(problem, hypothesis, state)
    heat = columns_by_heat(problem, hypothesis, state, r)
    at = Explanation(problem, hypothesis, state, r, Columns(J, form, heat))
    at = _settled(at, settled, fresh=near is None)
    if settled > SETTLED:
        if near is not None and (hypothesis.names or hypothesis.walk):
            at = _settled(_refreshed(at, problem.base_size), settled)
    else:
        at = _proved(at, settled)
    price = hypothesis.price(len(problem.runs))
    return replace(at, log_evidence=at.marginal().evidence(settled) - price)


def _refreshed(at: Explanation, first: int = 0) -> Explanation:
    """With fresh columns by x from its element ``first`` on, and by the form."""
    more = columns_by_x(at.problem, at.hypothesis, at.state, at.innovations, first)
    J = [np.vstack([a[:first], b]) for a, b in zip(at.columns.x, more, strict=True)]
    form = columns_by_form(at.problem, at.hypothesis, at.state)
    heat = columns_by_heat(at.problem, at.hypothesis, at.state, at.innovations)
    return replace(at, columns=Columns(J, form, heat))


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
    problem, hypothesis = at.problem, at.hypothesis
    low, high = bounds_of(problem, hypothesis)
    left, damping, square = _REFRESHED, 0.0, objective(at)
    for _ in range(_ROUNDS):
        model = _Local(at, low, high, square)
        plain = model.step(0.0)
        if plain.promised < least:
            return at
        while damping < _MOST_DAMPED:
            step = model.step(damping) if damping else plain
            other = model.moved(step)
            value = objective(other)
            if value < square:
                break
            damping = max(10.0 * damping, _DAMPING)
        else:
            other, value, damping = at, square, _DAMPING
        fall = square - value
        poor = fall < 0.25 * step.promised
        if value < square:
            at, square, fresh, damping = other, value, False, 0.1 * damping
            if fall < 0.5 * least:
                return at
        if poor:
            if fresh or left == 0:
                return at
            at, fresh, left = _refreshed(at), True, left - 1
    return at


class _Local:
    """The linear model of all logs at a state, and steps of it inside the bounds of x.

    No step is longer than a linear model holds.
    """

    def __init__(self, at: Explanation, low: Array, high: Array, square: float) -> None:
        self.at, self.low, self.high, self.square = at, low, high, square
        self.m = at.state.x.size
        most = np.full(self.m + at.state.form.size, 0.3)
        most[at.problem.base_size : bounds(at.problem, at.names)[0].size] = 1.5
        self.least, self.most = -most, most.copy()
        self.least[: self.m] = np.maximum(low - at.state.x, -most[: self.m])
        self.most[: self.m] = np.minimum(high - at.state.x, most[: self.m])

    def step(self, damping: float) -> "_Step":
        """Damped; what would leave its bounds ends there."""
        at = self.at
        whole = marginal(at, at.products, at.hypothesis.sizes, damping)
        H, g = whole.information, whole.gradient
        H = H + damping * np.diag(np.diag(H))
        free, step = np.ones(g.size, bool), np.zeros(g.size)
        for _ in range(g.size):
            step[free] = -np.linalg.solve(H[np.ix_(free, free)], (g + H @ (step * ~free))[free])
            past = free & ((step < self.least) | (step > self.most))
            if not past.any():
                break
            step = np.clip(step, self.least, self.most)
            free &= ~past
        own = [one @ np.append(step, 1.0) for one in whole.steps]
        fall = -(2.0 * g @ step + step @ H @ step) + self.square - whole.squares
        return _Step(step, -np.stack(own), float(fall))

    def moved(self, step: "_Step") -> Explanation:
        """The explanation after a step, with secant columns."""
        at, m = self.at, self.m
        state = State(
            np.clip(at.state.x + step.shared[:m], self.low, self.high),
            at.state.form + step.shared[m:],
            at.state.own + step.own,
        )
        other = replace(at, state=state, innovations=of_all(at.problem, at.hypothesis, state))
        return replace(other, columns=_secant(at, other))


@dataclass(frozen=True)
class _Step:
    """Steps of x and form, of own states (runs, 8), and the fall of the squares they promise."""

    shared: Array
    own: Array
    promised: float


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
