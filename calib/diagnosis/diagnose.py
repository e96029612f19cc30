"""The diagnosis of a car: find the gap, name its cause, add it, measure the gap on hold-outs.

calibration logs --> problem --> search <-- hold-outs judge --> verdict --> (something left: a term)
                                                                   |
                                                                   +--> model, replays, gap
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from calib.base.errors import ModelError
from calib.base.processes import Mapped, one_blas_thread
from calib.base.warning import PlausibilityWarning
from calib.car.effects.effect import slows
from calib.car.own_effects.own_effect import definition
from calib.car.vehicle import Vehicle
from calib.diagnosis.diagnosis import Diagnosis
from calib.diagnosis.explanation.explanation import Explanation
from calib.diagnosis.explanation.own import OWN
from calib.diagnosis.explanation.predict import run_of
from calib.diagnosis.explanation.problem import (
    Problem,
    Tell,
    problem_of,
    silent,
    turned,
    unbraked_noise,
)
from calib.diagnosis.named import base_estimates, named
from calib.diagnosis.proof.unexplained import unexplained_of
from calib.diagnosis.proof.verdict import Verdict, verdict_of
from calib.diagnosis.replays.gap import gap_of
from calib.diagnosis.replays.hold_outs import HoldOuts, model_of
from calib.diagnosis.replays.remainder import remainder_of
from calib.diagnosis.replays.replayed import Replayed, replayed
from calib.diagnosis.runs.axles import require_axles
from calib.diagnosis.runs.gates import (
    require_enough,
    require_own_pressure,
    require_right_channels,
    require_whole_wheel_speeds,
)
from calib.diagnosis.runs.judged import judged_logs
from calib.diagnosis.runs.sides import LARGEST, with_even_sides
from calib.diagnosis.runs.warnings import log_warnings, unexplained_warnings
from calib.diagnosis.search.search import Search
from calib.diagnosis.undecided import confusion_of, drives, unresolved
from calib.logs.log import Log
from calib.plausibility.run import wrong_speed
from calib.run.copies import without_holds
from calib.run.gates import refuse_copies

_QUIETER = 0.9
"""Share of a channel's noise below which it counts as quieter with an explanation than without."""


@one_blas_thread()
def diagnose(
    vehicle: Vehicle,
    calibration: list[Log],
    holdout: list[Log],
    tell: Tell = silent,
    mapped: Mapped = map,
) -> Diagnosis:
    """Find where a car and its model disagree, name the missing effect, and confirm it.

    Parameters
    ----------
    vehicle : the car as its datasheet has it; it may have effects that the catalogue lacks, see
        `calib.car.own_effects.own_effect.with_own`.
    calibration : two or more logs of different manoeuvres, in which the effect is searched.
    holdout : one or more logs, on which the effect must close the gap.
    tell : called at each step with the stage in words, the steps of it that are done, and their
        number.
    mapped : carries out independent pieces of work, see `calib.base.processes.side_by_side`.
        Effects of one's own, which other processes do not know, are tried in this one.

    Returns
    -------
    The diagnosis. Its ``model_after`` is the car with the identified effects, for `calib.simulate`.
    Left and right wheel speeds are made even where nothing brakes (`calib.diagnosis.runs.sides`).

    Raises LogError when there is no hold-out, when nothing in the logs is braked, and for a log
    that looks like a mistake: a run that is given twice, also as a copy; one whose channels `check`
    calls wrong; one of another car; wheel speeds that are swapped; a pressure of another run.

    >>> import calib
    >>> case = calib.sample_logs() / "hidden" / "case_0"
    >>> car = calib.read_vehicle(case / "vehicle.toml")
    >>> searched = [calib.read_log(case / f"calibration/{n}.parquet") for n in ("ramp", "coast")]
    >>> diagnosis = calib.diagnose(car, searched, [calib.read_log(case / "holdout/stop_a.parquet")])
    >>> [effect.name for effect in diagnosis.effects]
    ['aerodynamic_drag']
    >>> low, high = diagnosis.effects[0].parameters["drag_area"].ci95
    >>> low < 0.7444 < high  # m^2, the hidden value
    True
    """
    tell("checking the logs", 0, 1)
    warnings = checked(vehicle, calibration, holdout)
    sides, search, found = _judged(vehicle, calibration, holdout, tell, mapped)
    best, last, rest = found.best, found.after, None
    if found.terms:
        rest = unexplained_of(best, found.terms)
        last = _with_term(found, rest.at)
    tell("asking what these logs could not show", 0, 1)
    confusion = confusion_of(best, found.rivals)
    return Diagnosis(
        verdict=found.word,
        effects=named(found, confusion) if found.stands else (),
        unexplained=rest,
        base=base_estimates(best),
        gap=gap_of(found.before.logs, last.logs, found.held.logs),
        model_before=model_of(vehicle, found.before.at.base, found.before.at.effects),
        model_after=model_of(vehicle, last.at.base, last.at.effects),
        before=found.before.logs,
        after=last.logs,
        measured=found.held.logs,
        reduced_before=found.base.reduced,
        reduced_after=last.at.reduced if rest else best.reduced,
        left=remainder_of(found.after.logs, found.held.logs),
        withdrawn=_withdrawn(search),
        steps=tuple(search.steps),
        noise=search.problem.noise,
        own=_own(found),
        drives=drives(best, unresolved(best, search.further)),
        confusion=confusion,
        sides=sides,
        warnings=unexplained_warnings(
            warnings, left=rest is not None, grouped=bool(best.hypothesis.kinds)
        ),
    )


