"""Derivatives of the innovations of all logs, by finite differences."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from calib.base.arrays import Array
from calib.car.braking import BITE
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
from calib.diagnosis.explanation.own import FRONT_HEAT, REAR_HEAT
from calib.diagnosis.explanation.predict import predict
from calib.diagnosis.explanation.problem import Problem

_STEP, _HEAT = 1e-3, 10.0
"""Steps of an element of x [1], and of a start heat [K]."""


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
    heat = _by_heat(problem, hypothesis, state, r)
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


def _by_heat(problem: Problem, hypothesis: Hypothesis, state: State, r: list[Array]) -> list[Array]:
    """Derivatives (2, n) of the innovations of each log by the first heat of its discs."""
    out = [np.zeros((2, one.size)) for one in r]
    base, effects = based(problem, hypothesis, state)
    if FADE not in effects:
        return out
    for i, run in enumerate(problem.runs):
        if run.warm or np.max(run.p_mc) < BITE:
            continue
        for k, place in enumerate((FRONT_HEAT, REAR_HEAT)):
            own = state.own[i].copy()
            own[place] += _HEAT
            out[i][k] = (innovations(problem, base, effects, driven(run, own)) - r[i]) / _HEAT
    return out
