"""A hypothesis fitted to all logs by a few rounds of Gauss and Newton.

Each round has columns of its own place, but those of the base in a rough fit that gets on: with
secant updates the end of a flat valley hangs on the last digit.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from calib.base.arrays import Array
from calib.diagnosis.explanation.explanation import Explanation, of_all, seen
from calib.diagnosis.explanation.hypothesis import Hypothesis, State, prior_of
from calib.diagnosis.explanation.problem import Problem

ALMOST, SETTLED, ROUGHLY = 0.1, 2.0, 20.0
"""Falls of the sum of squares from which a fit goes on: the last one, one that is compared, and one
that only tells what to try."""

_ROUNDS, _DAMPING, _MOST_DAMPED = 20, 1e-3, 1e4
_KEPT = 0.5  # fall over what was promised from which a rough fit keeps the columns of the base [1]
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
    at, exact, damping = seen(problem, hypothesis, state, near), not near, 0.0
    for _ in range(_ROUNDS):
        state, share, damping = _fallen(at, settled, damping)
        if share == 0.0 and (exact or settled > SETTLED):
            break
        exact = settled <= SETTLED or share < _KEPT
        base = [] if exact else [J[prior.of == ""] for J in at.columns]
        at = seen(problem, hypothesis, state, base)
    evidence = at.marginal().evidence(settled) - hypothesis.price(len(problem.runs))
    return replace(at, log_evidence=evidence, settled=settled)


def _fallen(at: Explanation, least: float, damping: float) -> tuple[State, float, float]:
    """The state after a step that falls, the fall over what was promised [1], and the damping.

    None falls where less than ``least`` is promised by the step without damping: a damped one that
    ends at its bounds may promise nothing, and a smaller one still falls (Levenberg 1944).
    """
    state, promised = _step(at, 0.0)
    if promised < least:
        return at.state, 0.0, 0.0
    while damping < _MOST_DAMPED:
        if damping:
            state, promised = _step(at, damping)
        innovations = of_all(at.problem, at.hypothesis, state)
        fall = at.squares - replace(at, state=state, innovations=innovations).squares
        if fall > 0.0:
            share = fall / max(promised, least) if fall > 0.5 * least else 0.0
            return state, share, 0.1 * damping
        damping = max(10.0 * damping, _DAMPING)
    return at.state, 0.0, 0.0


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
