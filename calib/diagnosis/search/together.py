"""Two further effects at once, for causes that another effect imitates as long as one is missing.

A drag and a slope of the road together look like a bias of the accelerometer, and neither of them
alone is better than that. All pairs of the catalogue are compared in one linear step, as in
`calib.diagnosis.search.search`, and the best ones are fitted in full.
"""

from collections.abc import Collection
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.explanation.candidate import Candidate
from calib.diagnosis.explanation.fit import fit
from calib.diagnosis.gates import GATES
from calib.diagnosis.search.changes import EffectChange, changes_by, further_changes
from calib.diagnosis.search.search import begun

Array = NDArray[np.float64]


@dataclass(frozen=True)
class _EffectPair:
    """Expected gain in chi-square of two effects together, and where a fit of them begins."""

    names: tuple[str, str]
    gain: float
    start: Array


def together(at: Candidate, count: int, least: float) -> list[Candidate]:
    """Fit the most promising pairs of effects on top of ``at``; best first.

    At most ``count``, and those alone that promise a fall of the mean squared innovation by
    ``least``.
    """
    problem = at.problem
    problem.tell("trying effects in pairs", 0, 1)
    promising = [pair for pair in pairs(at)[:count] if pair.gain > least * at.count]
    alone = replace(at, problem=problem.alone)
    fitted = problem.mapped(partial(_fitted, alone, at.jacobian), promising)
    return sorted(
        (replace(candidate, problem=problem) for candidate in fitted),
        key=lambda candidate: candidate.chi2,
    )


def left_by_all(at: Candidate) -> float:
    """Mean squared innovation that all further effects together would leave, in one linear step."""
    return _left_by(at, _changes(at))


def left_by(at: Candidate, names: Collection[str]) -> float:
    """Mean squared innovation that some further effects together would leave, in one step."""
    every = [change for name in names for change in changes_by(at, name, at.directions)]
    return _left_by(at, [change for change in every if np.any(change.own)])


def _left_by(at: Candidate, felt: list[EffectChange]) -> float:
    """What is left by changes along any of ``felt``.

    Each has any size and sign there: no two or three of them leave less. Where an effect is large
    and acts on the innovations in a bent way, the fitted one can.
    """
    if not felt:
        return at.reduced
    changes = np.stack([change.own for change in felt])
    lengths = np.linalg.norm(changes, axis=1)
    span, weights, _ = np.linalg.svd((changes / lengths[:, None]).T, full_matrices=False)
    kept = span[:, weights > GATES.together_same * weights[0]]
    return float(at.rest @ at.rest - np.sum((kept.T @ at.rest) ** 2)) / at.count


def pairs(at: Candidate) -> list[_EffectPair]:
    """Every pair of effects that are not in ``at`` and help together, best first."""
    changes = _changes(at)
    gains, amounts = _gains(np.stack([change.own for change in changes]), at.rest)
    best: dict[tuple[str, str], _EffectPair] = {}
    for i, j in zip(*np.nonzero(np.triu(gains, 1)), strict=True):
        one, other = changes[i], changes[j]
        key = (one.name, other.name)
        if one.name == other.name or (key in best and best[key].gain >= gains[i, j]):
            continue
        start = np.concatenate(
            [at.x, begun(one.trial, amounts[i, j]), begun(other.trial, amounts[j, i])]
        )
        best[key] = _EffectPair(key, float(gains[i, j]), start)
    return sorted(best.values(), key=lambda pair: -pair.gain)


def _changes(at: Candidate) -> list[EffectChange]:
    """What further effects do that base and present effects cannot."""
    return [c for changes in further_changes(at).values() for c in changes if np.any(c.own)]


def _gains(changes: Array, rest: Array) -> tuple[Array, Array]:
    """Gain (k, k) of every two ``changes`` (k, n) together, and how much of the first of them
    (k, k); no gain where one of them would have to act the other way round.
    """
    G = changes @ changes.T
    g = -changes @ rest
    length = np.diag(G)
    apart = np.outer(length, length) - G**2
    apart = np.where(
        apart > (1.0 - GATES.together_alike**2) * np.outer(length, length), apart, np.inf
    )
    amount = (g[:, None] * length[None, :] - G * g[None, :]) / apart
    gains = amount * g[:, None] + amount.T * g[None, :]
    return np.where((amount > 0.0) & (amount.T > 0.0), gains, 0.0), amount


def _fitted(at: Candidate, jacobian: Array, pair: _EffectPair) -> Candidate:
    return fit(at.problem, (*at.names, *pair.names), pair.start, jacobian=jacobian)
