"""Check the logs of a diagnosis before and after the search, and make their sides even.

A mistake made while logs are recorded or named looks like an unknown effect. Logs that `check` and
`fit` refuse are refused here, too, in the same words. So are mistakes that only show between logs:
a hold-out that is a copy, the pressure of another run, and wheel speeds of swapped axles.

`checked` comes before the search, `unexplained_warnings` and `require_right_axles` after it.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from calib.base.arrays import Mask
from calib.base.errors import LogError
from calib.base.names import AXLES
from calib.base.warning import REFUSE, PlausibilityWarning
from calib.car.vehicle import Vehicle
from calib.diagnosis.explanation.predict import run_of
from calib.diagnosis.explanation.problem import Problem, with_ripple_phase
from calib.diagnosis.fits import Fits
from calib.diagnosis.rank import promises, trials
from calib.diagnosis.search import Search
from calib.logs.log import Log
from calib.plausibility.evidence import Evidence
from calib.plausibility.rules import DIAGNOSE, require, warnings_on
from calib.run.driving_record import driving_record
from calib.run.resistance import identify as identify_resistance
from calib.run.run import Run
from calib.run.same_run import refuse_copies

_LEVEL = "level_changed"
_SWAPPED = "axles_swapped"  # eta changes in the wrong direction
_EXPLAINABLE = (
    *("a_x_scale", "a_x_against_v", "a_x_offset", "unexplained_drag", "unexplained_braking_force"),
    *("braking_force_missing", "pressure_lag", "force_step", _SWAPPED, _LEVEL),
)
"""Codes of warnings that effects, pads or roads cause as well as mistakes do. A diagnosis that
explains the logs has named their cause, so these warnings are not given."""
_FITTED = 3  # number of promises that are fitted to logs with exchanged axles
LARGEST_DIFFERENCE, USUAL_DIFFERENCE = 5e-3, 1e-3
"""Differences of left and right radii [1] up to which the wheel speeds are made equal: one new tyre
makes 5e-3, tyres of one age 1e-3. A brake that drags on one wheel looks like 1e-3 to 8e-3."""


def checked(
    vehicle: Vehicle, calibration: Sequence[Log], holdout: Sequence[Log]
) -> tuple[PlausibilityWarning, ...]:
    """Return the warnings on all logs, in the order of the logs, as if nothing explained them.

    Raises LogError for a mistake that makes a search meaningless, and ModelError if a known effect
    cannot be taken out of a log.
    """
    if not holdout:
        raise LogError("no hold-out log", expected="--holdout LOG...", do="keep two stops back")
    if len(calibration) < 2:
        expected = "two or more that differ: a coast, a ramp, stops at other pressures and heats"
        raise LogError(f"{len(calibration)} calibration log", expected=expected)
    if max(float(np.max(log["p_mc"])) for log in calibration) < 5e5:
        expected = "pressure above 5 bar in at least one"
        raise LogError("nothing is braked in the calibration logs", expected=expected)
    refuse_copies(calibration, holdout)
    runs = [Run(log, vehicle) for log in (*calibration, *holdout)]
    for run in runs:
        require(run, DIAGNOSE)
    evidence_of_runs = _evidence_of(runs)
    for evidence in evidence_of_runs:
        refused = warnings_on(evidence, DIAGNOSE, (REFUSE,))
        if refused:
            raise LogError(refused[0].text, where=evidence.run.log.source)
    return tuple(warning for e in evidence_of_runs for warning in warnings_on(e, DIAGNOSE))


def unexplained_warnings(
    warnings: Sequence[PlausibilityWarning], *, unexplained: bool, grouped: bool
) -> tuple[PlausibilityWarning, ...]:
    """Return the warnings that the result does not explain.

    ``unexplained`` says whether something significant is left. ``grouped`` says whether logs differ
    in a group of random effects, such as pads: a wrong pressure of a log looks like that.
    """
    if unexplained:
        return tuple(warnings)
    explained = [code for code in _EXPLAINABLE if code != _LEVEL or not grouped]
    return tuple(warning for warning in warnings if warning.code not in explained)


def _evidence_of(runs: Sequence[Run]) -> list[Evidence]:
    """Evidence of the runs, with the drag and rolling resistance of the runs without braking."""
    coasts = (run for run in runs if not run.events)
    resistance = identify_resistance(runs[0].car, ((run.blocks, run.noise.z) for run in coasts))
    responses = [run.response(resistance.effects) for run in runs]
    evidence = []
    for i, (run, response) in enumerate(zip(runs, responses, strict=True)):
        others = [*responses[:i], *responses[i + 1 :]]
        levels = [other.level for other in others if other is not None]
        evidence.append(Evidence(run, run.accelerometer(resistance), response, levels=levels))
    return evidence


def require_right_axles(
    search: Search, logs: Sequence[Log], warnings: Sequence[PlausibilityWarning]
) -> None:
    """Raise LogError if front and rear wheel speeds are swapped in some or all ``logs``.

    By the ``warnings`` a log is suspected if its rear wheels slip more. Either the axles are
    swapped, or something brakes the rear wheels, such as a motor. The more probable case is
    believed: the logs as recorded, with the best fit of the ``search``, or the logs with the axles
    exchanged in the suspected or in all of them, with the best of a few fits.
    """
    suspected = {warning.log: warning for warning in warnings if warning.code == _SWAPPED}
    if not suspected:
        return
    all_exchanged = [_exchanged(log) for log in logs]
    some_exchanged = [_exchanged(log) if log.name in suspected else log for log in logs]
    as_recorded = search.fits.evidence_of_all(search.best)
    if any(_evidence(search.problem, x) > as_recorded for x in (some_exchanged, all_exchanged)):
        sources = [log.source for log in logs if log.name in suspected]
        raise LogError(next(iter(suspected.values())).text, where=", ".join(sources))


def _evidence(recorded: Problem, logs: Sequence[Log]) -> float:
    """ln of the evidence of other logs with the same noise, by the best of a few fits."""
    runs = with_ripple_phase(recorded.vehicle, [run_of(log) for log in logs], recorded.noise)
    problem = replace(recorded, runs=runs)
    fits = Fits(problem, holdouts=problem)  # the hold-outs are not asked
    fits.best_of(promises(fits.base, trials(fits.base))[:_FITTED], fits.base)
    return max(fit.log_evidence for fit in fits.fitted.values())


def _exchanged(log: Log) -> Log:
    pairs = (("fl", "rl"), ("fr", "rr"), ("rl", "fl"), ("rr", "fr"))
    exchanged = {f"omega_{wheel}": log[f"omega_{other}"] for wheel, other in pairs}
    return replace(log, channels=log.channels | exchanged)


def with_even_sides(logs: Sequence[Log], largest: float) -> tuple[list[Log], float]:
    """Return the logs with equal mean left and right wheel speeds of each axle while unbraked.

    Left and right radii differ by ten times what a speed sensor shows over a log, which would hide
    every other effect. All logs, of one car with one set of tyres, give one ratio for each axle. An
    axle stays as it is if its sides differ by more than ``largest`` [1], since a brake that drags
    on one wheel looks alike. Also return the largest difference that was taken out [1].
    """
    rolling = [driving_record(log).unbraked for log in logs]
    even, taken_out = list(logs), 0.0
    for axle in AXLES:
        left, right = (_angle(logs, rolling, f"omega_{axle}{side}") for side in "lr")
        if 0.0 < abs(right - left) <= largest * left:
            taken_out = max(taken_out, abs(right / left - 1.0))
            even = [_scaled(log, axle, np.sqrt(right / left)) for log in even]
    return even, taken_out


def _angle(logs: Sequence[Log], rolling: Sequence[Mask], channel: str) -> float:
    """Angle that a wheel turns while unbraked, in all logs [rad]."""
    return sum(
        log.sample_time * float(np.sum(log[channel][unbraked]))
        for log, unbraked in zip(logs, rolling, strict=True)
    )


def _scaled(log: Log, axle: str, factor: float) -> Log:
    """Return the log with the left wheel speed times, the right wheel speed over ``factor``."""
    left, right = f"omega_{axle}l", f"omega_{axle}r"
    even = {left: log[left] * factor, right: log[right] / factor}
    return replace(log, channels=log.channels | even)
