"""How hot the discs of each log were at its first sample, where no temperature is logged.

    nothing explains the logs --> thermal fade with a start heat for each log --> better? --> search

Pads fade with the heat of their disc. A log without temperatures tells how much heat a run adds,
and not with how much it began. As pads and road, that is a state of a log and no effect. It is
asked for only where no explanation holds without it, and counts only where one holds with it.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.candidate import (
    Candidate,
    Problem,
    bounds,
    fit,
    prior_rows,
    unpack,
    widths,
)
from calib.diagnosis.decide import FLOOR, Decision, decide, explains
from calib.diagnosis.predict import ObservedRun
from calib.diagnosis.secant import least_squares
from calib.physics.braking import BITE
from calib.physics.disc_temperature import START

Array = NDArray[np.float64]

FADE = "pad_thermal_fade"
"""The effect that reads the heat of a disc."""

SPREAD = 150.0
"""Standard deviation of the heat at the start of a run about `START` [K]: from a cold disc to one
after some stops in a row."""

COLDEST, HOTTEST = 0.0, 600.0
"""Range of the heat at the start [degC]."""

STEPS = 25
"""Most steps of a fit of parameters and heats together."""

SHARE = 0.3
"""Share of what is unexplained that the heats must explain for a search with them."""


def with_start_heats(decision: Decision) -> Decision:
    """The decision with a start heat for each log where that alone explains them."""
    problem = decision.base.problem
    unknown = [i for i, run in enumerate(problem.runs) if _unknown(run)]
    if explains(decision) or not unknown:
        return decision
    at = _jointly(problem, unknown, fit(problem, (FADE,), _start(decision)))
    if at.reduced - FLOOR > (1.0 - SHARE) * (decision.best.reduced - FLOOR):
        return decision
    other = decide(at.problem, fit(at.problem, (), at.x[: at.problem.base_size]))
    return other if explains(other) else decision


def placed(problem: Problem, runs: Sequence[ObservedRun], at: Candidate) -> tuple[ObservedRun, ...]:
    """Further ``runs`` of the ``problem``, each with the start heat with which it fits best.

    Only where fade explains the logs of the problem, and these have start heats of their own.
    """
    if FADE not in at.names or all(run.start_heat == START for run in problem.runs):
        return tuple(runs)
    return tuple(_best_heat(problem, run, at) if _unknown(run) else run for run in runs)


def start_heats_of(runs: Sequence[ObservedRun]) -> dict[str, float]:
    """Heat of the discs at the start [degC] by log; none where it is that of `START` in all."""
    if all(run.start_heat == START for run in runs):
        return {}
    return {run.name: run.start_heat for run in runs if _unknown(run)}


def _unknown(run: ObservedRun) -> bool:
    return not run.warm and float(np.max(run.p_mc)) > BITE


def _start(decision: Decision) -> Array:
    """The vector of the base alone, with fade at its usual size."""
    problem = decision.base.problem
    fade = np.zeros(problem.parameters_of(FADE))
    fade[0] = 1.0
    return np.concatenate([decision.base.x[: problem.base_size], fade])


def _jointly(problem: Problem, unknown: Sequence[int], at: Candidate) -> Candidate:
    """Fit parameters together with the start heats of the runs with indices ``unknown``."""
    names, known = at.names, at.x.size
    low, high = bounds(problem, names)

    def driven(x: Array) -> Problem:
        runs = list(problem.runs)
        for i, heat in zip(unknown, x[known:], strict=True):
            runs[i] = replace(runs[i], start_heat=START + SPREAD * float(heat))
        return replace(problem, runs=tuple(runs))

    def rows(x: Array) -> Array:
        innovations = driven(x).flat(*unpack(problem, names, x[:known]))
        return np.concatenate([innovations, prior_rows(problem, names, x[:known]), x[known:]])

    count = len(unknown)
    low = np.concatenate([low, np.full(count, (COLDEST - START) / SPREAD)])
    high = np.concatenate([high, np.full(count, (HOTTEST - START) / SPREAD)])
    first = np.clip(np.concatenate([at.x, np.zeros(count)]), low + 1e-6, high - 1e-6)
    scale = np.concatenate([widths(problem, known), np.ones(count)])
    x, _ = least_squares(rows, first, low, high, scale, STEPS)
    return fit(driven(x), names, x[:known])


def _best_heat(problem: Problem, run: ObservedRun, at: Candidate) -> ObservedRun:
    """The run with the start heat that explains it best beside its prior."""
    from scipy.optimize import minimize_scalar

    def heated(heat: float) -> ObservedRun:
        return replace(run, start_heat=START + SPREAD * heat)

    def cost(heat: float) -> float:
        alone = replace(problem, runs=(heated(heat),))
        return alone.chi2(at.base, at.effects) + heat**2

    low, high = (COLDEST - START) / SPREAD, (HOTTEST - START) / SPREAD
    coarse = min(np.linspace(low, high, 13), key=cost)
    step = (high - low) / 12.0
    ends = (max(coarse - step, low), min(coarse + step, high))
    return heated(float(minimize_scalar(cost, bounds=ends, method="bounded").x))
