"""Derivatives of the innovations of all logs, by finite differences."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from calib.base.arrays import Array
from calib.diagnosis.explanation.base import FORM_AT
from calib.diagnosis.explanation.channels import of_wheels, whiten
from calib.diagnosis.explanation.explanation import Explanation, of_all
from calib.diagnosis.explanation.hypothesis import FADE, Hypothesis, State
from calib.diagnosis.explanation.own import FRONT_HEAT, KINDS, REAR_HEAT, sizes
from calib.diagnosis.explanation.predict import predict
from calib.diagnosis.explanation.problem import Problem

_STEP = 1e-3  # of an element of x [1]
_STEP_OF_OWN = 1.0 / 15.0  # of an own state, over the largest of its usual sizes


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
    at = Explanation(problem, hypothesis, state, of_all(problem, hypothesis, state), [], [])
    m, k = state.x.size, state.form.size
    first = len(known[0]) - k if known else 0
    steps = np.where(state.x + _STEP < at.prior.high[:m], _STEP, -_STEP)
    moved = [replace(state, x=state.x + step) for step in np.diag(steps)[first:]]
    J = _differences(at, moved, steps[first:])
    form = known if known and form_too else _by_form(at)
    parts = zip(known or form, J, form, strict=True)
    J = [np.vstack([a[:first], b, hypothesis.departs * c[-k:]]) for a, b, c in parts]
    if FADE in at.effects:
        heat = columns_by_own(at, (FRONT_HEAT, REAR_HEAT))
    else:
        heat = [np.zeros((2, r.size)) for r in at.innovations]
    rest = [np.vstack(both) for both in zip(problem.courses, heat, strict=True)]
    return replace(at, columns=J, rest=rest)


def _by_form(at: Explanation) -> list[Array]:
    """Derivatives (2 k, n) of the innovations of each log by the form of front and rear tyres."""
    base, effects, found, hats = at.base, at.effects, [], np.eye(FORM_AT.size)
    for run in at.runs:
        made = predict(at.problem.vehicle, base, effects, run)
        shares = np.stack([[np.interp(use, FORM_AT, hat) for use in made.use] for hat in hats])
        omega = np.stack([shares * made.lost] * 2)
        omega[0, :, 2:], omega[1, :, :2] = 0.0, 0.0
        found.append(whiten(of_wheels(run, np.concatenate(omega)), at.problem.noise))
    return found


def columns_by_own(at: Explanation, which: Sequence[int]) -> list[Array]:
    """Derivatives of the innovations of each log by some states of its own."""
    steps = _STEP_OF_OWN * sizes(KINDS)
    moved = [replace(at.state, own=at.state.own + np.diag(steps)[k]) for k in which]
    return _differences(at, moved, steps[list(which)])


def _differences(at: Explanation, moved: Sequence[State], steps: Array) -> list[Array]:
    """Derivatives (m, n) of the innovations of each log, each by a state that has moved."""
    lags = at.lags()
    found = [of_all(at.problem, at.hypothesis, state, lags) for state in moved]
    return [
        (np.array([other[i] for other in found]).reshape(-1, r.size) - r) / steps[:, None]
        for i, r in enumerate(at.innovations)
    ]
