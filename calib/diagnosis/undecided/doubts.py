"""What pads and tyre may take up unseen, and how much wider that makes their intervals.

A fit takes the tyres of both axles as alike, the mass as that of the file, and an effect that the
logs could not have shown as absent. None of that is known. Each is a direction in which the
innovations would move, with a usual size; what the base parameters can imitate of it moves them:

    covariance of base and doubts together, each doubt of its usual size if the logs do not say else

The intervals of pads and tyre count that. Those of a named effect do not: they are what the logs
say of an effect on a car that is as declared.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calib.base.intervals import Z95
from calib.car.effects.effects import Effects
from calib.car.own_effects.own_effect import definition
from calib.diagnosis.explanation.agreement import half_widths
from calib.diagnosis.explanation.candidate import Candidate
from calib.diagnosis.explanation.problem import joined
from calib.diagnosis.explanation.vector import prior_derivatives
from calib.model.parameters import AT, PRIORS
from calib.model.settings import SETTINGS

Array = NDArray[np.float64]

MASS = "mass_error"

STEP = 0.05
"""Share of its standard deviation by which a doubt is moved. What pads cannot imitate of a whole
one is of second order, and would count as if the logs excluded it."""


def tyre_spread() -> float:
    """Standard deviation of ln(rear over front stiffness) with the 95 % range that `fit` assumes.

    There tyres are alike or they differ, so the range is that of a mixture of two normal ones.
    """
    from scipy.optimize import brentq

    differ = SETTINGS.tyres_differ
    wide, narrow = PRIORS[AT.log_tyre_ratio].sigma, SETTINGS.tyre_tolerance

    def outside(x: float) -> float:
        tails = (math.erfc(x / (math.sqrt(2.0) * sigma)) for sigma in (wide, narrow))
        return sum(p * tail for p, tail in zip((differ, 1.0 - differ), tails, strict=True))

    return float(brentq(lambda x: outside(x) - 0.05, 0.0, 10.0 * wide)) / Z95


def base_half_widths(candidate: Candidate, unseen: Sequence[str]) -> Array:
    """Half width (k,) of the 95 % interval of each base parameter, as its place in the vector.

    ``unseen`` are the effects that the logs could not have shown.
    """
    k = candidate.problem.base_size
    J, innovations = candidate.jacobian, joined(candidate.whitened)
    moved = [(changed - innovations) / STEP for changed in _doubts(candidate, unseen)]
    A = np.column_stack([J, *moved])
    priors = prior_derivatives(candidate.problem, candidate.names, J.shape[1])
    information = A.T @ A
    information[: J.shape[1], : J.shape[1]] += priors.T @ priors
    information[J.shape[1] :, J.shape[1] :] += np.eye(len(moved))
    together = np.diag(np.linalg.pinv(information))[:k]
    more = np.maximum(together - np.diag(candidate.covariance)[:k], 0.0)
    return np.asarray(np.sqrt(half_widths(candidate)[:k] ** 2 + Z95**2 * more))


def _doubts(candidate: Candidate, unseen: Sequence[str]) -> Iterator[Array]:
    """Innovations (n,) with one doubt each, moved by `STEP`."""
    problem, base, effects = candidate.problem, candidate.base, candidate.effects
    tyres = base.tyre_ratio * math.exp(STEP * tyre_spread())
    yield problem.flat(replace(base, tyre_ratio=tyres), effects)
    for name in sorted({*unseen, MASS} - set(effects.names)):
        card = definition(problem.vehicle.effects, name).card
        strength, usual = card.parameters[0].name, card.usual
        size = usual[strength] - card.neutral
        if name == MASS:
            size = problem.vehicle.mass_tolerance
        moved = {**usual, strength: card.neutral + STEP * size}
        yield problem.flat(base, effects.with_(Effects({name: moved})))
