"""The drive that would show an effect which the calibration logs could not have shown.

Each manoeuvre is added to the logs in turn. What the effect of usual size then changes, less what
pads, tyres and the effects that are named can imitate in logs and manoeuvre together, is its size:

    change of all innovations ──> less the directions of the parameters ──> its length, in sigma

One linear step: right for small effects, and the order of magnitude for large ones.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.candidate import Candidate, Problem, unpack
from calib.diagnosis.separate import manoeuvres
from calib.physics.effects.catalogue import effect_named
from calib.physics.effects.effects import Effects

Array = NDArray[np.float64]

CLEAR = 10.0
"""Size from which a drive shows an effect [sigma]: well beyond what chance gives an effect of the
catalogue (`calib.diagnosis.chance`), some 4 sigma, or 9 for a ripple."""


@dataclass(frozen=True)
class Drive:
    """The manoeuvre in which an ``effect`` of usual ``size`` [SI] shows most.

    ``sigma`` is what no other parameter can imitate there, over the noise.
    """

    effect: str
    size: Mapping[str, float]
    name: str
    sigma: float

    @property
    def clear(self) -> bool:
        """Whether the drive would show the effect, and not only show it best."""
        return self.sigma > CLEAR


def drives(problem: Problem, at: Candidate, names: tuple[str, ...]) -> tuple[Drive, ...]:
    """The best drive for each of the effects ``names``, on top of what explains the logs."""
    if not names:
        return ()
    logs = _products(problem, at, names)
    shown = {}
    for name, run in manoeuvres(problem):
        both = logs + _products(replace(problem, runs=(run,)), at, names)
        shown[name] = _free(both, at.x.size)
    found = []
    for i, effect in enumerate(names):
        best = max(shown, key=lambda name: float(shown[name][i]))
        size = effect_named(effect).card.usual
        found.append(Drive(effect, size, best, float(shown[best][i])))
    return tuple(found)


def _products(problem: Problem, at: Candidate, names: tuple[str, ...]) -> Array:
    """Inner products (k + m, k + m) of the changes by k parameters and m effects."""
    innovations = problem.flat(at.base, at.effects)
    columns = []
    for i in range(at.x.size):
        step = 1e-3
        x = at.x.copy()
        x[i] += step
        columns.append((problem.flat(*unpack(problem.vehicle, at.names, x)) - innovations) / step)
    for name in names:
        added = at.effects.with_(Effects({name: effect_named(name).card.usual}))
        columns.append(problem.flat(at.base, added) - innovations)
    M = np.stack(columns)
    return np.asarray(M @ M.T)


def _free(products: Array, k: int) -> Array:
    """Length (m,) of each effect's change that the first k directions cannot imitate."""
    own, cross = products[:k, :k], products[:k, k:]
    imitated = np.sum(cross * (np.linalg.pinv(own, hermitian=True) @ cross), axis=0)
    return np.asarray(np.sqrt(np.maximum(np.diag(products)[k:] - imitated, 0.0)))
