"""Where the unexplained part sits: on which place of the car, and on what it depends.

A place (front brakes, rear brakes, body, front wheels, rear wheels) is given an empirical term: a
piecewise linear function of a driver (pressure, speed, disc temperature, time since the bite,
deceleration). The pair that explains most is where to look. The term is no physics and says so.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.course import BITE
from calib.diagnose.candidate import Candidate, Problem
from calib.diagnose.predict import Run, Term
from calib.diagnose.search import base_directions
from calib.effects.effect import Card, Effect, Motion, Pair, Parameters, Trace
from calib.names import G
from calib.vehicle import Vehicle

Array = NDArray[np.float64]

KNOTS = 5
"""Knots of a term over the range of its driver."""

PLACES = {
    "front_brakes": "front",
    "rear_brakes": "rear",
    "front_wheels": "front",
    "rear_wheels": "rear",
    "body": "body",
}
"""Places of a term and the axle they belong to."""

DRIVERS = ("pressure", "speed", "temperature", "time", "deceleration")


@dataclass(frozen=True)
class Structure:
    """The empirical term that explains most of what is left.

    ``place``, ``axle``, ``driver``; ``knots`` of the driver (SI) and ``values`` of the term there:
    a factor less one on brake torque, or a force over the weight; ``explained`` share of the excess
    [1]; ``runners_up`` (place, driver, share).
    """

    place: str
    axle: str
    driver: str
    knots: tuple[float, ...]
    values: tuple[float, ...]
    explained: float
    runners_up: tuple[tuple[str, str, float], ...]


def locate(problem: Problem, at: Candidate) -> Structure:
    """Try every place with every driver on top of ``at``, in one linear step each."""
    innovations = problem.flat(at.base, at.effects)
    directions = base_directions(problem, at, innovations)
    rest = innovations - directions @ (directions.T @ innovations)
    excess = max(at.chi2 - at.count, 1e-9)
    found = []
    for driver in DRIVERS:
        signals = [driver_of(run, driver) for run in problem.runs]
        if any(signal is None for signal in signals):
            continue
        knots = knots_of([s for s in signals if s is not None])
        for place in PLACES:
            gain, values = _explain(problem, at, (place, driver), knots, (directions, rest))
            found.append((gain / excess, place, driver, knots, values))
    found.sort(key=lambda item: -item[0])
    best = found[0]
    return Structure(
        place=best[1],
        axle=PLACES[best[1]],
        driver=best[2],
        knots=tuple(float(k) for k in best[3]),
        values=tuple(float(v) for v in best[4]),
        explained=float(best[0]),
        runners_up=tuple((place, driver, float(s)) for s, place, driver, _, _ in found[1:4]),
    )


def driver_of(run: Run, driver: str) -> Array | None:
    """A driver of a run [SI], (n,); None where it is not logged."""
    if driver == "pressure":
        return run.p_mc
    if driver == "speed":
        return run.v_smooth
    if driver == "temperature":
        return run.temperature_f
    if driver == "deceleration":
        return -run.a_x / G
    braked = run.p_mc > BITE
    last_free = np.maximum.accumulate(np.where(braked, -np.inf, run.time))
    return np.where(np.isfinite(last_free), run.time - last_free, run.time)


def knots_of(signals: list[Array]) -> Array:
    """Knots over the middle 98 % of a driver."""
    low, high = np.percentile(np.concatenate(signals), [1.0, 99.0])
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
        told = problem.flat(at.base, at.effects, (term(*where, knots, hat),))
        change = (told - innovations) / size
        columns.append(change - directions @ (directions.T @ change))
    A = np.stack(columns, axis=1)
    ridge = 1e-9 * float(np.trace(A.T @ A)) * np.eye(knots.size)
    values = -np.linalg.solve(A.T @ A + ridge, A.T @ rest)
    return float(rest @ rest - np.sum((rest + A @ values) ** 2)), values


def term(place: str, driver: str, knots: Array, values: Array) -> Term:
    """The empirical term as an effect: it adds to the same links as any other."""
    card = Card(
        name=f"empirical_{place}_over_{driver}",
        cause="not known",
        equation="piecewise linear over the driver",
        source="this run",
        looks_like="what was left",
        parameters=(),
    )

    def level(trace: Trace) -> Array:
        return np.interp(_driver(trace, driver), knots, values)

    def friction(parameters: Parameters, trace: Trace, p_f: Array, p_r: Array) -> Pair:
        one, factor = np.ones_like(p_f), 1.0 + level(trace)
        return (factor, one) if place == "front_brakes" else (one, factor)

    def force(vehicle: Vehicle, motion: Motion) -> Array:
        assert motion.trace is not None
        return np.asarray(vehicle.weight * level(motion.trace))

    def body(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> Array:
        return force(vehicle, motion)

    def moment(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> Pair:
        nothing = np.zeros_like(motion.v)
        if place == "front_wheels":
            return vehicle.front.rolling_radius * force(vehicle, motion), nothing
        return nothing, vehicle.rear.rolling_radius * force(vehicle, motion)

    if place in ("front_brakes", "rear_brakes"):
        return Effect(card, friction=friction), {}
    if place == "body":
        return Effect(card, body_force=body), {}
    return Effect(card, axle_moment=moment), {}


def _driver(trace: Trace, driver: str) -> Array:
    """The driver as an effect sees it."""
    if driver == "pressure":
        return trace.p_mc
    if driver == "speed":
        return trace.v
    if driver == "temperature":
        return np.zeros_like(trace.v) if trace.temperature_f is None else trace.temperature_f
    if driver == "deceleration":
        return trace.z
    braked = trace.p_mc > BITE
    last_free = np.maximum.accumulate(np.where(braked, -np.inf, trace.time))
    return np.where(np.isfinite(last_free), trace.time - last_free, trace.time)
