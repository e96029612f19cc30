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

_ROUNDS = 20
_DAMPING, _MOST_DAMPED = 1e-3, 1e4
ROUGH, FINE = (2.0, 1e-2), (0.1, 1e-4)
"""Falls of the sum of squares, and shares of the squares beyond noise, below which a fit is ended:
one that is compared, since an effect must take 20 and a twentieth of them, and that is answered."""

_BENT = 0.5  # fall over the promised one below which the linear model is bent along a step [1]
_RIDGE = 1e-12  # added to a scaled information matrix, far above rounding [1]
_FAR, _FAR_EFFECT = 0.3, 1.5  # longest step that a linear model holds: of base and form, effect [1]


def fit_logs(
    problem: Problem,
    hypothesis: Hypothesis,
    state: State,
    near: Sequence[Array] = (),
    least: float = -np.inf,
    tolerance: tuple[float, float] = FINE,
) -> Fit:
    """Fit a hypothesis from a state; ``near`` are columns nearby, as for `with_columns`.

    It ends where a step promises to fall by less than the ``tolerance``, and where all steps that
    are left, each as good as the next one, would leave the ln of the evidence below ``least``. That
    is of the linear model, with a fall of at most the tolerance.
    """
    prior, m = prior_of(problem, hypothesis), state.x.size
    state = replace(state, x=np.clip(state.x, prior.low[:m] + 1e-6, prior.high[:m] - 1e-6))
    fit, damping = linearised(problem, hypothesis, state, near), 0.0
    price, (fall, share) = hypothesis.price(len(problem.runs)), tolerance
    for k in range(_ROUNDS):
        # a damped step that ends at its bounds may promise nothing, and a smaller one still falls
        ahead, promised = _step(fit, 0.0)
        worth = max(fall, share * (fit.squares - fit.count))
        reach = fit.marginal().evidence(0.0) - price + 0.5 * promised * (_ROUNDS - k)
        if (promised < worth and (k or not near)) or reach < least:
            break
        if promised >= worth:
            last = fit.squares
            fit, damping = _fallen(fit, ahead, promised, damping)
            if last - fit.squares < 0.5 * worth:
                break
        fit = with_columns(fit)
    return replace(fit, log_evidence=fit.marginal().evidence(fall) - price)


def _fallen(fit: Fit, state: State, promised: float, damping: float) -> tuple[Fit, float]:
    """Take a step that falls, to the ``state`` if nothing is damped; with the next damping.

    Every smaller step falls (Levenberg 1944); where none does, rounding decides.
    """
    while damping < _MOST_DAMPED:
        if damping:
            state, promised = _step(fit, damping)
        moved = fit.moved(state)
        if fit.squares - moved.squares < _BENT * promised:
            again = fit.moved(_corrected_step(fit, moved, damping))
            moved = min(moved, again, key=lambda one: one.squares)
        if moved.squares < fit.squares:
            return moved, 0.1 * damping
        damping = max(10.0 * damping, _DAMPING)
    return fit, 0.0


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
