"""Where the unexplained part sits: on which place of the car, and on what it depends.

A place (front brakes, rear brakes, body, front wheels, rear wheels) is given an empirical term: a
piecewise linear function of a driver (pressure, speed, disc temperature, time since the bite,
deceleration). The pair that explains most is where to look. The term is no physics and says so.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.course import BITE
from calib.diagnose.candidate import Candidate, Problem, fit
from calib.diagnose.predict import trace_of
from calib.diagnose.search import base_directions
from calib.effects.empirical import DRIVERS, PLACES, Empirical, driver_along
from calib.model import TERM

Array = NDArray[np.float64]

KNOTS = 5
"""Knots of a term over the range of its driver."""

FITTED = 6
"""Terms fitted in full after the linear ranking."""


@dataclass(frozen=True)
class Structure:
    """The empirical term that explains most of what is left.

    ``term`` and the ``axle`` it acts on; ``explained`` share of the excess [1]; ``at`` the
    candidate with its base parameters fitted beside the term; ``runners_up`` as (place, driver,
    share).
    """

    term: Empirical
    axle: str
    explained: float
    at: Candidate
    runners_up: tuple[tuple[str, str, float], ...]


def locate(problem: Problem, at: Candidate) -> Structure:
    """Try every place with every driver on top of ``at``, in one linear step each."""
    innovations = problem.flat(at.base, at.effects)
    directions = base_directions(problem, at, innovations)
    rest = innovations - directions @ (directions.T @ innovations)
    excess = max(at.chi2 - at.count, 1e-9)
    found: list[Found] = []
    for driver in DRIVERS:
        if driver == "temperature" and any(run.temperature_f is None for run in problem.runs):
            continue
        signals = [driver_along(trace_of(run), driver) for run in problem.runs]
        knots = knots_of(driver, signals)
        for place in PLACES:
            gain, values = _explain(problem, at, (place, driver), knots, (directions, rest))
            found.append((gain / excess, place, driver, knots, values, at))
    found.sort(key=lambda item: -item[0])
    fitted = [_fitted(problem, at, item, excess) for item in found[:FITTED]]
    fitted.sort(key=lambda item: -item[0])
    best = fitted[0]
    return Structure(
        term=Empirical(best[1], best[2], tuple(best[3].tolist()), tuple(best[4].tolist())),
        axle=PLACES[best[1]],
        explained=float(best[0]),
        at=best[5],
        runners_up=tuple((place, driver, float(s)) for s, place, driver, *_ in fitted[1:4]),
    )


Found = tuple[float, str, str, Array, Array, Candidate]


def _fitted(problem: Problem, at: Candidate, item: Found, excess: float) -> Found:
    """A term fitted in full with the base: one linear step from a wrong base points wrong."""
    _, place, driver, knots, _, _ = item

    def make(values: Array) -> Empirical:
        return _term(place, driver, knots, values)

    start = np.concatenate([at.x, np.zeros(knots.size)])
    with_term = fit(problem, at.names, start, 8, (make, knots.size))
    share = (at.chi2 - with_term.chi2) / excess
    return share, place, driver, knots, with_term.x[-knots.size :], with_term


def knots_of(driver: str, signals: list[Array]) -> Array:
    """Knots over the middle 98 % of a driver; of pressure, one where the pads bite."""
    low, high = np.percentile(np.concatenate(signals), [1.0, 99.0])
    if driver == "pressure":
        return np.concatenate([[0.0], np.linspace(BITE, max(high, 2.0 * BITE), KNOTS - 1)])
    return np.linspace(low, max(high, low + 1e-9), KNOTS)


def _explain(
    problem: Problem,
    at: Candidate,
    where: tuple[str, str],
    knots: Array,
    present: tuple[Array, Array],
) -> tuple[float, Array]:
    """Gain in chi-square and values at the knots of one term."""
    directions, rest = present
    innovations = problem.flat(at.base, at.effects)
    size = 0.05
    columns = []
    for k in range(knots.size):
        hat = np.zeros(knots.size)
        hat[k] = size
        told = problem.flat(at.base, {**at.effects, TERM: _term(*where, knots, hat)})
        change = (told - innovations) / size
        columns.append(change - directions @ (directions.T @ change))
    A = np.stack(columns, axis=1)
    ridge = 1e-9 * float(np.trace(A.T @ A)) * np.eye(knots.size)
    values = np.asarray(-np.linalg.solve(A.T @ A + ridge, A.T @ rest), dtype=float)
    return float(rest @ rest - np.sum((rest + A @ values) ** 2)), values


def _term(place: str, driver: str, knots: Array, values: Array) -> Empirical:
    return Empirical(place, driver, tuple(knots.tolist()), tuple(values.tolist()))
