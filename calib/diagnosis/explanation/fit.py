"""A hypothesis fitted to all logs by a few rounds of Gauss and Newton.

The derivatives follow by Broyden's secant updates, so a round costs one prediction of every log.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from calib.base.arrays import Array
from calib.diagnosis.explanation.columns import seen
from calib.diagnosis.explanation.explanation import Explanation, of_all
from calib.diagnosis.explanation.hypothesis import Hypothesis, State, prior_of
from calib.diagnosis.explanation.problem import Problem

ALMOST, SETTLED, ROUGHLY = 0.1, 2.0, 20.0
"""Falls of the sum of squares from which a fit goes on: the last one, one that is compared, and one
that only tells what to try."""

_ROUNDS, _REFRESHED, _DAMPING, _MOST_DAMPED = 20, 3, 1e-3, 1e4
_FAR, _FAR_EFFECT = 0.3, 1.5  # longest step that a linear model holds: of base and form, effect [1]


def fit(
    problem: Problem,
    hypothesis: Hypothesis,
    state: State,
    near: Sequence[Array] = (),
    settled: float = SETTLED,
) -> Explanation:
    """Fit a hypothesis from a state. ``near`` are columns nearby, as `seen` knows them.

    It has ``settled`` where the sum of squares promises to fall by no more. The evidence is that of
    the linear model, which is believed no larger fall.
    """
    prior, m = prior_of(problem, hypothesis), state.x.size
    state = replace(state, x=np.clip(state.x, prior.low[:m] + 1e-6, prior.high[:m] - 1e-6))
    at = _settled(seen(problem, hypothesis, state, near), settled, fresh=not near)
    if settled <= SETTLED:
        for _ in range(_REFRESHED):  # with columns of its own place: secant ones may promise less
            before, at = at, _settled(seen(problem, hypothesis, at.state), settled, fresh=True)
            if at.state is before.state:
                break
    elif near and hypothesis.names:
        base = [J[prior.of == ""] for J in at.columns]
        at = _settled(seen(problem, hypothesis, at.state, base, form_too=False), settled)
    price = hypothesis.price(len(problem.runs))
    evidence = at.marginal().evidence(settled) - price
    return replace(at, log_evidence=evidence, settled=settled)


def _settled(at: Explanation, least: float, *, fresh: bool = False) -> Explanation:
    """Damped steps of Gauss and Newton until they promise nothing more (Levenberg 1944).

    Secant updates between them; columns are computed anew where a step brings less than a quarter
    of its promise.
    """
    left, damping = _REFRESHED, 0.0
    for _ in range(_ROUNDS):
        state, promised = _step(at, 0.0)
        if promised < least:
            return at
        while damping < _MOST_DAMPED:
            if damping:
                state, promised = _step(at, damping)
            other = replace(at, state=state, innovations=of_all(at.problem, at.hypothesis, state))
            if other.squares < at.squares:
                break
            damping = max(10.0 * damping, _DAMPING)
        else:
            other, damping = at, _DAMPING
        fall = at.squares - other.squares
        if fall > 0.0:
            at = replace(other, columns=_secant(at, other))
            fresh, damping = False, 0.1 * damping
            if fall < 0.5 * least:
                return at
        if fall < 0.25 * promised:
            if fresh or left == 0:
                return at
            at, fresh, left = seen(at.problem, at.hypothesis, at.state), True, left - 1
    return at


def _step(at: Explanation, damping: float) -> tuple[State, float]:
    """The state after a damped step, and the fall of the squares that it promises.

    What would leave its bounds, or be longer than a linear model holds, ends there.
    """
    prior, now, m = at.prior, at.state.shared, at.state.x.size
    far = np.where(np.isin(prior.of, at.names), _FAR_EFFECT, _FAR)
    least, most = np.maximum(prior.low - now, -far), np.minimum(prior.high - now, far)
    whole = at.marginal(damping=damping)
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
    x, form = np.split(np.clip(now + step, prior.low, prior.high), [m])
    fall = at.squares - whole.squares - (2.0 * g @ step + step @ H @ step)
    return State(x, form, at.state.own - own), float(fall)


def _secant(at: Explanation, other: Explanation) -> list[Array]:
    """Columns at ``other``, those by x by Broyden's good update."""
    moved = other.state.shared - at.state.shared
    dx = np.where(np.arange(moved.size) < at.state.x.size, moved, 0.0)
    length, J = max(float(dx @ dx), np.finfo(float).tiny), []
    for i, (a, b) in enumerate(zip(at.innovations, other.innovations, strict=True)):
        du = other.state.own[i] - at.state.own[i]
        told = moved @ at.columns[i] + du @ at.own_columns(i)
        J.append(at.columns[i] + np.outer(dx, b - a - told) / length)
    return J
