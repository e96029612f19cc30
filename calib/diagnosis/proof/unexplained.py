"""The unexplained part: the place of the car at which it acts, and the variable it depends on.

A place (front brakes, rear brakes, body, front wheels, rear wheels) is given an empirical term: a
piecewise linear function of a driver (pressure, speed, disc temperature, time since the bite,
deceleration, or none). The pair that explains most tells where to look. The term describes; it is
not a physical cause. A term cannot follow an effect of the wheel angle, which starts at another
angle in every run: the share of such an effect is computed from its harmonics. Nor can it follow
what swings with a frequency of its own: that share is computed from the spectrum. A term shows a
brake torque that something holds, though not what does.
"""

from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from calib.car.braking import BITE
from calib.car.effects.effects import EmpiricalTerm
from calib.car.effects.empirical import DISCS, DRIVERS, PLACES, drivers_of
from calib.diagnosis.explanation.candidate import Candidate, free
from calib.diagnosis.explanation.channels import CHANNELS, thinned
from calib.diagnosis.explanation.fit import FreeTerm, fit
from calib.diagnosis.explanation.predict import ObservedRun, history_of
from calib.diagnosis.explanation.problem import Problem, joined
from calib.diagnosis.gates import GATES
from calib.diagnosis.proof.hold_outs import HoldOuts
from calib.diagnosis.proof.oscillation import Oscillation, oscillation_of
from calib.diagnosis.search.decide import quiet

Array = NDArray[np.float64]

_KNOTS = 5
"""Knots of a term over the range of its driver."""

FITTED, FITTED_BESIDE = 4, 1
"""Terms fitted in full after the linear ranking: alone, and beside effects. Beside effects the base
is right already, and one linear step nearly is."""

OF_FRICTION, OF_WEIGHT = 0.9, 0.1
"""Largest value of a term: share of a pad's friction, and force over the weight of the car. A
larger force over the deceleration would make the prediction follow the measured one."""


WHEEL_ANGLE, FREQUENCY, SLIP = "wheel_angle", "frequency", "slip"
"""Drivers that no term has."""


_HARMONICS = (1, 2)
"""Harmonics of the wheel's turn; run-out and uneven spacing show in the first ones."""


@dataclass(frozen=True)
class UnexplainedTerm:
    """The empirical term that explains most of what is left.

    ``term`` and the ``axle`` it acts on; ``explained`` share of the excess, at most 1; ``at`` the
    candidate with its base parameters fitted beside the term; ``runners_up`` as (place, driver,
    share); ``driver`` the variable it depends on: the term's, `WHEEL_ANGLE` where ``turning``, the
    share that goes with the angle of the wheels, is larger, `FREQUENCY` where that of
    ``oscillation`` is, or `SLIP` where the torque of front brakes is held: no valve does that;
    ``wheel`` the one that is slower than the other wheel of its axle, where that is most of the
    excess; ``on_hold_outs`` whether it was placed with the hold-outs, as the calibration logs do
    not show it.
    """

    term: EmpiricalTerm
    axle: str
    driver: str
    explained: float
    turning: float
    oscillation: Oscillation
    wheel: str | None
    at: Candidate
    runners_up: tuple[tuple[str, str, float], ...]
    on_hold_outs: bool = False

    @property
    def place(self) -> str:
        """Where it acts, one of `PLACES`: that of the term, but of what swings."""
        if self.driver != FREQUENCY:
            return self.term.place
        return "body" if self.oscillation.body else "brakes"


def held_from(term: EmpiricalTerm) -> float | None:
    """Pressure [Pa] above which a brake torque hardly rises with it; None where it does rise.

    Brake control that limits the slip holds a torque so; at the rear, a valve does, too.
    """
    if not term.on_brakes or term.driver != "pressure":
        return None
    p = np.array(term.knots)
    torque = p * (1.0 + np.array(term.values))
    for i in range(2, p.size - 1):
        if np.all(np.diff(torque[i:]) < GATES.held * torque[i] / p[i] * np.diff(p[i:])):
            return float(p[i])
    return None


