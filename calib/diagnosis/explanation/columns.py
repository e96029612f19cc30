"""Derivatives of the innovations of all logs, by finite differences."""

from dataclasses import replace

import numpy as np

from calib.base.arrays import Array
from calib.car.braking import BITE
from calib.diagnosis.explanation.base import FORM_AT
from calib.diagnosis.explanation.channels import of_wheels, whiten
from calib.diagnosis.explanation.explanation import driven, innovations, of_all, runs_of
from calib.diagnosis.explanation.hypothesis import FADE, Hypothesis, State, based, bounds_of
from calib.diagnosis.explanation.own import FRONT_HEAT, REAR_HEAT
from calib.diagnosis.explanation.predict import predict
from calib.diagnosis.explanation.problem import Problem

_STEP = 1e-3

_HEAT = 10.0
"""Step of a start heat [K]."""


def columns_by_heat(
    problem: Problem, hypothesis: Hypothesis, state: State, r: list[Array]
) -> list[Array]:
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
            moved = innovations(problem, base, effects, driven(run, own))
            out[i][k] = (moved - r[i]) / _HEAT
    return out


def columns_by_x(
    problem: Problem,
    hypothesis: Hypothesis,
    state: State,
    r: list[Array],
    first: int,
    stop: int | None = None,
) -> list[Array]:
    """Derivatives of the innovations of each log by x[first:stop]."""
    high = bounds_of(problem, hypothesis)[1]
    found, runs = [], runs_of(problem, state.own)
    for k in range(state.x.size)[first:stop]:
        step = _STEP if state.x[k] + _STEP < high[k] else -_STEP
        x = state.x.copy()
        x[k] += step
        moved = of_all(problem, hypothesis, replace(state, x=x), runs)
        found.append([(a - b) / step for a, b in zip(moved, r, strict=True)])
    if not found:
        return [np.zeros((0, one.size)) for one in r]
    return [np.stack(of_run) for of_run in zip(*found, strict=True)]


def columns_by_form(problem: Problem, hypothesis: Hypothesis, state: State) -> list[Array]:
    """Derivatives (2 k, n) of the innovations of each log by the form of front and rear tyres."""
    base, effects = based(problem, hypothesis, state)
    found = []
    for run, own in zip(problem.runs, state.own, strict=True):
        at = predict(problem.vehicle, base, effects, driven(run, own))
        columns = []
        for wheels in ([0, 1], [2, 3]):
            for hat in np.eye(FORM_AT.size):
                omega = np.zeros_like(at.omega)
                omega[wheels] = at.lost[wheels] * np.interp(at.use[wheels], FORM_AT, hat)
                columns.append(np.concatenate(whiten(of_wheels(run, omega), problem.noise)))
        found.append(float(hypothesis.departs) * np.stack(columns))
    return found
