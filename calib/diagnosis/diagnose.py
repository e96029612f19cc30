"""The diagnosis of a car: find the gap, name its cause, add it, measure the gap on hold-outs.

    calibration logs --problem_of--> Problem --run_search--> Search --verdict_of--> Verdict

The hold-outs judge the search. The verdict has an empirical term if no effect explains the logs.
"""

from calib.base.errors import ModelError
from calib.base.processes import MapFunction, one_blas_thread
from calib.car.effects.catalogue import definition
from calib.car.effects.effect import SLOWING, acts_on
from calib.car.vehicle import Vehicle
from calib.diagnosis import runs
from calib.diagnosis.diagnosis import Diagnosis
from calib.diagnosis.explanation.predict import run_of
from calib.diagnosis.explanation.problem import Tell, problem_of, silent
from calib.diagnosis.named import base_estimates, named
from calib.diagnosis.replays import Replayed, gap_of, model_of
from calib.diagnosis.search import run_search
from calib.diagnosis.verdict import Verdict, unexplained_of, verdict_of
from calib.logs.log import Log
from calib.run.copies import without_holds


@one_blas_thread()
def diagnose(
    vehicle: Vehicle,
    calibration: list[Log],
    holdout: list[Log],
    tell: Tell = silent,
    mapped: MapFunction = map,
) -> Diagnosis:
    """Find where a car and its model disagree, name the missing effect, and confirm it.

    The mean left and right wheel speeds of the unbraked parts are made equal first. The
    ``model_after`` of the result is the car with the identified effects, for `calib.simulate`.

    Parameters
    ----------
    vehicle : the car as its datasheet has it; it may have effects that the catalogue lacks, see
        `calib.car.effects.catalogue.with_own`.
    calibration : two or more logs of different manoeuvres, in which the effect is searched.
    holdout : one or more logs, on which the effect must close the gap.
    tell : called at each step with the stage in words, its steps done, and the number of its steps.
    mapped : a `map` that may work in several processes, see `calib.base.processes.parallel_map`.
        Effects of the user, which other processes do not know, are tried in this one.

    Raises LogError for too few logs, if nothing in the logs is braked, and for a log that looks
    like a mistake: a run that is given twice, channels that `check` refuses, another car, wheel
    speeds that are swapped, a pressure of another run.

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
    warnings = runs.checked(vehicle, calibration, holdout)
    in_order = [*sorted(calibration, key=lambda log: log.digest), *holdout]
    recorded, count = [without_holds(log) for log in in_order], len(calibration)
    known_to_all = map if vehicle.effects.user_defined else mapped
    for largest in (runs.LARGEST_DIFFERENCE, runs.USUAL_DIFFERENCE):
        logs, taken_out = runs.with_even_sides(recorded, largest)
        observed = [run_of(log) for log in logs[:count]]
        search = run_search(problem_of(vehicle, observed, tell, known_to_all), logs[count:])
        runs.require_right_axles(search, logs, warnings)
        tell("replaying the hold-outs", 0, 1)
        verdict = verdict_of(search)
        # a large difference may be a brake that drags on one wheel: then search again with it
        effects = (definition(vehicle.effects, name) for name in verdict.best.names)
        may_drag = any(acts_on(x, SLOWING) for x in effects) or verdict.term is not None
        if taken_out <= runs.USUAL_DIFFERENCE or not may_drag:
            break
    best, last = verdict.best, _last_replays(verdict)
    unexplained = None
    if verdict.term is not None:
        unexplained = unexplained_of(best, verdict.term, search.gap(verdict.after).rms_after)
    after = last.simulated if unexplained else best  # only the fit of the replays has the term
    accepted = [set(names) for names in search.steps]
    withdrawn = (names for names in search.withdrawn.values() if set(names) not in accepted)
    return Diagnosis(
        verdict=verdict.word,
        effects=named(verdict),
        unexplained=unexplained,
        base=base_estimates(best),
        gap=gap_of(last.base_logs, last.logs, search.holdouts.logs),
        model_before=model_of(vehicle, last.base.base, last.base.effects),
        model_after=model_of(vehicle, last.simulated.base, last.simulated.effects),
        replays_before=last.base_logs,
        replays_after=last.logs,
        measured=search.holdouts.logs,
        reduced_before=search.base.mean_square,
        reduced_after=after.mean_square,
        withdrawn=tuple(dict.fromkeys(withdrawn)),
        steps=tuple(search.steps),
        warnings=runs.unexplained_warnings(
            warnings, unexplained=unexplained is not None, grouped=bool(best.hypothesis.groups)
        ),
    )


def _last_replays(verdict: Verdict) -> Replayed:
    """Return the replays with the empirical term, or those without if it does not close the gap."""
    without = verdict.after
    if verdict.term is None:
        return without
    try:
        with_term = verdict.search.replayed(verdict.term)
    except ModelError:  # a car with such a term need not have an equilibrium
        return without
    gap = gap_of(without.logs, with_term.logs, verdict.search.holdouts.logs)
    return with_term if gap.closed > 0.0 else without