def place_of_rest(at: Candidate, held: HoldOuts) -> UnexplainedTerm:
    """Locate what is left on top of ``at``: with the calibration logs where they show it.

    Else with the hold-outs, which may go to a pressure or a speed of their own.
    """
    if at.reduced <= quiet(at):
        seen = held.seen_with(at)
        if seen.reduced > at.reduced:
            return replace(locate(seen), on_hold_outs=True)
    return locate(at, held.problem.runs)


def locate(at: Candidate, held: tuple[ObservedRun, ...] = ()) -> UnexplainedTerm:
    """Try every place with every driver on top of ``at``, in one linear step each.

    A temperature is tried only where every run has it, the hold-outs ``held`` among them.
    """
    problem = at.problem
    excess = max(at.chi2 - at.count, float(np.sqrt(2.0 * at.count)))  # at least that of noise
    spots = [
        (place, driver, _knots_on(problem, place, driver))
        for driver in DRIVERS
        for place in PLACES
        if driver != "temperature" or _warm(place, (*problem.runs, *held))
    ]
    alone = replace(at, problem=problem.alone)
    explained = problem.mapped(
        partial(_explained, alone, joined(at.whitened), at.directions, at.rest), spots
    )
    found: list[Found] = []
    for i, (place, driver, knots) in enumerate(spots):
        problem.tell("looking for the place of what is left", i, len(spots))
        gain, values = next(explained)
        found.append((gain / excess, place, driver, knots, values, alone))
    found.sort(key=lambda item: -item[0])
    tried = found[: FITTED_BESIDE if at.names else FITTED]
    tried += _constant_beside(tried[0], found[len(tried) :])
    problem.tell("fitting what is left", 0, 1)
    placed = problem.mapped(partial(_fitted, alone, excess), tried)
    fitted = sorted(placed, key=lambda item: -item[0])
    others = fitted if len(fitted) > FITTED_BESIDE + 1 else fitted + found[len(tried) :]
    nearly = [f for f in fitted if f[0] > fitted[0][0] - GATES.plain]
    plain = (f for f in nearly if f[2] == "constant" or held_from(_term(*f[1:5])) is not None)
    best = next(plain, fitted[0])
    turning, axle = _turning(problem, at, excess)
    swing = oscillation_of(at.whitened, excess)
    least = max(float(best[0]), GATES.no_term)
    term = _term(*best[1:5])
    driver, acts_on = term.driver, PLACES[term.place]
    if held_from(term) is not None and acts_on != "rear":
        driver = SLIP
    if turning > max(least, swing.share):
        driver, acts_on = WHEEL_ANGLE, axle
    elif swing.share > least:
        driver, acts_on = FREQUENCY, "body" if swing.body else "both"
    return UnexplainedTerm(
        term=term,
        axle=acts_on,
        driver=driver,
        explained=min(float(best[0]), 1.0),
        turning=turning,
        oscillation=swing,
        wheel=_one_sided(at, excess),
        at=best[5],
        runners_up=tuple(
            (place, driver, min(float(s), 1.0))
            for s, place, driver, *_ in others
            if (place, driver) != best[1:3]
        )[:3],
    )


def _warm(place: str, runs: tuple[ObservedRun, ...]) -> bool:
    """Whether all runs have the temperatures that a term on a place reads."""
    return all(
        (run.temperature_f if axle == "f" else run.temperature_r) is not None
        for run in runs
        for axle in DISCS[PLACES[place]]
    )


def _constant_beside(best: "Found", found: "list[Found]") -> "list[Found]":
    """The constant term on the place of the best one, if it is among the others ``found``."""
    return [f for f in found if f[1] == best[1] and f[2] == "constant"]


