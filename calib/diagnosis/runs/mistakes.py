"""Mistakes in the logs of a diagnosis: refused before anything is searched, or warned of.

A mistake made while logs are recorded or named looks like an effect that nobody knows. What `check`
and `fit` refuse is refused here, too, in their words; besides, what only shows between logs: a
hold-out that is a copy, and a pressure that is not that of its run.
"""

import math
from collections.abc import Iterator, Sequence
from statistics import median

import numpy as np

from calib.base.errors import LogError
from calib.base.warning import PlausibilityWarning
from calib.car.vehicle import Vehicle
from calib.diagnosis.runs.axles import SWAPPED
from calib.logs.log import Log
from calib.plausibility.pads import LOADED
from calib.plausibility.run import NO_SPEED, run_warnings
from calib.run.brake_response import BrakeResponse
from calib.run.gates import refuse_copies, require_same_wheels
from calib.run.resistance import identify as identify_resistance
from calib.run.rules import problems
from calib.run.run import Run
from calib.run.warnings import locked_wheels, saturated, swapped_axles

LEVEL = "level_changed"

SEARCHED = (
    "a_x_scale",
    "a_x_against_v",
    "a_x_offset",
    "unexplained_drag",
    "unexplained_braking_force",
    "braking_force_missing",
    "pressure_lag",
    "force_step",
    SWAPPED,
    LEVEL,
)
"""Codes of what effects, pads or roads make as well as mistakes do. Where the diagnosis explains
the logs, it has named their cause, and nothing is warned of."""

REFUSED = (*NO_SPEED, "lost_pulses")  # the mean of a wheel that loses pulses is another radius
_STRONGER = 2.5
"""Brakes of a log over those of the others [1], or the inverse, that no pads make: soaked ones
lose half, and the effects of the catalogue, three at a time, moved a log by 1.6 at most."""


def checked(
    vehicle: Vehicle, calibration: Sequence[Log], holdout: Sequence[Log]
) -> tuple[PlausibilityWarning, ...]:
    """Warnings on every log, in their order, also of what the search may explain.

    Raises LogError for a mistake that must not be searched in, and ModelError when a known effect
    cannot be taken out of a log.
    """
    logs = [*calibration, *holdout]
    _require_enough(calibration, holdout)
    refuse_copies(calibration, holdout)
    runs = [Run(log, vehicle) for log in logs]
    for run in runs:
        if reasons := problems(run, "search"):
            raise LogError(
                "this run will not do for a diagnosis: " + "; ".join(reasons),
                where=run.log.source,
                do="see `brake-cal check`",
            )
        require_same_wheels(run)
    sources = {log.name: log.source for log in logs}
    warnings = tuple(_warnings_of(runs))
    for one in warnings:
        stronger = one.code == LEVEL and abs(math.log1p(one.measured)) > math.log(_STRONGER)
        if stronger or one.code in REFUSED:
            raise LogError(one.text, where=sources[one.log])
    return warnings


def unexplained_warnings(
    warnings: Sequence[PlausibilityWarning], *, left: bool, grouped: bool
) -> tuple[PlausibilityWarning, ...]:
    """The warnings that the result does not explain.

    ``left`` whether something significant is left unexplained; ``grouped`` whether the logs have
    pads or roads of their own, which may be mistakes in their pressure.
    """
    explained = () if left else tuple(c for c in SEARCHED if c != LEVEL or not grouped)
    return tuple(warning for warning in warnings if warning.code not in explained)


def _require_enough(calibration: Sequence[Log], holdout: Sequence[Log]) -> None:
    """Raise LogError without a hold-out, without two calibration logs, or if nothing is braked."""
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


def _warnings_of(runs: Sequence[Run]) -> Iterator[PlausibilityWarning]:
    """Of logs without the effects that the vehicle file knows.

    Drag and rolling resistance are those of the logs without braking.
    """
    coasts = (run for run in runs if not run.events)
    known = identify_resistance(runs[0].car, ((run.blocks, run.noise.z) for run in coasts))
    responses = [run.response(known.effects) for run in runs]
    for i, (run, response) in enumerate(zip(runs, responses, strict=True)):
        yield from run_warnings(run, run.car, run.accelerometer(known), response)
        for rule in (swapped_axles, locked_wheels, saturated):
            yield from rule(run.log.name, run)
        yield from _level(run.log.name, response, [*responses[:i], *responses[i + 1 :]])


def _level(
    log: str, response: BrakeResponse | None, of_others: Sequence[BrakeResponse | None]
) -> Iterator[PlausibilityWarning]:
    """Brakes that are not those of the other logs.

    With fewer than two others that are braked nobody knows which one is wrong.
    """
    others = [one.level for one in of_others if one]
    if response is None or len(others) < 2:
        return
    level = response.level / median(others)
    if abs(math.log(level)) >= LOADED:
        yield PlausibilityWarning(
            LEVEL,
            log,
            level - 1.0,
            (math.expm1(-LOADED), math.expm1(LOADED)),
            (
                "p_mc of another run",
                "the scale or the zero of p_mc or a_x in this log",
                "pads that were wet or hot in this log",
            ),
            "compare p_mc and a_x of this log with those of the others; leave it out if the pads "
            "were not as usual",
        )
