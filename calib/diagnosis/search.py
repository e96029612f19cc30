"""Which effect would help: all effects are ranked, the best ones fitted.

All are those of the catalogue and the own ones of the vehicle.

Ranking takes one linear step: add the effect at its usual size, compute the change of the
innovations, project out the changes that base parameters can make, and project the present
innovations on the rest. That is cheap. The best ones are then fitted in full, since lag and
hysteresis are not linear.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.candidate import Candidate, Problem, derivatives, fit, origins, unpack
from calib.physics.effects.effect import Card
from calib.physics.effects.effects import Effects
from calib.physics.own_effects.own_effect import definition, every_effect

Array = NDArray[np.float64]
R = TypeVar("R")

REFINED = 6
"""Effects that are fitted in full after the first ranking."""


@dataclass(frozen=True)
class Hint:
    """Result of one step: the expected ``gain`` in chi-square, the vector ``start`` of a fit."""

    name: str
    gain: float
    start: Array


def base_directions(problem: Problem, at: Candidate, innovations: Array) -> Array:
    """Orthonormal directions (n, k) in which base and present effects move the innovations."""
    q, _ = np.linalg.qr(derivatives(problem, at, innovations))
    return np.asarray(q)


def free(x: Array, directions: Array) -> Array:
    """The part of ``x`` (n,) that does not lie along orthonormal ``directions`` (n, k)."""
    return np.asarray(x - directions @ (directions.T @ x))


def tried_at(problem: Problem, name: str, trial: Array) -> Effects:
    """One effect alone, at a point of `trials`."""
    x = np.concatenate([np.zeros(problem.base_size), trial])
    return unpack(problem, (name,), x)[1].only(name)


def change_by(
    problem: Problem, at: Candidate, innovations: Array, name: str, trial: Array
) -> Array:
    """Change of the ``innovations`` (n,) of a candidate by an effect at a point of `trials`."""
    effects = at.effects.with_(tried_at(problem, name, trial))
    return problem.flat(at.base, effects) - innovations


def along(innovations: Array, directions: Array, change: Array) -> tuple[float, float]:
    """Gain in chi-square along a change of the innovations, and the best factor on that change."""
    own = free(change, directions)
    length = float(own @ own)
    if length < 1e-9 * max(float(change @ change), 1e-30):
        return 0.0, 0.0
    amount = -float(innovations @ own) / length
    return amount * amount * length, amount


def hints(problem: Problem, at: Candidate) -> list[Hint]:
    """One-step gains of every effect not yet in ``at``, best first."""
    innovations = problem.flat(at.base, at.effects)
    directions = base_directions(problem, at, innovations)
    names = [name for name in every_effect(problem.vehicle.effects) if name not in at.names]
    alone = replace(at, problem=problem.alone)
    hint_of = partial(_hint_of, alone, innovations, directions)
    found = _one_by_one(problem, "trying effect", problem.mapped(hint_of, names), len(names))
    return sorted(found, key=lambda hint: -hint.gain)


def _one_by_one(problem: Problem, stage: str, results: Iterator[R], count: int) -> Iterator[R]:
    """The ``count`` results, each with its number told before it comes."""
    for i in range(count):
        problem.tell(f"{stage} {i + 1} of {count}", i, count)
        yield next(results)


def _hint_of(at: Candidate, innovations: Array, directions: Array, name: str) -> Hint:
    """The best step along one effect."""
    problem = at.problem
    card = definition(problem.vehicle.effects, name).card
    best = Hint(name, 0.0, np.concatenate([at.x, np.zeros(len(card.parameters))]))
    for trial in trials(problem, card):
        change = change_by(problem, at, innovations, name, trial)
        gain, amount = along(innovations, directions, change)
        if amount > 0.0 and gain > best.gain:
            best = Hint(name, gain, np.concatenate([at.x, begun(trial, amount)]))
    return best


def begun(trial: Array, amount: float) -> Array:
    """Where a fit begins: a point of `trials`, its strength times ``amount`` within sense."""
    begin = trial.copy()
    begin[0] *= min(max(amount, 0.3), 4.0)
    return begin


def unresolved(problem: Problem, at: Candidate, least: Mapping[str, float]) -> tuple[str, ...]:
    """Effects of usual size that these runs could not have shown.

    The gain in chi-square that such an effect would have, beyond that of base and present effects,
    is below ``least`` of it. Effects that the vehicle file has are known, and not among them.
    """
    innovations = problem.flat(at.base, at.effects)
    directions = base_directions(problem, at, innovations)
    faint = []
    for name, effect in every_effect(problem.vehicle.effects).items():
        if name in at.effects:
            continue
        usual = Effects({name: effect.card.usual})
        change = problem.flat(at.base, at.effects.with_(usual)) - innovations
        own = free(change, directions)
        if float(own @ own) < least[name]:
            faint.append(name)
    return tuple(faint)


def trials(problem: Problem, card: Card) -> list[Array]:
    """Points at which an effect is tried, in spreads from where its parameters count.

    Full strength first, then the further parameters, with both signs where the card allows.
    """
    origin = origins(problem.vehicle.effects, card)
    strength = card.parameters[0]
    low = (strength.low - origin[0]) / strength.spread
    high = (strength.high - origin[0]) / strength.spread
    points = []
    for sign in (1.0, -1.0):
        if not low <= sign <= high:
            continue
        seconds = [np.zeros(len(card.parameters) - 1)]
        for j, p in enumerate(card.parameters[1:]):
            for shift in (-1.0, 1.0):
                if p.low <= origin[j + 1] + shift * p.spread <= p.high:
                    other = np.zeros(len(card.parameters) - 1)
                    other[j] = shift
                    seconds.append(other)
        points += [np.concatenate([[sign], second]) for second in seconds]
    return points


def refine(problem: Problem, at: Candidate, count: int = REFINED) -> list[Candidate]:
    """Fit the most promising effects on top of ``at``; best first."""
    tried = [hint for hint in hints(problem, at)[:count] if hint.gain > 0.0]
    alone = replace(at, problem=problem.alone)
    results = problem.mapped(partial(_fitted, alone), tried)
    found = _one_by_one(problem, "fitting the best, effect", results, len(tried))
    fitted = [replace(candidate, problem=problem) for candidate in found]
    return sorted(fitted, key=lambda candidate: candidate.chi2)


def added(at: Candidate, name: str) -> Candidate:
    """The explanation with one further effect, fitted."""
    innovations = at.problem.flat(at.base, at.effects)
    directions = base_directions(at.problem, at, innovations)
    return _fitted(at, _hint_of(at, innovations, directions, name))


def _fitted(at: Candidate, hint: Hint) -> Candidate:
    """Fit an effect; once more from a full spread if the fit gains less than its hint promised.

    A hysteresis loop narrower than the noise of the pressure brings no gain, so a fit that starts
    there does not leave it.
    """
    problem, names = at.problem, (*at.names, hint.name)
    first = fit(problem, names, hint.start)
    if at.chi2 - first.chi2 > 0.5 * hint.gain:
        return first
    further = hint.start.copy()
    further[at.x.size] = np.copysign(1.0, further[at.x.size])
    return min(first, fit(problem, names, further), key=lambda candidate: candidate.chi2)
