"""A hypothesis fitted to all logs by a few rounds of Gauss and Newton.

Each round has the derivatives of its own state: with secant updates the end of a flat valley
depends on the last digit. Where a step falls by less than the linear model promises, a second one
goes along the curve that the first one showed, so that a bent valley takes few rounds.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from calib.base.arrays import Array
from calib.diagnosis.explanation.explanation import Explanation, seen, with_columns
from calib.diagnosis.explanation.hypothesis import Hypothesis, State, prior_of
from calib.diagnosis.explanation.problem import Problem

ALMOST, SETTLED, ROUGHLY = 0.1, 2.0, 20.0
"""Falls of the sum of squares from which a fit goes on: the last one, one that is compared, and one
that only tells what to try."""

_ROUNDS, _ROUNDS_ROUGHLY = 20, 10
_DAMPING, _MOST_DAMPED = 1e-3, 1e4
_EXCESS = 5e-4  # share of the squares beyond noise with which these falls grow [1]
_BENT = 0.5  # fall over the promised one below which the linear model is bent along a step [1]
_RIDGE = 1e-12  # added to a scaled information matrix, far above rounding [1]
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
    at, damping = seen(problem, hypothesis, state, near), 0.0
    for k in range(_ROUNDS if settled <= SETTLED else _ROUNDS_ROUGHLY):
        at, falls, damping = _fallen(at, settled, damping)
        if not falls and (k or not near):
            break
        at = with_columns(at)
    evidence = at.marginal().evidence(settled) - hypothesis.price(len(problem.runs))
    return replace(at, log_evidence=evidence, settled=settled)


def _fallen(at: Explanation, least: float, damping: float) -> tuple[Explanation, bool, float]:
    """Take a step that falls; return whether the next one may fall, too, and its damping.

    Nothing falls where less than ``least``, times a share of the squares beyond noise, is promised
    by the step without damping: a damped one that ends at its bounds may promise nothing, and a
    smaller one still falls (Levenberg 1944).
    """
    state, promised = _step(at, 0.0)
    if promised < least * max(1.0, _EXCESS * (at.squares - at.count)):
        return at, False, 0.0
    while damping < _MOST_DAMPED:
        if damping:
            state, promised = _step(at, damping)
        there = at.moved(state)
        if at.squares - there.squares < _BENT * promised:
            again = at.moved(_corrected_step(at, there, damping))
            there = min(there, again, key=lambda one: one.squares)
        fall = at.squares - there.squares
        if fall > 0.0:
            return there, fall > 0.5 * least, 0.1 * damping
        damping = max(10.0 * damping, _DAMPING)
    return at, False, 0.0


def _corrected_step(at: Explanation, moved: Explanation, damping: float) -> State:
    """Return the state after the second-order correction of a step (Nocedal and Wright, ch. 18.3).

    That is the step from innovations from which the linear model leads to those of ``moved``. It
    at most doubles what an own state, which has no bounds, moves by.
    """
    dx = moved.state.shared - at.state.shared
    now = at.state.own
    du = moved.state.own - now
    logs = zip(moved.innovations, at.columns, du, strict=True)
    innovations = [r - dx @ J - u @ at.own_columns(i) for i, (r, J, u) in enumerate(logs)]
    state = _step(replace(at, innovations=innovations), damping)[0]
    most = 2.0 * np.abs(du)
    return replace(state, own=np.clip(state.own, now - most, now + most))


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
    step = _least(H, g, least, most)
    step[m:] *= at.hypothesis.departs
    own = np.stack([one @ np.append(step, 1.0) for one in whole.steps])
    x, form = np.split(np.clip(now + step, prior.low, prior.high), [m])
    fall = at.squares - whole.squares - (2.0 * g @ step + step @ H @ step)
    return State(x, form, at.state.own - own), float(fall)


def _least(H: Array, g: Array, low: Array, high: Array) -> Array:
    """Return the s (k,) between ``low`` and ``high`` with the least s' H s + 2 g' s."""
    from scipy.optimize import lsq_linear

    scale = 1.0 / np.sqrt(np.diag(H))
    root = np.linalg.cholesky(H * scale * scale[:, None] + _RIDGE * np.eye(g.size))
    bounds = low / scale, high / scale
    solved = lsq_linear(root.T, -np.linalg.solve(root, g * scale), bounds, method="bvls")
    return np.asarray(np.clip(solved.x * scale, low, high))
