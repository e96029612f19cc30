"""The logs of a diagnosis: judged and refused or warned of, their sides made even.

A mistake made while logs are recorded or named looks like an effect that nobody knows. What `check`
and `fit` refuse is refused here, too, in their words; besides, what only shows between logs: a
hold-out that is a copy, a pressure that is not that of its run, and wheel speeds of front and rear
axle that are swapped.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from calib.base.errors import LogError
from calib.base.names import AXLES
from calib.base.warning import REFUSE, PlausibilityWarning
from calib.car.vehicle import Vehicle
from calib.diagnosis.explanation.predict import run_of
from calib.diagnosis.explanation.problem import Problem, turned
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
_SWAPPED = "axles_swapped"  # eta goes the wrong way
_SEARCHED = (
    *("a_x_scale", "a_x_against_v", "a_x_offset", "unexplained_drag", "unexplained_braking_force"),
    *("braking_force_missing", "pressure_lag", "force_step", _SWAPPED, _LEVEL),
)
"""Codes of what effects, pads or roads make as well as mistakes do. Where the diagnosis explains
the logs, it has named their cause, and nothing is warned of."""

_FITTED = 3  # fits of logs with exchanged axles

# Largest difference of the radii of both sides [1] that is taken out of the wheel speeds.
LARGEST = 5e-3  # one new tyre makes that
USUAL = 1e-3  # tyres of one age do, where a seized brake (0.001 to 0.008) may be hidden


def checked(
    vehicle: Vehicle, calibration: Sequence[Log], holdout: Sequence[Log]
) -> tuple[PlausibilityWarning, ...]:
    """Warnings on every log, in their order, also of what the search may explain.

    Raises LogError for a mistake that makes a search meaningless, and ModelError when a known
    effect cannot be taken out of a log.
    """
    if not holdout:
        raise LogError("no hold-out log", expected="--holdout LOG...", do="keep two stops back")
    if len(calibration) < 2:
        raise LogError(
            f"{len(calibration)} calibration log",
            expected="two or more that differ: a coast, a ramp, stops at other pressures and heats",
        )
    if max(float(np.max(log["p_mc"])) for log in calibration) < 5e5:
        raise LogError(
            "nothing is braked in the calibration logs",
            expected="pressure above 5 bar in at least one",
        )
    refuse_copies(calibration, holdout)
    runs = [Run(log, vehicle) for log in (*calibration, *holdout)]
    for run in runs:
        require(run, DIAGNOSE)
    evidence = _evidence_of(runs)
    for one in evidence:
        if refused := warnings_on(one, DIAGNOSE, (REFUSE,)):
            raise LogError(refused[0].text, where=one.run.log.source)
    return tuple(warning for one in evidence for warning in warnings_on(one, DIAGNOSE))


def unexplained_warnings(
    warnings: Sequence[PlausibilityWarning], *, unexplained: bool, grouped: bool
) -> tuple[PlausibilityWarning, ...]:
    """The warnings that the result does not explain.

    ``unexplained`` whether something significant is left; ``grouped`` whether single
    logs have pads or a road of their own in the result; a wrong pressure of a log looks like that.
    """
    explained = () if unexplained else tuple(c for c in _SEARCHED if c != _LEVEL or not grouped)
    return tuple(warning for warning in warnings if warning.code not in explained)


def _evidence_of(runs: Sequence[Run]) -> list[Evidence]:
    """The runs, with drag and rolling resistance of those without braking."""
    coasts = (run for run in runs if not run.events)
    resistance = identify_resistance(runs[0].car, ((run.blocks, run.noise.z) for run in coasts))
    responses = [run.response(resistance.effects) for run in runs]
    return [
        Evidence(
            run,
            run.accelerometer(resistance),
            response,
            levels=[one.level for one in (*responses[:i], *responses[i + 1 :]) if one],
        )
        for i, (run, response) in enumerate(zip(runs, responses, strict=True))
    ]


def require_right_axles(
    search: Search, logs: Sequence[Log], warnings: Sequence[PlausibilityWarning]
) -> None:
    """Raise LogError if front and rear wheel speeds are swapped in some or all ``logs``.

    Some are those whose eta goes the wrong way by the ``warnings``; without any, nothing is tried.
    Where the rear wheels slip more, axles are swapped, or something brakes the rear wheels, such as
    a motor. The more probable one is believed: the logs as given, by what a search found, or with
    their axles exchanged, by the best of a few effects of the first ranking, or of none.
    """
    swapped = {one.log: one for one in warnings if one.code == _SWAPPED}
    if not swapped:
        return
    every = [_exchanged(log) for log in logs]
    some = [b if b.name in swapped else a for a, b in zip(logs, every, strict=True)]
    best = search.fits.value(search.best)
    if any(_log_evidence(search.problem, others) > best for others in (some, every)):
        sources = [log.source for log in logs if log.name in swapped]
        raise LogError(next(iter(swapped.values())).text, where=", ".join(sources))


def _log_evidence(recorded: Problem, logs: Sequence[Log]) -> float:
    """ln of the evidence of other logs with the same noise, by the best of a few fits."""
    runs = turned(recorded.vehicle, [run_of(log) for log in logs], recorded.noise)
    problem = replace(recorded, runs=runs)
    fits = Fits(problem, problem)
    fits.best_of(promises(fits.base, trials(fits.base))[:_FITTED], fits.base)
    return max(one.log_evidence for one in fits.fitted.values())


def _exchanged(log: Log) -> Log:
    """The log with the wheel speeds of the other axle."""
    other = {f"omega_{a}{side}": log[f"omega_{b}{side}"] for a, b in ("fr", "rf") for side in "lr"}
    return replace(log, channels=log.channels | other)


def with_even_sides(logs: Sequence[Log], largest: float) -> tuple[list[Log], float]:
    """The logs with left and right wheel speeds of each axle equal on the mean while unbraked.

    Radii are of the day, and differ by ten times what a sensor of speed shows over a log, which
    would hide every other effect. One ratio for each axle from all logs, so they must be of one car
    with one set of tyres. An axle stays as it is where its sides differ by more than ``largest``
    [1]: a brake that drags on one wheel looks alike. Radii of the axles are not touched: their
    mismatch is an effect. Also returns the largest difference that was taken out [1].
    """
    rolling = [driving_record(log).unbraked for log in logs]
    even, taken_out = list(logs), 0.0
    for axle in AXLES:
        left, right = (
            sum(
                log.sample_time * float(np.sum(log[f"omega_{axle}{side}"][free]))
                for log, free in zip(logs, rolling, strict=True)
            )
            for side in "lr"
        )
        if 0.0 < abs(right - left) <= largest * left:
            taken_out = max(taken_out, abs(right / left - 1.0))
            even = [_scaled(log, axle, np.sqrt(right / left)) for log in even]
    return even, taken_out


def _scaled(log: Log, axle: str, factor: float) -> Log:
    left, right = f"omega_{axle}l", f"omega_{axle}r"
    even = {left: log[left] * factor, right: log[right] / factor}
    return replace(log, channels=log.channels | even)
