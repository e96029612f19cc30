"""Mistakes in the logs of a diagnosis: refused before anything is searched, or warned of.

A mistake made while logs are recorded or named looks like an effect that nobody knows. What `check`
and `fit` refuse is refused here, too, in their words; besides, what only shows between logs: a
hold-out that is a copy, and a pressure that is not that of its run.
"""

from collections.abc import Sequence

import numpy as np

from calib.base.errors import LogError
from calib.base.warning import REFUSE, PlausibilityWarning
from calib.car.vehicle import Vehicle
from calib.diagnosis.runs.axles import SWAPPED
from calib.logs.log import Log
from calib.plausibility.evidence import Evidence
from calib.plausibility.rules import DIAGNOSE, require, warnings_on
from calib.run.resistance import identify as identify_resistance
from calib.run.run import Run
from calib.run.same_run import refuse_copies

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
        require(run, DIAGNOSE)
    evidence = _evidence_of(runs)
    for one in evidence:
        if refused := warnings_on(one, DIAGNOSE, (REFUSE,)):
            raise LogError(refused[0].text, where=one.run.log.source)
    return tuple(warning for one in evidence for warning in warnings_on(one, DIAGNOSE))


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


def _evidence_of(runs: Sequence[Run]) -> list[Evidence]:
    """The runs, with drag and rolling resistance of those without braking."""
    coasts = (run for run in runs if not run.events)
    known = identify_resistance(runs[0].car, ((run.blocks, run.noise.z) for run in coasts))
    responses = [run.response(known.effects) for run in runs]
    return [
        Evidence(
            run,
            run.accelerometer(known),
            response,
            levels=[one.level for one in (*responses[:i], *responses[i + 1 :]) if one],
        )
        for i, (run, response) in enumerate(zip(runs, responses, strict=True))
    ]
