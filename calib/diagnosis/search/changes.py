"""What each further effect would change: the innovations of an explanation, in one linear step.

Every effect is added at its usual size, at a few points of its further parameters. The changes that
base parameters and present effects can make are projected out. Ranking, pairs and chance (`search`,
`together` and `chance` beside this file) work with what is left, so it is computed once for an
explanation.
"""

from dataclasses import dataclass, replace
from functools import lru_cache, partial

import numpy as np
from numpy.typing import NDArray

from calib.car.effects.effect import Card
from calib.car.effects.effects import Effects
from calib.car.own_effects.own_effect import definition, every_effect
from calib.diagnosis.explanation.candidate import Candidate, free
from calib.diagnosis.explanation.problem import Problem, joined
from calib.diagnosis.explanation.vector import origins, unpack

Array = NDArray[np.float64]

LEAST = 1e-9
"""Share of the square of a change that must be its own; less is left by the rounding of it."""


@dataclass(frozen=True)
class EffectChange:
    """What an effect does to the innovations at a point of `trials`.

    ``own`` (n,) is the change that base and present effects cannot make, zero where they can make
    all of it.
    """

    name: str
    trial: Array
    own: Array


def further_effects(at: Candidate) -> tuple[str, ...]:
    """Names of the catalogue's effects and of own ones that the explanation does not have."""
    known, own = every_effect(at.problem.vehicle.effects), at.problem.offset
    return tuple(name for name in known if name not in (*at.names, own))


@lru_cache(maxsize=1)
def further_changes(at: Candidate) -> dict[str, tuple[EffectChange, ...]]:
    """The changes by every effect that is not in ``at``, by its name, in the order of `trials`."""
    names = further_effects(at)
    alone = replace(at, problem=at.problem.alone)
    changes_of = partial(_changes_of, alone, joined(at.whitened), at.directions)
    computed = at.problem.mapped(changes_of, names)
    found = {}
    for i, name in enumerate(names):
        at.problem.tell(f"trying effect {i + 1} of {len(names)}", i, len(names))
        found[name] = next(computed)
    return found


def changes_by(at: Candidate, name: str, directions: Array) -> tuple[EffectChange, ...]:
    """The changes by one effect that do not lie along ``directions`` (n, k), as in `trials`."""
    return _changes_of(at, joined(at.whitened), directions, name)


def _changes_of(
    at: Candidate, innovations: Array, directions: Array, name: str
) -> tuple[EffectChange, ...]:
    problem, found = at.problem, []
    for trial in trials(problem, definition(problem.vehicle.effects, name).card):
        effects = at.effects.with_(tried_at(problem, name, trial))
        whole = problem.flat(at.base, effects) - innovations
        own = free(whole, directions)
        if float(own @ own) < LEAST * float(whole @ whole):
            own = np.zeros_like(own)
        found.append(EffectChange(name, trial, own))
    return tuple(found)


def tried_at(problem: Problem, name: str, trial: Array) -> Effects:
    """One effect alone, at a point of `trials`."""
    x = np.concatenate([np.zeros(problem.base_size), trial])
    return unpack(problem, (name,), x)[1].only(name)


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
