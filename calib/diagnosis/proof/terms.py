"""What no effect explains, as an empirical term: a random walk over its best driver, at its place.

    place x driver --> knots, values a random walk --> evidence by one linear model --> the best one

A place (brakes, wheels, body) is given a function of a driver (pressure, speed, temperature, time
since the bite or the start, deceleration, or none). Increments from knot to knot are normal; their
size is the one that the logs make most probable. The term describes; it is no physical cause.
"""

from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from calib.base.arrays import Array
from calib.car.braking import BITE
from calib.car.effects.effects import EmpiricalTerm
from calib.car.effects.empirical import DISCS, DRIVERS, PLACES, drivers_of
from calib.diagnosis.explanation.explanation import (
    PRICE,
    Explanation,
    Walk,
    based,
    fit,
    innovations,
    marginal,
)
from calib.diagnosis.explanation.predict import history_of

_KNOTS = 9
_WALKS = {True: (0.01, 0.03, 0.1), False: (0.001, 0.003, 0.01)}
"""Standard deviations of an increment that are tried: of a brake torque, of a force over the weight
[1]."""
_STEP = 0.02
_FITTED = 3


@dataclass(frozen=True)
class _Ranked:
    """A random walk, its values by one linear model, and what ln of the evidence grows by."""

    walk: Walk
    values: Array
    log_gain: float


def with_terms(at: Explanation) -> list[Explanation]:
    """The explanation with the best empirical terms, fitted, best first."""
    spots = [
        (place, driver)
        for driver in DRIVERS
        for place in PLACES
        if driver != "temperature" or _warm(at, place)
    ]
    alone = replace(at, problem=at.problem.alone)
    ranked = []
    for i, one in enumerate(at.problem.mapped(partial(_ranked, alone), spots)):
        at.problem.tell("looking for the place of what is left", i, len(spots))
        ranked.append(one)
    ranked.sort(key=lambda one: -one.log_gain)
    found = at.problem.mapped(partial(_fitted, alone), ranked[:_FITTED])
    return sorted(
        (replace(one, problem=at.problem) for one in found), key=lambda one: -one.log_evidence
    )


def _fitted(at: Explanation, one: _Ranked) -> Explanation:
    state = replace(at.state, x=np.concatenate([at.state.x, one.values]))
    return fit(at.problem, replace(at.hypothesis, walk=one.walk), state, at.columns)


def _warm(at: Explanation, place: str) -> bool:
    return all(
        (run.temperature_f if axle == "f" else run.temperature_r) is not None
        for run in at.problem.runs
        for axle in DISCS[PLACES[place]]
    )


def _knots(at: Explanation, place: str, driver: str) -> Array:
    """Knots over what the logs have of a driver; of pressure from where the pads bite."""
    if driver == "constant":
        return np.zeros(1)
    signals = [x for run in at.problem.runs for x in drivers_of(place, driver, history_of(run))]
    low, high = np.percentile(np.concatenate(signals), [1.0, 99.0])
    if driver == "pressure":
        return np.concatenate([[0.0], np.linspace(BITE, max(high, 2.0 * BITE), _KNOTS - 1)])
    return np.linspace(low, max(high, low + 1e-9), _KNOTS)


def _columns(at: Explanation, place: str, driver: str, knots: Array) -> list[Array]:
    """Derivatives (knots, n) of the innovations of each log by the values of a term."""
    base, effects = based(at.problem, at.hypothesis, at.state)
    found = []
    for hat in np.eye(knots.size):
        term = EmpiricalTerm(place, driver, tuple(knots.tolist()), tuple((_STEP * hat).tolist()))
        more = replace(effects, terms=(term,))
        pairs = zip(at.runs, at.innovations, strict=True)
        found.append([(innovations(at.problem, base, more, run) - r) / _STEP for run, r in pairs])
    return [np.stack(of_run) for of_run in zip(*found, strict=True)]


def _ranked(at: Explanation, spot: tuple[str, str]) -> _Ranked:
    """The best size of a random walk on a place over a driver."""
    knots = _knots(at, *spot)
    products = [at.products_of(i, of) for i, of in enumerate(_columns(at, *spot, knots))]
    E, g = marginal(at, products, at.hypothesis.sizes).beyond()
    found = []
    for size in _WALKS[spot[0].endswith("brakes")]:
        walk = Walk(*spot, tuple(knots.tolist()), size)
        H = E + walk.precision
        values = np.linalg.solve(H, g)
        more = np.linalg.slogdet(walk.precision)[1] - np.linalg.slogdet(H)[1]
        limited = np.clip(values, -walk.limit, walk.limit)
        found.append(_Ranked(walk, limited, 0.5 * float(g @ values + more) - PRICE))
    return max(found, key=lambda one: one.log_gain)
