"""A second search, with the logs in groups, where the first one explains too little.

    explanations of the first search --> groups beside each --> fit --> groups --> the best: search

Where logs differ in pads or road, no explanation with common parameters is right, but one that has
the hidden effect lets its groups be seen. So the groups are found beside the best few of them.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.explanation.base import BASE, REFERENCE, Ground
from calib.diagnosis.explanation.candidate import Candidate
from calib.diagnosis.explanation.problem import Problem
from calib.diagnosis.gates import GATES
from calib.diagnosis.search.decide import Decision, explains
from calib.diagnosis.search.groups import HIGH, LOW, PARAMETERS, SPREAD, grouped
from calib.diagnosis.search.jointly import LogStates, fit_jointly, searched_beside

Array = NDArray[np.float64]


def regrouped(decision: Decision) -> Decision:
    """The decision with logs in groups where that explains them and this one does not."""
    if explains(decision):
        return decision
    found = {c.names: c for c in reversed((decision.best, *decision.rivals)) if c.names}
    ranked = sorted(found.values(), key=lambda candidate: candidate.chi2)
    starts = [*ranked[: GATES.groups_beside - 1], decision.base]
    tried = sorted(filter(None, map(_split, starts)), key=_chi2)[: GATES.groups_fitted]
    best = min([decision.base, *map(_in_groups, tried)], key=lambda candidate: candidate.reduced)
    if not _has_groups(best) or _excess(best) > (1.0 - GATES.groups_share) * min(
        map(_excess, starts)
    ):
        return decision
    return searched_beside(decision, best)


@dataclass(frozen=True)
class _Split:
    """An explanation, and its problem with the logs in the groups that go with it."""

    at: Candidate
    problem: Problem


def _split(at: Candidate) -> _Split | None:
    """None where one ground serves all logs."""
    problem = grouped(at.problem, at)
    return None if problem is None else _Split(at, problem)


def _chi2(split: _Split) -> float:
    """What the groups leave, before anything is fitted with them."""
    return split.problem.chi2(split.at.base, split.at.effects)


def _in_groups(split: _Split) -> Candidate:
    """The explanation fitted with its logs in groups, and with those that go with it then."""
    at = _fitted(split)
    again = _split(at)
    return at if again is None else _fitted(again)


def _fitted(split: _Split) -> Candidate:
    start = split.at.x.copy()
    start[len(PARAMETERS) : BASE] = 0.0  # the form of the tyre had bent to what groups explain
    return _jointly(split.problem, split.at.names, start)


def _jointly(problem: Problem, names: tuple[str, ...], start: Array) -> Candidate:
    """Fit parameters and grounds together: near a tyre's peak one leans on the other."""
    of_run = [run.ground for run in problem.runs]
    others = [ground for ground in dict.fromkeys(of_run) if ground != REFERENCE]

    def driven(x: Array) -> Problem:
        grounds = dict(zip(others, map(Ground.of, x.reshape(-1, 4)), strict=True))
        runs = (replace(run, ground=grounds.get(run.ground, REFERENCE)) for run in problem.runs)
        return replace(problem, runs=tuple(runs))

    count = len(others)
    grounds = LogStates(
        first=np.concatenate([ground.logarithms for ground in others]),
        low=np.tile(LOW, count),
        high=np.tile(HIGH, count),
        scale=np.full(4 * count, 0.1),
        sigma=np.tile(SPREAD, count),
        driven=driven,
    )
    return fit_jointly(problem, names, start, grounds)


def _has_groups(candidate: Candidate) -> bool:
    return any(run.ground != REFERENCE for run in candidate.problem.runs)


def _excess(candidate: Candidate) -> float:
    return max(candidate.reduced - GATES.floor, 0.0)
