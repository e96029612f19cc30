"""What no effect explains, as an empirical term: a random walk over its best driver, at its place.

    pulses along every log --> place x driver --> knots, values a random walk --> evidence

Every driver is a function of time along a log, so what short pulses do to the innovations tells
what any function of any driver does. Increments from knot to knot are normal; their size is the one
that the logs make most probable. The term describes; it is no physical cause.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from calib.base.arrays import Array
from calib.base.names import AXLES, G
from calib.car.braking import BITE
from calib.car.effects.effects import EmpiricalTerm
from calib.car.effects.empirical import DISCS, DRIVERS, PLACES, drivers_of
from calib.diagnosis.explanation.channels import CHANNELS, by_channel, thinned
from calib.diagnosis.explanation.fit import Fit, innovations
from calib.diagnosis.explanation.gauss_newton import fit_logs
from calib.diagnosis.explanation.hypothesis import PRICE, Walk
from calib.diagnosis.explanation.predict import ObservedRun, predict

_BASIC = tuple(place for place in PLACES if place != "brakes")  # places that are no sum of others
_KNOTS = 20  # of a driver
_WALKS = {True: (0.003, 0.01, 0.03, 0.1), False: (0.0003, 0.001, 0.003, 0.01)}
"""Standard deviations of an increment [1]: of a brake torque, and of a force over the weight."""

_PULSE = 0.1  # half the width of a pulse [s]
_APART = 10  # such halves from one pulse of a comb to the next
_BEFORE, _AFTER = 0.3, 0.7  # times [s] around the middle of a pulse in which it moves innovations
_STEP = 0.02  # height of a pulse [1]
_FITTED = 2  # terms that are fitted
PLAIN = 0.03  # share of what a term explains by which one of a single number may explain less [1]


@dataclass(frozen=True)
class Ranked:
    """A random walk, its values by one linear model, and what ln of the evidence grows by."""

    walk: Walk
    values: Array
    log_gain: float


def ranked_terms(fit: Fit) -> list[Ranked]:
    """Rank every place and driver beside a fit, by one linear model; best first."""
    pulses, by_place = {}, fit.problem.mapped(partial(_pulses, fit.alone), _BASIC)
    for done, (place, of_place) in enumerate(zip(_BASIC, by_place, strict=True)):
        fit.problem.tell("looking for the place of what is left", done, len(_BASIC))
        pulses[place] = of_place
    # with the deceleration that is predicted: the noise of a measured one would predict itself
    predicted = [predict(fit.problem.vehicle, fit.base, fit.effects, run) for run in fit.runs]
    histories = [replace(run, z=-p.a_x / G) for run, p in zip(fit.runs, predicted, strict=True)]
    cold = {a for a in AXLES for run in fit.runs if getattr(run, f"temperature_{a}") is None}
    ranked = [
        _ranked(fit, place, driver, pulses, histories)
        for driver in DRIVERS
        for place in PLACES
        if driver != "temperature" or not cold & {*DISCS[PLACES[place]]}
    ]
    return sorted(ranked, key=lambda one: -one.log_gain)


def with_terms(fit: Fit, ranked: Sequence[Ranked]) -> list[Fit]:
    """Fit the best of these terms beside a fit; best first.

    A constant is among them where it promises hardly less: every other driver can imitate it, and
    a linear model is no judge of so little.
    """
    alone, least = replace(fit, problem=fit.problem.alone), (1.0 - PLAIN) * ranked[0].log_gain
    plain = [one for one in ranked if one.walk.driver == "constant" and one.log_gain >= least]
    some = [*plain, *(one for one in ranked if one.walk.driver != "constant")][:_FITTED]
    fits = fit.problem.mapped(partial(_fitted, alone), some)
    best_first = sorted(fits, key=lambda one: -one.log_evidence)
    return [replace(one, problem=fit.problem) for one in best_first]


def _fitted(fit: Fit, ranked: Ranked) -> Fit:
    state = replace(fit.state, x=np.concatenate([fit.state.x, ranked.values]))
    return fit_logs(fit.problem, replace(fit.hypothesis, walk=ranked.walk), state, fit.columns)


def _knots(fit: Fit, place: str, driver: str) -> Array:
    """Knots over what the logs have of a driver; of pressure from where the pads bite."""
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
    """Derivatives (k, n) of the innovations of each log by a value in each of its pulses.

    Pulses of a comb are so far apart that each moves innovations of its own.
    """
    base, effects, out = fit.base, fit.effects, []
    for run, lag, r in zip(fit.runs, fit.lags, fit.innovations, strict=True):
        middles = _middles(run)
        time = thinned(run, run.time - run.time[0])
        rows = np.tile(time[-by_channel(r).shape[1] :], len(CHANNELS))
        begin, end = middles[:, None] - _BEFORE, middles[:, None] + _AFTER
        derivatives = np.zeros((middles.size, r.size))
        for first in range(min(_APART, middles.size)):
            comb = np.arange(middles.size) % _APART == first
            values = tuple((_STEP * comb).tolist())
            term = EmpiricalTerm(place, "elapsed", tuple(middles.tolist()), values)
            moved = innovations(fit.problem, base, replace(effects, terms=(term,)), run, lag)
            near = (rows >= begin[comb]) & (rows < end[comb])
            derivatives[comb] = np.where(near, (moved - r) / _STEP, 0.0)
        out.append(derivatives)
    return out


def _ranked(
    fit: Fit,
    place: str,
    driver: str,
    pulses: dict[str, list[Array]],
    histories: Sequence[ObservedRun],
) -> Ranked:
    """The best size of a random walk on a place over a driver."""
    knots, columns = _knots(fit, place, driver), []
    parts = ("front_brakes", "rear_brakes") if place == "brakes" else (place,)
    for i, run in enumerate(histories):
        of_parts = []
        for part in parts:
            (along,) = drivers_of(part, driver, run)
            along = np.interp(_middles(run), run.time - run.time[0], along)
            weights = np.stack([np.interp(along, knots, hat) for hat in np.eye(knots.size)])
            of_parts.append(weights @ pulses[part][i])
        columns.append(np.sum(of_parts, axis=0))
    E, g = fit.marginal(fit.products_with(columns)).beyond()
    by_size = []
    for size in _WALKS[place.endswith("brakes")]:
        walk = Walk(place, driver, tuple(knots.tolist()), size)
        H = E + walk.precision
        values = np.linalg.solve(H, g)
        more = np.linalg.slogdet(walk.precision)[1] - np.linalg.slogdet(H)[1]
        gain = 0.5 * float(g @ values + more) - PRICE
        by_size.append(Ranked(walk, np.clip(values, -walk.limit, walk.limit), gain))
    return max(by_size, key=lambda one: one.log_gain)
