"""The drive that would show an effect which the calibration logs could not have shown.

Each manoeuvre is added to the logs in turn. What the effect of usual size then changes, less what
pads, tyres and the effects that are named can imitate in logs and manoeuvre together, is its size:

    change of all innovations ──> less the directions of the parameters ──> its length, in sigma

One linear step: right for small effects, and the order of magnitude for large ones.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calib.car.effects.effect import Card
from calib.car.effects.effects import Effects
from calib.car.own_effects.own_effect import definition
from calib.diagnosis.explanation.candidate import Candidate
from calib.diagnosis.explanation.problem import Problem
from calib.diagnosis.gates import GATES
from calib.diagnosis.undecided.separate import free_lengths, inner_products, manoeuvres


@dataclass(frozen=True)
class ShowingDrive:
    """The manoeuvre in which the effect of a ``card``, at its usual size, shows most.

    ``sigma`` is what no other parameter can imitate there, over the noise.
    """

    card: Card
    name: str
    sigma: float

    @property
    def effect(self) -> str:
        """Name of the effect."""
        return self.card.name

    @property
    def clear(self) -> bool:
        """Whether the drive would show the effect, and not only show it best."""
        return self.sigma > GATES.clear


def drives(problem: Problem, at: Candidate, names: tuple[str, ...]) -> tuple[ShowingDrive, ...]:
    """The best drive for each of the effects ``names``, on top of what explains the logs."""
    if not names:
        return ()
    logs = _products(problem, at, names)
    shown = {}
    for name, run in manoeuvres(problem):
        both = logs + _products(replace(problem, runs=(run,)), at, names)
        shown[name] = free_lengths(both, at.x.size)
    found = []
    for i, effect in enumerate(names):
        best = max(shown, key=lambda name: float(shown[name][i]))
        card = definition(problem.vehicle.effects, effect).card
        found.append(ShowingDrive(card, best, float(shown[best][i])))
    return tuple(found)


def _products(problem: Problem, at: Candidate, names: tuple[str, ...]) -> NDArray[np.float64]:
    innovations = problem.flat(at.base, at.effects)
    changes = []
    for name in names:
        usual = definition(problem.vehicle.effects, name).card.usual
        added = at.effects.with_(Effects({name: usual}))
        changes.append(problem.flat(at.base, added) - innovations)
    return inner_products(problem, at, changes)