def _turning(problem: Problem, at: Candidate, excess: float) -> tuple[float, str]:
    """Share of the excess that goes with the angle of the front or rear wheels, and which [1]."""
    shares = {}
    for axle, own in (("front", "front_sides"), ("rear", "rear_sides")):
        gain = 0.0
        for run, channels in zip(problem.runs, at.whitened, strict=True):
            angle = thinned(run, run.angle_f if axle == "front" else run.angle_r)
            for name in ("rim", "front_rear", own):
                x = channels[CHANNELS.index(name)]
                turn = np.exp(1j * np.outer(_HARMONICS, angle[-x.size :]))
                # noise alone gives two per harmonic: cosine and sine
                gain += float(np.sum(2.0 * np.abs(turn @ x) ** 2 / x.size - 2.0))
        shares[axle] = gain / excess
    best = max(shares, key=lambda axle: shares[axle])
    return min(shares[best], 1.0), best


def _one_sided(at: Candidate, excess: float) -> str | None:
    """The slower wheel of an axle, where left less right holds most of the excess; else None."""
    sides = {}
    for axle in ("front", "rear"):
        x = np.concatenate([run[CHANNELS.index(f"{axle}_sides")] for run in at.whitened])
        sides[axle] = (float(x @ x) - x.size, float(np.mean(x)))
    axle = max(sides, key=lambda a: sides[a][0])
    beyond, mean = sides[axle]
    if beyond < GATES.one_sided * excess or abs(mean) * np.sqrt(at.count / len(CHANNELS)) < 5.0:
        return None
    return f"{axle}_{'left' if mean < 0.0 else 'right'}"


_Spot = tuple[str, str, Array]
"""A place, a driver and the knots over it."""

Found = tuple[float, str, str, Array, Array, Candidate]


def _fitted(at: Candidate, excess: float, item: Found) -> Found:
    """A term fitted in full together with the base; one linear step is wrong if the base is."""
    _, place, driver, knots, _, _ = item

    def make(values: Array) -> EmpiricalTerm:
        return _term(place, driver, knots, values)

    start = np.concatenate([at.x, np.zeros(knots.size)])
    limit = OF_FRICTION if make(item[4]).on_brakes else OF_WEIGHT
    with_term = fit(at.problem, at.names, start, 12, FreeTerm(make, knots.size, limit))
    share = (at.chi2 - with_term.chi2) / excess
    return share, place, driver, knots, with_term.x[-knots.size :], with_term


def _knots_on(problem: Problem, place: str, driver: str) -> Array:
    signals = (drivers_of(place, driver, history_of(run)) for run in problem.runs)
    return _knots_of(driver, [x for of_run in signals for x in of_run])


def _knots_of(driver: str, signals: list[Array]) -> Array:
    """Knots over the middle 98 % of a driver; of pressure, one where the pads bite."""
    if driver == "constant":
        return np.zeros(1)
    low, high = np.percentile(np.concatenate(signals), [1.0, 99.0])
    if driver == "pressure":
        return np.concatenate([[0.0], np.linspace(BITE, max(high, 2.0 * BITE), _KNOTS - 1)])
    return np.linspace(low, max(high, low + 1e-9), _KNOTS)


def _explained(
    at: Candidate, innovations: Array, directions: Array, rest: Array, spot: _Spot
) -> tuple[float, Array]:
    """Gain in chi-square and values at the knots of one term."""
    knots, size, columns = spot[2], 0.05, []
    for k in range(knots.size):
        hat = np.zeros(knots.size)
        hat[k] = size
        effects = replace(at.effects, terms=(_term(*spot[:2], knots, hat),))
        change = (at.problem.flat(at.base, effects) - innovations) / size
        columns.append(free(change, directions))
    A = np.stack(columns, axis=1)
    ridge = 1e-9 * float(np.trace(A.T @ A)) * np.eye(knots.size)
    values = np.asarray(-np.linalg.solve(A.T @ A + ridge, A.T @ rest), dtype=float)
    return float(rest @ rest - np.sum((rest + A @ values) ** 2)), values


def _term(place: str, driver: str, knots: Array, values: Array) -> EmpiricalTerm:
    return EmpiricalTerm(place, driver, tuple(knots.tolist()), tuple(values.tolist()))
