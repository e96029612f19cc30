"""Derivatives of the innovations of all logs, by finite differences."""

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from calib.base.arrays import Array
from calib.diagnosis.explanation.base import FORM_AT
from calib.diagnosis.explanation.channels import of_wheels, residuals, whiten
from calib.diagnosis.explanation.explanation import Explanation, innovations, of_all, runs_of
from calib.diagnosis.explanation.hypothesis import FADE, Hypothesis, State, based, prior_of
from calib.diagnosis.explanation.own import FRONT_HEAT, KINDS, REAR_HEAT, sizes
from calib.diagnosis.explanation.predict import ObservedRun, Prediction, predict
from calib.diagnosis.explanation.problem import Problem

_STEP, _STEP_OF_OWN = 1e-3, 1.0 / 15.0
"""Steps of an element of x [1], and of an own state over the largest of its usual sizes."""


def seen(
    problem: Problem, hypothesis: Hypothesis, state: State, known: Sequence[Array] = ()
) -> Explanation:
    """A hypothesis at a state, its columns by differences.

    The first ones by x of each log may be ``known`` from a state nearby.
    """
    vehicle, (base, effects) = problem.vehicle, based(problem, hypothesis, state)
    runs = runs_of(problem, state.own)
    told = [predict(vehicle, base, effects, run) for run in runs]
    r = [whiten(residuals(*both), problem.noise) for both in zip(runs, told, strict=True)]
    first = len(known[0]) if known else 0
    J = _by_x(problem, hypothesis, state, r, range(first, state.x.size))
    if known:
        J = [np.vstack([a, b]) for a, b in zip(known, J, strict=True)]
    if FADE in hypothesis.names or FADE in vehicle.effects:
        heat = columns_by_own(problem, hypothesis, state, r, (FRONT_HEAT, REAR_HEAT))
    else:
        heat = [np.zeros((2, one.size)) for one in r]
    form = [hypothesis.departs * _by_form(problem, *both) for both in zip(runs, told, strict=True)]
    rest = zip(form, problem.courses, heat, strict=True)
    return Explanation(problem, hypothesis, state, r, J, [np.vstack(parts) for parts in rest])


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


def _by_form(problem: Problem, run: ObservedRun, told: Prediction) -> Array:
    """Derivatives (2 k, n) of the innovations of a log by the form of front and rear tyres."""
    hats = np.eye(FORM_AT.size)
    shares = np.stack([[np.interp(use, FORM_AT, hat) for use in told.use] for hat in hats])
    omega = shares * told.lost
    front, rear = omega.copy(), omega
    front[:, 2:], rear[:, :2] = 0.0, 0.0
    return whiten(of_wheels(run, np.concatenate([front, rear])), problem.noise)


def columns_by_own(
    problem: Problem, hypothesis: Hypothesis, state: State, r: list[Array], which: Sequence[int]
) -> list[Array]:
    """Derivatives of the innovations ``r`` of each log by some states of its own."""
    base, effects = based(problem, hypothesis, state)
    steps, out = np.diag(_STEP_OF_OWN * sizes(KINDS)), []
    for run, one in zip(runs_of(problem, state.own), r, strict=True):
        moved = [replace(run, own=run.own + steps[k]) for k in which]
        changes = [innovations(problem, base, effects, other) - one for other in moved]
        out.append(np.stack(changes) / np.diag(steps)[list(which), None])
    return out
