"""Two further effects at once, for causes that another effect imitates as long as one is missing.

A drag and a slope of the road together look like a bias of the accelerometer, and neither of them
alone is better than that. All pairs of the catalogue are compared in one linear step, as in
`calib.diagnosis.search`, and the best ones are fitted in full.
"""

from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.candidate import Candidate, Problem, fit
from calib.diagnosis.search import base_directions, begun, change_by, free, trials
from calib.physics.own_effects.own_effect import definition, every_effect

Array = NDArray[np.float64]

ALIKE = 0.999
"""Cosine between the changes of two effects from which they are one direction."""

SAME = 1e-4
"""Singular value, over the largest, below which directions of all effects are one another's."""


@dataclass(frozen=True)
class EffectChange:
    """What an effect does to the innovations at a point of `trials`.

    ``own`` (n,) is the change that base and present effects cannot make.
    """

    name: str
    trial: Array
    own: Array


@dataclass(frozen=True)
class EffectPair:
    """Expected gain in chi-square of two effects together, and where a fit of them begins."""

    names: tuple[str, str]
    gain: float
    start: Array


def together(problem: Problem, at: Candidate, count: int, least: float) -> list[Candidate]:
    """Fit the most promising pairs of effects on top of ``at``; best first.

    At most ``count``, and those alone that promise a fall of the mean squared innovation by
    ``least``.
    """
    problem.tell("trying effects in pairs", 0, 1)
    promising = [pair for pair in pairs(problem, at)[:count] if pair.gain > least * at.count]
    alone = replace(at, problem=problem.alone)
    fitted = problem.mapped(partial(_fitted, alone), promising)
    return sorted(
        (replace(candidate, problem=problem) for candidate in fitted),
        key=lambda candidate: candidate.chi2,
    )


def left_by_all(problem: Problem, at: Candidate) -> float:
    """Mean squared innovation that all further effects together would leave, in one linear step.

    Each has any size and sign there: no two or three of them leave less. Where an effect is large
    and acts on the innovations in a bent way, the fitted one can.
    """
    found, rest = _changes(problem, at)
    changes = np.stack([change.own for change in found])
    lengths = np.linalg.norm(changes, axis=1)
    span, weights, _ = np.linalg.svd((changes / lengths[:, None]).T, full_matrices=False)
    kept = span[:, weights > SAME * weights[0]]
    return float(rest @ rest - np.sum((kept.T @ rest) ** 2)) / at.count


def pairs(problem: Problem, at: Candidate) -> list[EffectPair]:
    """Every pair of effects that are not in ``at`` and help together, best first."""
    changes, rest = _changes(problem, at)
    gains, amounts = _gains(np.stack([change.own for change in changes]), rest)
    best: dict[tuple[str, str], EffectPair] = {}
    for i, j in zip(*np.nonzero(np.triu(gains, 1)), strict=True):
        one, other = changes[i], changes[j]
        key = (one.name, other.name)
        if one.name == other.name or (key in best and best[key].gain >= gains[i, j]):
            continue
        start = np.concatenate(
            [at.x, begun(one.trial, amounts[i, j]), begun(other.trial, amounts[j, i])]
        )
        best[key] = EffectPair(key, float(gains[i, j]), start)
    return sorted(best.values(), key=lambda pair: -pair.gain)


def _changes(problem: Problem, at: Candidate) -> tuple[list[EffectChange], Array]:
    """Changes by every effect that is not in ``at``, and the innovations that they may explain.

    Those are (n,), without what base and present effects can do.
    """
    innovations = problem.flat(at.base, at.effects)
    directions = base_directions(problem, at, innovations)
    names = [name for name in every_effect(problem.vehicle.effects) if name not in at.names]
    changes_of = partial(_changes_of, replace(at, problem=problem.alone), innovations, directions)
    changes = [change for found in problem.mapped(changes_of, names) for change in found]
    return changes, free(innovations, directions)


def _changes_of(
    at: Candidate, innovations: Array, directions: Array, name: str
) -> list[EffectChange]:
    problem = at.problem
    found = []
    for trial in trials(problem, definition(problem.vehicle.effects, name).card):
        whole = change_by(problem, at, innovations, name, trial)
        own = free(whole, directions)
        if float(own @ own) > 1e-9 * max(float(whole @ whole), 1e-30):
            found.append(EffectChange(name, trial, own))
    return found


def _gains(changes: Array, rest: Array) -> tuple[Array, Array]:
    """Gain (k, k) of every two ``changes`` (k, n) together, and how much of the first of them
    (k, k); no gain where one of them would have to act the other way round.
    """
    G = changes @ changes.T
    g = -changes @ rest
    length = np.diag(G)
    apart = np.outer(length, length) - G**2
    apart = np.where(apart > (1.0 - ALIKE**2) * np.outer(length, length), apart, np.inf)
    amount = (g[:, None] * length[None, :] - G * g[None, :]) / apart
    gains = amount * g[:, None] + amount.T * g[None, :]
    return np.where((amount > 0.0) & (amount.T > 0.0), gains, 0.0), amount


def _fitted(at: Candidate, pair: EffectPair) -> Candidate:
    return fit(at.problem, (*at.names, *pair.names), pair.start)
