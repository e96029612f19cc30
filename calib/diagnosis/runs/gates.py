"""Requirements on the logs of a diagnosis: mistakes are refused before anything is searched.

A mistake made while logs are recorded or named looks like an effect that nobody knows. What `check`
and `fit` refuse is refused here, too, in their words; besides, what only shows between logs: a
hold-out that is a copy, and a pressure that is not that of its run.
"""

from collections.abc import Iterable, Sequence

import numpy as np

from calib.base.errors import LogError
from calib.base.warning import PlausibilityWarning
from calib.car.vehicle import Vehicle
from calib.diagnosis.runs.judged import JudgedLog
from calib.logs.log import Log
from calib.run.axle_signals import signals
from calib.run.gates import require_same_wheels
from calib.run.observation import observe
from calib.run.rules import problems

_STRONGER = 2.5
"""Brakes of a log over those of the others [1], or the inverse, that no pads make: soaked ones
lose half, and the effects of the catalogue, three at a time, moved a log by 1.6 at most."""


def require_enough(calibration: Sequence[Log], holdout: Sequence[Log]) -> None:
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


def require_right_channels(vehicle: Vehicle, logs: Sequence[Log]) -> None:
    """Raise LogError for a log with channels that are wrong, or one of another car."""
    for log in logs:
        reasons = problems(observe(log), "search")
        if reasons:
            raise LogError(
                "this run will not do for a diagnosis: " + "; ".join(reasons),
                where=log.source,
                do="see `brake-cal check`",
            )
        require_same_wheels(vehicle, log, signals(log, vehicle))


def require_own_pressure(judged: Sequence[JudgedLog]) -> None:
    """Raise LogError for a log whose brakes act much stronger or weaker than those of the others.

    With fewer than three braked logs nobody knows which one is wrong, and nothing is refused.
    """
    for one in judged:
        level = one.over_others(judged)
        if level is not None and not 1.0 / _STRONGER < level < _STRONGER:
            raise LogError(
                f"its brakes act {level:.2g} times as strongly on p_mc as those of the other logs",
                where=one.log.source,
                expected=f"{1.0 / _STRONGER:g} to {_STRONGER:g}; pads that are soaked lose half",
                do="look for a pressure of another run, or another scale of p_mc or a_x in this "
                "log",
            )


def require_whole_wheel_speeds(warnings: Iterable[PlausibilityWarning]) -> None:
    """Raise LogError where a wheel speed loses pulses: its mean looks like another radius."""
    for warning in warnings:
        if warning.code == "lost_pulses":
            raise LogError(
                f"{warning.causes[0]}, in {100.0 * warning.measured:.1f} % of the samples",
                where=warning.log,
                expected=f"{warning.bounds}, as a share",
                do=warning.do,
            )
