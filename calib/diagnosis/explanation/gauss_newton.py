"""A hypothesis fitted to all logs by a few rounds of Gauss and Newton.

Each round has the derivatives of its own state: with secant updates the end of a flat valley
depends on the last digit. Where a step falls by less than the linear model promises, a second one
goes along the curve that the first one showed, so that a bent valley takes few rounds.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from calib.base.arrays import Array
from calib.diagnosis.explanation.fit import Fit, linearised, with_columns
from calib.diagnosis.explanation.hypothesis import Hypothesis, State, prior_of
from calib.diagnosis.explanation.problem import Problem

FINAL, CONVERGED, ROUGH = 0.1, 2.0, 20.0
"""Tolerances of a fit: of the last one, of one that is compared, and of one that only says what to
try next."""

_ROUNDS, _ROUNDS_ROUGHLY = 20, 10
_DAMPING, _MOST_DAMPED = 1e-3, 1e4
_EXCESS = 5e-4  # share of the squares beyond noise with which these falls grow [1]
_BENT = 0.5  # fall over the promised one below which the linear model is bent along a step [1]
_RIDGE = 1e-12  # added to a scaled information matrix, far above rounding [1]
_FAR, _FAR_EFFECT = 0.3, 1.5  # longest step that a linear model holds: of base and form, effect [1]


def fit_logs(
    problem: Problem,
    hypothesis: Hypothesis,
    state: State,
    near: Sequence[Array] = (),
    tolerance: float = CONVERGED,
) -> Fit:
    """Fit a hypothesis from a state; ``near`` are columns nearby, as for `with_columns`.

    It converged where the sum of squares promises to fall by less than the ``tolerance``. The
    evidence is that of the linear model, with a fall of at most that.
    """
    prior, m = prior_of(problem, hypothesis), state.x.size
    state = replace(state, x=np.clip(state.x, prior.low[:m] + 1e-6, prior.high[:m] - 1e-6))
    fit, damping = linearised(problem, hypothesis, state, near), 0.0
    for k in range(_ROUNDS if tolerance <= CONVERGED else _ROUNDS_ROUGHLY):
        fit, falls, damping = _fallen(fit, tolerance, damping)
        if not falls and (k or not near):
            break
        fit = with_columns(fit)
    evidence = fit.marginal().evidence(tolerance) - hypothesis.price(len(problem.runs))
    return replace(fit, log_evidence=evidence, tolerance=tolerance)


def _fallen(fit: Fit, least: float, damping: float) -> tuple[Fit, bool, float]:
    """Take a step that falls; return whether the next one may fall, too, and its damping.

    Nothing falls where less than ``least``, times a share of the squares beyond noise, is promised
    by the step without damping: a damped one that ends at its bounds may promise nothing, and a
    smaller one still falls (Levenberg 1944).
    """
    state, promised = _step(fit, 0.0)
    if promised < least * max(1.0, _EXCESS * (fit.squares - fit.count)):
        return fit, False, 0.0
    while damping < _MOST_DAMPED:
        if damping:
            state, promised = _step(fit, damping)
        moved = fit.moved(state)
        if fit.squares - moved.squares < _BENT * promised:
            again = fit.moved(_corrected_step(fit, moved, damping))
            moved = min(moved, again, key=lambda one: one.squares)
        fall = fit.squares - moved.squares
        if fall > 0.0:
            return moved, fall > 0.5 * least, 0.1 * damping
        damping = max(10.0 * damping, _DAMPING)
    return fit, False, 0.0


def _corrected_step(fit: Fit, moved: Fit, damping: float) -> State:
    """Return the state after the second-order correction of a step (Nocedal and Wright, ch. 18.3).

    That is the step from innovations from which the linear model leads to those of ``moved``. It
    at most doubles what a random effect, which has no bounds, moves by.
    """
    dx = moved.state.shared - fit.state.shared
    now = fit.state.random_effects
    du = moved.state.random_effects - now
    logs = zip(moved.innovations, fit.columns, du, strict=True)
    innovations = [r - dx @ J - u @ fit.random_columns(i) for i, (r, J, u) in enumerate(logs)]
    state = _step(replace(fit, innovations=innovations), damping)[0]
    most = 2.0 * np.abs(du)
    return replace(state, random_effects=np.clip(state.random_effects, now - most, now + most))


def _step(fit: Fit, damping: float) -> tuple[State, float]:
    """The state after a damped step, and the fall of the squares that it promises.

    What would leave its bounds, or be longer than a linear model holds, ends there.
    """
    prior, now, m = fit.prior, fit.state.shared, fit.state.x.size
    far = np.where(np.isin(prior.effect_names, fit.names), _FAR_EFFECT, _FAR)
    least, most = np.maximum(prior.low - now, -far), np.minimum(prior.high - now, far)
    whole = fit.marginal(damping=damping)
    H, g = whole.information, whole.gradient
    H = H + damping * np.diag(np.diag(H))
    step = _least(H, g, least, most)
    step[m:] *= fit.hypothesis.has_discrepancy
    steps = np.stack([one @ np.append(step, 1.0) for one in whole.steps])
    x, form = np.split(np.clip(now + step, prior.low, prior.high), [m])
    fall = fit.squares - whole.squares - (2.0 * g @ step + step @ H @ step)
    return State(x, form, fit.state.random_effects - steps), float(fall)


def _least(H: Array, g: Array, low: Array, high: Array) -> Array:
    """Return the s (k,) between ``low`` and ``high`` with the least s' H s + 2 g' s."""
    from scipy.optimize import lsq_linear

    scale = 1.0 / np.sqrt(np.diag(H))
    root = np.linalg.cholesky(H * scale * scale[:, None] + _RIDGE * np.eye(g.size))
    bounds = low / scale, high / scale
    solved = lsq_linear(root.T, -np.linalg.solve(root, g * scale), bounds, method="bvls")
    return np.asarray(np.clip(solved.x * scale, low, high))
