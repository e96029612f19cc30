"""Describe by an empirical term what no effect explains: a function of a driver at a place.

A place is a part of the car, such as the front brakes; a driver is a variable, such as pressure.
The values of the term at the knots of its driver are a random walk: increments from knot to knot
are normal, of the size that the logs make most probable. A term is no physical cause.

Every driver is a function of time along a log. So the derivatives of the innovations by short
pulses in time at a place, once computed, give those by any function of any driver.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from calib.base.arrays import Array
from calib.base.names import AXLES, G
from calib.car.braking import BITE
from calib.car.effects.effects import EmpiricalTerm
from calib.car.effects.empirical import AXLES_OF, DRIVERS, PLACES, drivers_of
from calib.diagnosis.explanation.channels import CHANNELS, by_channel, thinned
from calib.diagnosis.explanation.fit import Fit, innovations
from calib.diagnosis.explanation.gauss_newton import fit_logs
from calib.diagnosis.explanation.hypothesis import PRICE, Walk
from calib.diagnosis.explanation.predict import ObservedRun, predict

_BASIC = tuple(place for place in PLACES if place != "brakes")  # places that are no sum of others
_KNOTS = 20  # number of knots of a driver
_SIZES_ON_BRAKES = (0.003, 0.01, 0.03, 0.1)
"""Standard deviations of an increment [1] that are tried, as shares of a brake torque."""
_SIZES_OF_FORCES = (0.0003, 0.001, 0.003, 0.01)  # the same, as shares of the weight
_PULSE = 0.1  # half the width of a triangular pulse, and the distance from pulse to pulse [s]
_APART = 10  # distance of two pulses that are tried together [pulses]
_BEFORE, _AFTER = 0.3, 0.7  # times [s] around the middle of a pulse in which innovations change
_STEP = 0.02  # height of a pulse [1]
_FITTED = 2  # number of terms that are fitted
PLAIN_LOSS = 0.03  # share of the gain that a term of a single number may lack [1]


@dataclass(frozen=True)
class Ranked:
    """A term with its values by the linear model."""

    walk: Walk
    values: Array  # at the knots
    log_gain: float  # gain of ln of the evidence, less the price


def ranked_terms(fit: Fit) -> list[Ranked]:
    """Rank terms at every place and over every logged driver beside a fit; best first."""
    pulses = {}
    by_place = fit.problem.mapped(partial(_pulses, fit.for_worker), _BASIC)
    for number, (place, of_place) in enumerate(zip(_BASIC, by_place, strict=True)):
        fit.problem.tell("looking for the place of what is left", number, len(_BASIC))
        pulses[place] = of_place
    # with the predicted deceleration, since the noise of the measured one would predict itself
    predicted = [predict(fit.problem.vehicle, fit.base, fit.effects, run) for run in fit.runs]
    histories = [replace(run, z=-p.a_x / G) for run, p in zip(fit.runs, predicted, strict=True)]
    unlogged = {a for a in AXLES for run in fit.runs if getattr(run, f"temperature_{a}") is None}
    ranked = [
        _ranked(fit, place, driver, pulses, histories)
        for driver in DRIVERS
        for place in PLACES
        if driver != "temperature" or unlogged.isdisjoint(AXLES_OF[PLACES[place]])
    ]
    return sorted(ranked, key=lambda term: -term.log_gain)


def with_terms(fit: Fit, ranked: Sequence[Ranked]) -> list[Fit]:
    """Fit the best of the ``ranked`` terms beside a fit; best first.

    A constant term is among them if it promises hardly less: every other driver can imitate a
    constant, and the linear model is too inexact for so small a difference.
    """
    least = (1.0 - PLAIN_LOSS) * ranked[0].log_gain
    constant = [r for r in ranked if r.walk.driver == "constant" and r.log_gain >= least]
    chosen = [*constant, *(r for r in ranked if r.walk.driver != "constant")][:_FITTED]
    fit_in_worker = partial(_with_term, replace(fit, problem=fit.problem.for_worker))
    fits = fit.problem.mapped(fit_in_worker, chosen)
    best_first = sorted(fits, key=lambda f: -f.log_evidence)
    return [replace(with_term, problem=fit.problem) for with_term in best_first]


def _with_term(fit: Fit, term: Ranked) -> Fit:
    state = replace(fit.state, x=np.concatenate([fit.state.x, term.values]))
    return fit_logs(fit.problem, replace(fit.hypothesis, walk=term.walk), state, fit.columns)


def _knots(fit: Fit, place: str, driver: str) -> Array:
    """Knots (k,) over the range of a driver in the logs: for pressure, 0 and from the bite on."""
    if driver == "constant":
        return np.zeros(1)
    signals = [x for run in fit.problem.runs for x in drivers_of(place, driver, run)]
    low, high = np.percentile(np.concatenate(signals), [1.0, 99.0])
    if driver == "pressure":
        return np.concatenate([[0.0], np.linspace(BITE, max(high, 2.0 * BITE), _KNOTS - 1)])
    return np.linspace(low, max(high, low + 1e-9), _KNOTS)


def _middles(run: ObservedRun) -> Array:
    """Middles (k,) of the pulses of a run [s since its start]."""
    return np.arange(0.0, run.time[-1] - run.time[0] + _PULSE, _PULSE)


def _pulses(fit: Fit, place: str) -> list[Array]:
    """Derivatives (k, n) of the innovations of each log by a term in each of k pulses.

    Pulses at a distance of `_APART` change different innovations, so they are tried together.
    """
    base, effects, collected = fit.base, fit.effects, []
    for run, lag, r in zip(fit.runs, fit.lags, fit.innovations, strict=True):
        middles = _middles(run)
        time = thinned(run, run.time - run.time[0])
        times = np.tile(time[-by_channel(r).shape[1] :], len(CHANNELS))  # of the innovations
        begin, end = middles[:, None] - _BEFORE, middles[:, None] + _AFTER
        derivatives = np.zeros((middles.size, r.size))
        for first in range(min(_APART, middles.size)):
            comb = np.arange(middles.size) % _APART == first
            values = tuple((_STEP * comb).tolist())
            term = EmpiricalTerm(place, "elapsed", tuple(middles.tolist()), values)
            moved = innovations(fit.problem, base, replace(effects, terms=(term,)), run, lag)
            near = (times >= begin[comb]) & (times < end[comb])
            derivatives[comb] = np.where(near, (moved - r) / _STEP, 0.0)
        collected.append(derivatives)
    return collected


def _ranked(
    fit: Fit,
    place: str,
    driver: str,
    pulses: dict[str, list[Array]],
    histories: Sequence[ObservedRun],
) -> Ranked:
    """Return the term at a place over a driver, with the most probable size of its increments."""
    knots, columns = _knots(fit, place, driver), []
    parts = ("front_brakes", "rear_brakes") if place == "brakes" else (place,)
    for i, run in enumerate(histories):
        of_parts = []  # derivatives (k, n) by the values at the knots
        for part in parts:
            (signal,) = drivers_of(part, driver, run)
            # a value acts with a hat function of the driver, so by the pulses under that hat
            at_pulses = np.interp(_middles(run), run.time - run.time[0], signal)
            weights = np.stack([np.interp(at_pulses, knots, hat) for hat in np.eye(knots.size)])
            of_parts.append(weights @ pulses[part][i])
        columns.append(np.sum(of_parts, axis=0))
    E, g = fit.marginal(fit.products_with(columns)).eliminated()
    by_size = []
    for size in _SIZES_ON_BRAKES if place.endswith("brakes") else _SIZES_OF_FORCES:
        walk = Walk(place, driver, tuple(knots.tolist()), size)
        H = E + walk.precision
        values = np.linalg.solve(H, g)
        log_ratio = np.linalg.slogdet(walk.precision)[1] - np.linalg.slogdet(H)[1]
        gain = 0.5 * float(g @ values + log_ratio) - PRICE
        by_size.append(Ranked(walk, np.clip(values, -walk.limit, walk.limit), gain))
    return max(by_size, key=lambda ranked: ranked.log_gain)
