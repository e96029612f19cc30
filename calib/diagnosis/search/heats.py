"""How hot the discs of each log were at its first sample, where no temperature is logged.

    nothing explains the logs --> thermal fade with a start heat for each log --> better? --> search

Pads fade with the heat of their disc. A log without temperatures tells how much heat a run adds,
and not with how much it began, front and rear. As pads and road, that is a state of a log and no
effect. It is asked for only where no explanation holds without it, and counts only where one holds
with it.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calib.car.braking import BITE
from calib.car.disc_temperature import ALIKE, START
from calib.diagnosis.explanation.candidate import Candidate
from calib.diagnosis.explanation.fit import fit
from calib.diagnosis.explanation.predict import ObservedRun
from calib.diagnosis.explanation.problem import Problem
from calib.diagnosis.gates import GATES
from calib.diagnosis.search.decide import Decision, explains
from calib.diagnosis.search.jointly import LogStates, fit_jointly, searched_beside

Array = NDArray[np.float64]

FADE = "pad_thermal_fade"
"""The effect that reads the heat of a disc."""


LOW = np.array([(0.0 - START) / GATES.heats_spread, -4.0])
HIGH = np.array([(600.0 - START) / GATES.heats_spread, 4.0])
"""Range of the two states of a log: the heat of the front discs at the start, 0 to 600 degC, in
`heats_spread` about `START`; that of the rear ones over it in `heats_apart`."""


def with_start_heats(decision: Decision) -> Decision:
    """The decision with a start heat for each log where that alone explains them."""
    problem = decision.base.problem
    unknown = [i for i, run in enumerate(problem.runs) if _unknown(run)]
    if explains(decision) or not unknown:
        return decision
    at = _jointly(fit(problem, (FADE,), _start(decision)), unknown)
    at = _jointly(at, unknown)  # the first fit can end before the minimum
    if at.reduced - GATES.floor > (1.0 - GATES.heats_share) * (decision.best.reduced - GATES.floor):
        return decision
    return searched_beside(decision, at)


def placed(problem: Problem, runs: Sequence[ObservedRun], at: Candidate) -> tuple[ObservedRun, ...]:
    """Further ``runs`` of the ``problem``, each with the start heat with which it fits best.

    Only where fade explains the logs of the problem, and these have start heats of their own.
    """
    if FADE not in at.names or not _found(problem.runs):
        return tuple(runs)
    return tuple(_best_heat(problem, run, at) if _unknown(run) else run for run in runs)


def start_heats_of(runs: Sequence[ObservedRun]) -> dict[str, tuple[float, float]]:
    """Heat of front and rear discs at the start [degC] by log; none where all have `START`."""
    return {run.name: run.start_heat for run in runs if _found(runs) and _unknown(run)}


def _found(runs: Sequence[ObservedRun]) -> bool:
    """Whether start heats were asked for, and are not all `START`."""
    return any(run.start_heat != ALIKE for run in runs)


def _unknown(run: ObservedRun) -> bool:
    return not run.warm and float(np.max(run.p_mc)) > BITE


def _start(decision: Decision) -> Array:
    """The vector of the base alone, with fade at its usual size."""
    problem = decision.base.problem
    fade = np.zeros(problem.parameters_of(FADE))
    fade[0] = 1.0
    return np.concatenate([decision.base.x[: problem.base_size], fade])


def _jointly(at: Candidate, unknown: Sequence[int]) -> Candidate:
    """Fit parameters together with the start heats of the runs with indices ``unknown``."""
    problem = at.problem

    def driven(x: Array) -> Problem:
        runs = list(problem.runs)
        for i, states in zip(unknown, x.reshape(-1, 2), strict=True):
            runs[i] = _heated(runs[i], states)
        return replace(problem, runs=tuple(runs))

    count = len(unknown)
    first = np.concatenate([_states(problem.runs[i]) for i in unknown])
    one = np.ones(2 * count)
    heats = LogStates(first, np.tile(LOW, count), np.tile(HIGH, count), one, one, driven)
    return fit_jointly(problem, at.names, at.x, heats)


def _states(run: ObservedRun) -> Array:
    """The two states (2,) of the start heats of a run."""
    front, rear = run.start_heat
    return np.array([(front - START) / GATES.heats_spread, (rear - front) / GATES.heats_apart])


def _heated(run: ObservedRun, states: Array) -> ObservedRun:
    """The run with start heats by its two states (2,)."""
    front = START + GATES.heats_spread * float(states[0])
    return replace(run, start_heat=(front, front + GATES.heats_apart * float(states[1])))


def _best_heat(problem: Problem, run: ObservedRun, at: Candidate) -> ObservedRun:
    """The run with the start heats that explain it best beside their priors."""
    from scipy.optimize import minimize

    def cost(states: Array) -> float:
        alone = replace(problem, runs=(_heated(run, states),))
        return alone.chi2(at.base, at.effects) + float(states @ states)

    coarse = min((np.array([x, 0.0]) for x in np.linspace(LOW[0], HIGH[0], 13)), key=cost)
    best = minimize(
        cost,
        coarse,
        method="Nelder-Mead",
        bounds=list(zip(LOW, HIGH, strict=True)),
        options={"xatol": 0.01, "fatol": 0.1},
    )
    return _heated(run, best.x)
