"""Derivatives of the innovations of all logs, by finite differences."""

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from calib.base.arrays import Array
from calib.diagnosis.explanation.base import FORM_AT
from calib.diagnosis.explanation.channels import of_wheels, whiten
from calib.diagnosis.explanation.explanation import Explanation, innovations, of_all, runs_of
from calib.diagnosis.explanation.hypothesis import FADE, Hypothesis, State, based, prior_of
from calib.diagnosis.explanation.own import FRONT_HEAT, KINDS, REAR_HEAT, sizes
from calib.diagnosis.explanation.predict import predict
from calib.diagnosis.explanation.problem import Problem

_STEP, _STEP_OF_OWN = 1e-3, 1.0 / 15.0
"""Steps of an element of x [1], and of an own state over the largest of its usual sizes."""


def seen(
    problem: Problem,
    hypothesis: Hypothesis,
    state: State,
    known: Sequence[Array] = (),
    *,
    form_too: bool = True,
) -> Explanation:
    """A hypothesis at a state, its columns by differences.

    Those by the first elements of x of each log may be ``known`` from a state nearby, and the last
    ones, by the form, too.
    """
    r, k = of_all(problem, hypothesis, state), state.form.size
    first = len(known[0]) - k if known else 0
    J = _by_x(problem, hypothesis, state, r, range(first, state.x.size))
    form = known if known and form_too else _by_form(problem, hypothesis, state)
    parts = zip(known or form, J, form, strict=True)
    J = [np.vstack([a[:first], b, hypothesis.departs * c[-k:]]) for a, b, c in parts]
    if FADE in hypothesis.names or FADE in problem.vehicle.effects:
        heat = columns_by_own(problem, hypothesis, state, r, (FRONT_HEAT, REAR_HEAT))
    else:
        heat = [np.zeros((2, one.size)) for one in r]
    rest = [np.vstack(both) for both in zip(problem.courses, heat, strict=True)]
    return Explanation(problem, hypothesis, state, r, J, rest)


def _by_x(
    problem: Problem, hypothesis: Hypothesis, state: State, r: list[Array], which: Iterable[int]
) -> list[Array]:
    """Derivatives (m, n) of the innovations ``r`` of each log by some elements of x."""
    high, found = prior_of(problem, hypothesis).high, []
    for k in which:
        step = _STEP if state.x[k] + _STEP < high[k] else -_STEP
        x = state.x.copy()
        x[k] += step
        moved = of_all(problem, hypothesis, replace(state, x=x))
        found.append([(a - b) / step for a, b in zip(moved, r, strict=True)])
    return [np.array([J[i] for J in found]).reshape(-1, one.size) for i, one in enumerate(r)]


def _by_form(problem: Problem, hypothesis: Hypothesis, state: State) -> list[Array]:
    """Derivatives (2 k, n) of the innovations of each log by the form of front and rear tyres."""
    base, effects = based(problem, hypothesis, state)
    found, hats = [], np.eye(FORM_AT.size)
    for run in runs_of(problem, state.own):
        at = predict(problem.vehicle, base, effects, run)
        shares = np.stack([[np.interp(use, FORM_AT, hat) for use in at.use] for hat in hats])
        omega = shares * at.lost
        front, rear = omega.copy(), omega
        front[:, 2:], rear[:, :2] = 0.0, 0.0
        found.append(whiten(of_wheels(run, np.concatenate([front, rear])), problem.noise))
    return found


def columns_by_own(
    problem: Problem, hypothesis: Hypothesis, state: State, r: list[Array], which: Sequence[int]
) -> list[Array]:
    """Derivatives of the innovations ``r`` of each log by some states of its own."""
    base, effects = based(problem, hypothesis, state)
    steps, out = np.diag(_STEP_OF_OWN * sizes(KINDS)), []
    for run, one in zip(runs_of(problem, state.own), r, strict=True):
        moved = [run.with_own(run.own + steps[k]) for k in which]
        changes = [innovations(problem, base, effects, other) - one for other in moved]
        out.append(np.stack(changes) / np.diag(steps)[list(which), None])
    return out
