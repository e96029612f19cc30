"""The vector that is fitted: the base parameters, then those of the effects."""

from dataclasses import replace

import numpy as np

from calib.base.arrays import Array
from calib.car.effects.effect import Card
from calib.car.effects.effects import Effects
from calib.car.own_effects.own_effect import definition
from calib.diagnosis.explanation.base import BASE, BEND, RELAXATION, Base, base_of
from calib.diagnosis.explanation.problem import DRAG, SHARE, SHARE_RANGE, USUAL_SHARE, Problem

_PADS = 0.7
"""Largest logarithm of a pad friction over that of the file: half and double. With rear pads of 2.8
times the file's, a valve imitated a motor."""

_LOW = (-_PADS, -_PADS, -2.0, -2.0, -0.4, -0.2, -BEND, -RELAXATION, -0.2, -0.05, -1.0)
_HIGH = (_PADS, _PADS, 2.0, 2.0, 0.18, 0.2, 0.7, 1.0, 0.2, 0.05, 1.0)
"""Range of the base parameters."""


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
            values[p.name] = min(max(origin + float(x[i]) * p.spread, p.low), p.high)
            i += 1
        found[name] = values
    base = base_of(problem.vehicle, x[:BASE])
    return base, known.with_(Effects(found))


def _with_share(problem: Problem, x: Array) -> Effects:
    """The known effects, with the load that a known drag moves by the vector."""
    known = problem.vehicle.effects
    if not problem.free_share:
        return known
    share = USUAL_SHARE + float(x[BASE])
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
    """Least and largest values of the vector: of the cards, for the effects."""
    low, high = list(_LOW), list(_HIGH)
    if problem.free_share:
        low, high = [*low, -SHARE_RANGE], [*high, SHARE_RANGE]
    known = problem.vehicle.effects
    for name in names:
        card = definition(known, name).card
        for p, origin in zip(card.parameters, origins(known, card), strict=True):
            low.append((p.low - origin) / p.spread)
            high.append((p.high - origin) / p.spread)
    return np.array(low), np.array(high)
