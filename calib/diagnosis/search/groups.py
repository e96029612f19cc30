"""Logs that differ in pads or road: found where one set of parameters does not fit all of them.

    each log --> its own pads and road, with their information --> two groups? --> three? --> ground

The parameters of each log are fitted to it alone. Logs are split into the two groups that explain
these parameters best, as long as a split pays `groups_price`; the largest group is the reference. A
log that cannot show a difference, such as a coast, belongs to the reference.

Differences between logs can imitate an effect that acts in some logs only. So groups are asked for
only where no explanation with common parameters holds.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.explanation.base import REFERENCE, Ground
from calib.diagnosis.explanation.candidate import Candidate
from calib.diagnosis.explanation.predict import ObservedRun
from calib.diagnosis.explanation.problem import Problem
from calib.diagnosis.explanation.secant import columns, least_squares
from calib.diagnosis.gates import GATES

Array = NDArray[np.float64]

PARAMETERS = tuple(f.name for f in fields(Ground))

SPREAD = np.array([0.2, 0.2, 0.25, 0.25])
"""Standard deviations of the logarithms of a log's own factors: other pads, another road [1]."""

LOW, HIGH = np.full(4, -0.7), np.full(4, 0.7)


@dataclass(frozen=True)
class LogGroup:
    """Logs that were driven on one ``ground``; by name."""

    logs: tuple[str, ...]
    ground: Ground


@dataclass(frozen=True)
class _Own:
    """Logarithms (4,) of a log's own factors, and the information (4, 4) on them."""

    value: Array
    information: Array


def grouped(problem: Problem, at: Candidate) -> Problem | None:
    """The problem with a ground for every log, None where one set of parameters serves all."""
    own = [_own(problem, at, run) for run in problem.runs]
    shown = [
        i for i, one in enumerate(own) if np.max(np.diag(one.information)) > GATES.groups_shown
    ]
    groups = [np.array(shown)]
    while groups[0].size and len(groups) < GATES.most_groups:
        splits = []
        for group in groups:
            parts = _split(own, group)
            gain = _cost(own, group) - sum(_cost(own, part) for part in parts)
            splits.append((gain, group, parts))
        gain, best, parts = max(splits, key=lambda split: split[0])
        if gain < GATES.groups_price:
            break
        groups = [g for g in groups if g is not best] + parts
    if len(groups) == 1:
        return None
    groups.sort(key=lambda g: -g.size)
    reference = _mean(own, groups[0])
    grounds = {int(i): Ground.of(_mean(own, g) - reference) for g in groups[1:] for i in g}
    runs = (replace(r, ground=grounds.get(i, REFERENCE)) for i, r in enumerate(problem.runs))
    return replace(problem, runs=tuple(runs))


def placed(problem: Problem, runs: Sequence[ObservedRun], at: Candidate) -> tuple[ObservedRun, ...]:
    """Further ``runs``, each on that ground of the ``problem`` on which it fits best.

    One that cannot show a difference, as a coast, is put on the reference.
    """
    grounds = dict.fromkeys(run.ground for run in problem.runs)
    others = [ground for ground in grounds if ground != REFERENCE]
    return tuple(_placed(problem, run, at, others) for run in runs)


def _placed(
    problem: Problem, run: ObservedRun, at: Candidate, others: Sequence[Ground]
) -> ObservedRun:
    if not others:
        return replace(run, ground=REFERENCE)

    def chi2(ground: Ground) -> float:
        on = replace(problem, runs=(replace(run, ground=ground),))
        return on.chi2(at.base, at.effects)

    least, best = min(((chi2(ground), ground) for ground in others), key=lambda one: one[0])
    return replace(run, ground=best if chi2(REFERENCE) - least > GATES.groups_price else REFERENCE)


def groups_of(runs: Sequence[ObservedRun]) -> tuple[LogGroup, ...]:
    """The groups, the reference first; none where all logs are of one."""
    names: dict[Ground, list[str]] = {}
    for run in runs:
        names.setdefault(run.ground, []).append(run.name)
    if len(names) < 2:
        return ()
    order = sorted(names, key=lambda ground: ground != REFERENCE)
    return tuple(LogGroup(tuple(names[ground]), ground) for ground in order)


def _own(problem: Problem, at: Candidate, run: ObservedRun) -> _Own:
    """Fit the factors of a log to it alone, beside weak priors."""
    start = np.clip(run.ground.logarithms, 0.9 * LOW, 0.9 * HIGH)

    def innovations(x: Array) -> Array:
        alone = replace(problem, runs=(replace(run, ground=Ground.of(x)),))
        return alone.flat(at.base, at.effects)

    def rows(x: Array) -> Array:
        return np.concatenate([innovations(x), x / SPREAD])

    x = least_squares(rows, start, LOW, HIGH, np.full(4, 0.1), 12).x
    J = columns(innovations, x, innovations(x), HIGH)
    return _Own(x, J.T @ J)


def _mean(own: Sequence[_Own], members: Sequence[int] | NDArray[np.int64]) -> Array:
    """The parameters (4,) that explain those of the members best, beside the priors."""
    H = np.diag(1.0 / SPREAD**2) + sum(own[i].information for i in members)
    return np.asarray(np.linalg.solve(H, sum(own[i].information @ own[i].value for i in members)))


def _cost(own: Sequence[_Own], members: Sequence[int] | NDArray[np.int64]) -> float:
    """Chi-square of the members' parameters against their common ones."""
    mean = _mean(own, members)
    return float(sum(_off(own[i], mean) for i in members))


def _off(own: _Own, mean: Array) -> float:
    return float((own.value - mean) @ own.information @ (own.value - mean))


def _split(own: Sequence[_Own], members: NDArray[np.int64]) -> list[NDArray[np.int64]]:
    """The two parts of the least cost, from every pair as their first members."""
    best, least = [members], np.inf
    for pair in combinations(members.tolist(), 2):
        means = [own[i].value for i in pair]
        for _ in range(4):
            nearer = np.array([_off(own[i], means[0]) <= _off(own[i], means[1]) for i in members])
            parts = [members[nearer], members[~nearer]]
            if not all(part.size for part in parts):
                break
            means = [_mean(own, part) for part in parts]
        else:
            cost = sum(_cost(own, part) for part in parts)
            if cost < least:
                best, least = parts, cost
    return best
