"""Derivatives of the innovations of all logs, by finite differences."""

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from calib.base.arrays import Array
from calib.diagnosis.explanation.base import FORM_AT
from calib.diagnosis.explanation.channels import of_wheels, whiten
from calib.diagnosis.explanation.explanation import (
    Explanation,
    driven,
    innovations,
    of_all,
    runs_of,
)
from calib.diagnosis.explanation.hypothesis import (
    FADE,
    Columns,
    Hypothesis,
    State,
    based,
    bounds_of,
)
from calib.diagnosis.explanation.own import FRONT_HEAT, KINDS, REAR_HEAT, sizes
from calib.diagnosis.explanation.predict import predict
from calib.diagnosis.explanation.problem import Problem

_STEP, _STEP_OF_OWN = 1e-3, 1.0 / 15.0
"""Steps of an element of x [1], and of an own state over the largest of its usual sizes."""


def seen(
    problem: Problem, hypothesis: Hypothesis, state: State, known: Columns | None = None
) -> Explanation:
    """A hypothesis at a state, its columns by differences.

    The first ones by x, and all by the form, may be ``known`` from a state nearby.
    """
    r = of_all(problem, hypothesis, state)
    first = known.x[0].shape[0] if known else 0
    J = columns_by_x(problem, hypothesis, state, r, range(first, state.x.size))
    if known:
        J = [np.vstack([a, b]) for a, b in zip(known.x, J, strict=True)]
    form = known.form if known and known.form else _by_form(problem, hypothesis, state)
    if FADE in hypothesis.names or FADE in problem.vehicle.effects:
        heat = columns_by_own(problem, hypothesis, state, r, (FRONT_HEAT, REAR_HEAT))
    else:
        heat = [np.zeros((2, one.size)) for one in r]
    return Explanation(problem, hypothesis, state, r, Columns(J, form, heat))


def columns_by_x(
    problem: Problem, hypothesis: Hypothesis, state: State, r: list[Array], which: Iterable[int]
) -> list[Array]:
    """Derivatives of the innovations ``r`` of each log by some elements of x."""
    high, runs = bounds_of(problem, hypothesis)[1], runs_of(problem, state.own)
    found = []
    for k in which:
        step = _STEP if state.x[k] + _STEP < high[k] else -_STEP
        x = state.x.copy()
        x[k] += step
        moved = of_all(problem, hypothesis, replace(state, x=x), runs)
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
        both = whiten(of_wheels(run, np.concatenate([front, rear])), problem.noise)
        found.append(float(hypothesis.departs) * both)
    return found


def columns_by_own(
    problem: Problem, hypothesis: Hypothesis, state: State, r: list[Array], which: Sequence[int]
) -> list[Array]:
    """Derivatives of the innovations ``r`` of each log by some states of its own."""
    base, effects = based(problem, hypothesis, state)
    steps, out = _STEP_OF_OWN * sizes(KINDS), []
    for run, states, one in zip(problem.runs, state.own, r, strict=True):
        moved = [driven(run, states + steps * (np.arange(steps.size) == k)) for k in which]
        changes = [innovations(problem, base, effects, other) - one for other in moved]
        out.append(np.stack(changes) / steps[list(which), None])
    return out