def checked(
    vehicle: Vehicle, calibration: list[Log], holdout: list[Log]
) -> tuple[PlausibilityWarning, ...]:
    """What speaks against the logs; raises LogError for a mistake that must not be searched in."""
    logs = [*calibration, *holdout]
    require_enough(calibration, holdout)
    refuse_copies(calibration, holdout)
    require_right_channels(vehicle, logs)
    judged = judged_logs(vehicle, logs)
    require_axles(vehicle, logs, judged)
    require_own_pressure(judged)
    warnings = log_warnings(judged)
    if (wrong := wrong_speed(warnings)) is not None:
        raise wrong
    require_whole_wheel_speeds(warnings)
    return warnings


def _judged(
    vehicle: Vehicle, calibration: list[Log], holdout: list[Log], tell: Tell, mapped: Mapped
) -> tuple[dict[str, float], Search, Verdict]:
    """How the sides of each axle differed [1] before they were made even; search and verdict then.

    A difference that tyres of one age do not make is made even if nothing that slows the car is
    missing then: it is no brake that drags.
    """
    given = [*sorted(calibration, key=lambda log: log.digest), *holdout]
    logs, n = [without_holds(log) for log in given], len(calibration)
    usual, sides = with_even_sides(logs)
    unlike, all_sides = with_even_sides(logs, LARGEST)
    if sides != all_sides:
        search, found = _searched(vehicle, unlike[:n], unlike[n:], tell, mapped)
        if _rolls_freely(found):
            return all_sides, search, found
    return sides, *_searched(vehicle, usual[:n], usual[n:], tell, mapped)


def _rolls_freely(found: Verdict) -> bool:
    """Whether nothing is left, and nothing named slows the car."""
    known = found.best.problem.vehicle.effects
    slowed = any(slows(definition(known, name)) for name in found.best.names)
    return not found.terms and not slowed


def _searched(
    vehicle: Vehicle, calibration: list[Log], holdout: list[Log], tell: Tell, mapped: Mapped
) -> tuple[Search, Verdict]:
    """A search, once more with the noise that its best explanation leaves, and its verdict.

    An effect that acts in unbraked parts, such as a tone ring that runs out, was part of the noise.
    """
    known_to_all = map if vehicle.effects.own else mapped
    problem = problem_of(vehicle, [run_of(log) for log in calibration], tell, known_to_all)
    search = _search(problem, holdout)
    quieter = _without_its_noise(search.best)
    if quieter is not None:
        search = _search(quieter, holdout)
    tell("replaying the hold-outs", 0, 1)
    return search, verdict_of(search)


def _search(problem: Problem, holdout: list[Log]) -> Search:
    runs = turned(problem.vehicle, [run_of(log) for log in holdout], problem.noise)
    search = Search(problem, HoldOuts(tuple(holdout), replace(problem, runs=runs)))
    search.run()
    return search


def _without_its_noise(best: Explanation) -> Problem | None:
    """The problem with the noise that is left with an explanation, None if that is no quieter."""
    problem = best.problem
    noise = unbraked_noise(problem.vehicle, best.base, best.effects, problem.runs)
    if not best.names or np.all(noise.sigma > _QUIETER * problem.noise.sigma):
        return None
    return replace(problem, noise=noise)


def _with_term(found: Verdict, at: Explanation) -> Replayed:
    """The replays with an empirical term; without it where it does not help."""
    try:
        last = replayed(found.held, at)
    except ModelError:  # such a term need not have an equilibrium
        return found.after
    helped = gap_of(found.after.logs, last.logs, found.held.logs).closed > 0.0
    return last if helped else found.after


def _withdrawn(search: Search) -> tuple[tuple[str, ...], ...]:
    """What the hold-outs spoke against once, and never asked for."""
    asked_for = {frozenset(step.names) for step in search.steps}
    return tuple(names for names in search.withdrawn if frozenset(names) not in asked_for)


def _own(found: Verdict) -> Mapping[str, Mapping[str, float]]:
    """By log what it has of its own, of the kinds in which logs differ."""
    best, own = found.best, dict[str, Mapping[str, float]]()
    if not best.hypothesis.kinds:
        return own
    states = np.vstack([best.state.own, found.after.own])
    runs = (*best.problem.runs, *found.held.problem.runs)
    for run, row in zip(runs, states.tolist(), strict=True):
        own[run.source] = dict(zip(OWN, row, strict=True))
    return own
