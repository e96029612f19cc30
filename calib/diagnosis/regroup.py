"""A second search, with the logs in groups, where the first one explains too little.

    explanations of the first search --> groups beside each --> fit --> groups --> the best: search

Where logs differ in pads or road, no explanation with common parameters is right, but one that has
the hidden effect lets its groups be seen. So the groups are found beside the best few of them.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.base import REFERENCE, Ground
from calib.diagnosis.candidate import BASE, Candidate, Problem
from calib.diagnosis.decide import FLOOR, Decision, explains
from calib.diagnosis.groups import HIGH, LOW, PARAMETERS, SPREAD, grouped
from calib.diagnosis.jointly import LogStates, fit_jointly, searched_beside

Array = NDArray[np.float64]

BESIDE = 4
"""Explanations of the first search beside which groups are looked for; that without any is one."""

ROUNDS = 2
"""How often groups and parameters are found in turn."""

SHARE = 0.3
"""Share of what is unexplained that groups must explain for a search with them."""


def regrouped(decision: Decision) -> Decision:
    """The decision with logs in groups where that explains them and this one does not."""
    if explains(decision):
        return decision
    found = {c.names: c for c in reversed((decision.best, *decision.rivals)) if c.names}
    ranked = sorted(found.values(), key=lambda candidate: candidate.chi2)
    starts = [*ranked[: BESIDE - 1], decision.base]
    best = min(map(_in_groups, starts), key=lambda candidate: candidate.reduced)
    if not _has_groups(best) or _excess(best) > (1.0 - SHARE) * min(map(_excess, starts)):
        return decision
    return searched_beside(decision, best)


def _in_groups(at: Candidate) -> Candidate:
    """An explanation with its logs in the groups that go with it."""
    for _ in range(ROUNDS):
        problem = grouped(at.problem, at)
        if problem is None:
            return at
        start = at.x.copy()
        start[len(PARAMETERS) : BASE] = 0.0  # the form of the tyre had bent to what groups explain
        at = _jointly(problem, at.names, start)
    return at


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
    return max(candidate.reduced - FLOOR, 0.0)
