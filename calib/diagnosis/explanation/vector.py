"""The vector that is fitted: the base parameters, then those of the effects.

Weak priors hold parameters that a run may not determine: the peak of a tyre that was never near it,
the second parameter of an effect. The cards give the bounds.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calib.car.effects.effect import Card
from calib.car.effects.effects import Effects
from calib.car.own_effects.own_effect import definition
from calib.diagnosis.explanation.base import (
    BASE,
    BEND,
    RADIUS_RANGE,
    RELAXATION,
    Base,
    base_of,
)
from calib.diagnosis.explanation.problem import DRAG, SHARE, SHARE_RANGE, USUAL_SHARE, Problem
from calib.diagnosis.gates import GATES

Array = NDArray[np.float64]


def unpack(problem: Problem, names: tuple[str, ...], x: Array) -> tuple[Base, Effects]:
    """Base and effects from a vector: the base, then the parameters of the effects.

    A parameter is in units of its spread and counts from its origin, see `origins`. The load that a
    known drag moves is that of the drag's own parameters where these are found anew.
    """
    known, given = _with_share(problem, x), problem.vehicle.effects
    found, i = {}, problem.base_size
    for name in names:
        card = definition(known, name).card
        values = {}
        for p, origin in zip(card.parameters, origins(given, card), strict=True):
            values[p.name] = origin + float(x[i]) * p.spread
            i += 1
        found[name] = values
    base = base_of(problem.vehicle, x[: BASE + problem.free_radius])
    return base, known.with_(Effects(found))


def vector_of(problem: Problem, base: Array, effects: Effects) -> Array:
    """The vector that `unpack` turns into ``effects``, behind that of the ``base``."""
    given, own = problem.vehicle.effects, []
    for name in effects.names:
        card = definition(given, name).card
        values = effects.parameters[name]
        for p, origin in zip(card.parameters, origins(given, card), strict=True):
            own.append((values.get(p.name, p.typical) - origin) / p.spread)
    return np.concatenate([base, own])


def _with_share(problem: Problem, x: Array) -> Effects:
    """The known effects, with the load that a known drag moves by the vector."""
    known = problem.vehicle.effects
    if not problem.free_share:
        return known
    share = USUAL_SHARE + float(x[BASE + problem.free_radius])
    return replace(
        known, parameters={**known.parameters, DRAG: {**known.parameters[DRAG], SHARE: share}}
    )


def origins(known: Effects, card: Card) -> tuple[float, ...]:
    """Where the parameters of an effect count from: the values of the vehicle file, if it has any.

    Else the neutral value for a strength, the typical value for any other parameter.
    """
    if card.name in known:
        given = known.parameters[card.name]
        return tuple(given.get(p.name, p.typical) for p in card.parameters)
    return (card.neutral, *(p.typical for p in card.parameters[1:]))


def bounds(problem: Problem, names: tuple[str, ...]) -> tuple[Array, Array]:
    """Bounds of the vector: the cards' ranges."""
    low = [-GATES.pads, -GATES.pads, -2.0, -2.0, -0.4, -0.2, -BEND, -RELAXATION, -0.2]
    high = [GATES.pads, GATES.pads, 2.0, 2.0, 0.18, 0.2, 0.7, 1.0, 0.2]
    if problem.free_radius:
        low, high = [*low, -RADIUS_RANGE], [*high, RADIUS_RANGE]
    if problem.free_share:
        low, high = [*low, -SHARE_RANGE], [*high, SHARE_RANGE]
    known = problem.vehicle.effects
    for name in names:
        card = definition(known, name).card
        for p, origin in zip(card.parameters, origins(known, card), strict=True):
            low.append((p.low - origin) / p.spread)
            high.append((p.high - origin) / p.spread)
    return np.array(low) - 1e-9, np.array(high) + 1e-9


def prior_rows(problem: Problem, names: tuple[str, ...], x: Array) -> Array:
    """Residuals of the weak priors; the strengths have none."""
    rows = [*(x[: problem.base_size] / problem.base_sigma)]
    for own in problem.places(names).values():
        rows += [float(v) / GATES.second_sigma for v in x[own][1:]]
    return np.asarray(rows)


def prior_derivatives(problem: Problem, names: tuple[str, ...], size: int) -> Array:
    """Derivatives (m, k) of `prior_rows`, which are linear in the vector (k,)."""
    rows = [prior_rows(problem, names, unit) for unit in np.eye(size)]
    return np.stack(rows, axis=1)


def with_priors(problem: Problem, names: tuple[str, ...], J: Array, size: int) -> Array:
    """Derivatives (n + m, j) of innovations and priors from those (n, j) of the innovations."""
    return np.concatenate([J, prior_derivatives(problem, names, size)[:, : J.shape[1]]])


def widths(problem: Problem, size: int) -> Array:
    """Usual change of each element of the vector (``size``,), as a scale of steps."""
    others = problem.base_sigma[BASE:]
    return np.concatenate([np.full(BASE, 0.1), others, np.ones(size - problem.base_size)])
