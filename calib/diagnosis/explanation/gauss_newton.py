"""Fit a hypothesis to all logs by a few damped Gauss-Newton steps.

The fall of a step is the decrease of the sum of squares of innovations and priors. A fall below
that of the linear model is followed by a second-order correction. Each round computes the
derivatives anew, since with secant updates the end of a flat valley depends on the last digit.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from calib.base.arrays import Array
from calib.diagnosis.explanation.fit import Fit, linearised, with_columns
from calib.diagnosis.explanation.hypothesis import Hypothesis, State, prior_of
from calib.diagnosis.explanation.problem import Problem

_ROUNDS = 20
_FIRST_DAMPING, _MAX_DAMPING = 1e-3, 1e4  # shares of the diagonal of the information [1]
ROUGH, FINE = (2.0, 1e-2), (0.1, 1e-4)
"""Tolerances of fits that are compared, and of results: a fall of the squares, and a fall as a
share of the squares beyond noise. A fit ends where the fall is below the larger of them. An effect
that is accepted makes a fall of 20 or more, and of a share of 0.05 or more."""
_CURVED = 0.5  # fall over the predicted fall below which a step is corrected [1]
_RIDGE = 1e-12  # added to a scaled information matrix, far above rounding [1]
_REACH, _REACH_OF_EFFECTS = 0.3, 1.5
"""Largest step of x for which the linear model holds: of base and discrepancy, and of effects."""


def fit_logs(
    problem: Problem,
    hypothesis: Hypothesis,
    state: State,
    near: Sequence[Array] = (),
    least: float = -np.inf,
    tolerance: tuple[float, float] = FINE,
) -> Fit:
    """Fit a hypothesis from a ``state``; ``near`` are columns nearby, as for `with_columns`.

    The fit ends if the predicted fall is below the ``tolerance``. It also ends if ln of its
    evidence cannot reach ``least``, even if each further round fell as much as the next round.
    """
    prior, m = prior_of(problem, hypothesis), state.x.size
    state = replace(state, x=np.clip(state.x, prior.low[:m] + 1e-6, prior.high[:m] - 1e-6))
    fit, damping = linearised(problem, hypothesis, state, near), 0.0
    price = hypothesis.price(len(problem.runs))
    squares_to_end, share_to_end = tolerance
    for number in range(_ROUNDS):
        # without damping, since a damped step that ends at bounds may fall though none is predicted
        target, predicted = _step(fit, 0.0)
        least_fall = max(squares_to_end, share_to_end * (fit.squares - fit.count))
        reachable = fit.marginal().evidence(0.0) - price + 0.5 * predicted * (_ROUNDS - number)
        has_own_columns = number > 0 or not near
        if (predicted < least_fall and has_own_columns) or reachable < least:
            break
        if predicted >= least_fall:
            squares = fit.squares
            fit, damping = _downhill(fit, target, predicted, damping)
            if squares - fit.squares < 0.5 * least_fall:
                break
        fit = with_columns(fit)
    # the evidence of the linear model; a larger fall than the tolerance is not trusted
    return replace(fit, log_evidence=fit.marginal().evidence(squares_to_end) - price)


def _downhill(fit: Fit, target: State, predicted: float, damping: float) -> tuple[Fit, float]:
    """Return the fit after a step that falls, and the damping of the next step.

    ``target`` is where the undamped step ends, with its ``predicted`` fall. A small enough step
    always falls (Levenberg 1944); if none does, rounding hides the fall, and the fit stays.
    """
    while damping < _MAX_DAMPING:
        if damping:
            target, predicted = _step(fit, damping)
        moved = fit.at_state(target)
        if fit.squares - moved.squares < _CURVED * predicted:
            corrected = fit.at_state(_corrected_step(fit, moved, damping))
            if corrected.squares < moved.squares:
                moved = corrected
        if moved.squares < fit.squares:
            return moved, 0.1 * damping
        damping = max(10.0 * damping, _FIRST_DAMPING)
    return fit, 0.0


def _corrected_step(fit: Fit, moved: Fit, damping: float) -> State:
    """Return the state after the second-order correction of a step (Nocedal and Wright, ch. 18.3).

    The step is computed anew from innovations that the linear model turns into those of ``moved``.
    A random effect, which has no bounds, goes at most twice as far as in ``moved``.
    """
    dx = moved.state.shared - fit.state.shared
    u = fit.state.random_effects
    du = moved.state.random_effects - u
    innovations = [
        r - dx @ J - du[i] @ fit.random_columns(i)
        for i, (r, J) in enumerate(zip(moved.innovations, fit.columns, strict=True))
    ]
    state, _ = _step(replace(fit, innovations=innovations), damping)
    reach = 2.0 * np.abs(du)
    return replace(state, random_effects=np.clip(state.random_effects, u - reach, u + reach))


def _step(fit: Fit, damping: float) -> tuple[State, float]:
    """Return the state after a step within bounds and reach, and the predicted fall."""
    prior, shared, m = fit.prior, fit.state.shared, fit.state.x.size
    reach = np.where(np.isin(prior.effect_names, fit.names), _REACH_OF_EFFECTS, _REACH)
    low, high = np.maximum(prior.low - shared, -reach), np.minimum(prior.high - shared, reach)
    marginal = fit.marginal(damping=damping)
    H, g = marginal.information, marginal.gradient
    H = H + damping * np.diag(np.diag(H))
    step = _bounded_minimum(H, g, low, high)
    if not fit.hypothesis.has_discrepancy:
        step[m:] = 0.0
    random_steps = np.stack([by_column @ np.append(step, 1.0) for by_column in marginal.steps])
    x, discrepancy = np.split(np.clip(shared + step, prior.low, prior.high), [m])
    fall = fit.squares - marginal.squares - (2.0 * g @ step + step @ H @ step)
    return State(x, discrepancy, fit.state.random_effects - random_steps), float(fall)


def _bounded_minimum(H: Array, g: Array, low: Array, high: Array) -> Array:
    """Return the s (k,) between ``low`` and ``high`` with the least s' H s + 2 g' s."""
    from scipy.optimize import lsq_linear

    scale = 1.0 / np.sqrt(np.diag(H))  # so that the scaled matrix has ones on its diagonal
    root = np.linalg.cholesky(H * scale * scale[:, None] + _RIDGE * np.eye(g.size))
    bounds = low / scale, high / scale
    solved = lsq_linear(root.T, -np.linalg.solve(root, g * scale), bounds, method="bvls")
    return np.asarray(np.clip(solved.x * scale, low, high))
