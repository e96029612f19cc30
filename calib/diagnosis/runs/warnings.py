"""What speaks against the logs of a diagnosis, although it is made."""

import math
from collections.abc import Iterator, Sequence

from calib.base.warning import PlausibilityWarning
from calib.diagnosis.runs.judged import JudgedLog
from calib.model.sensors import judge_accelerometer
from calib.plausibility.pads import LOADED
from calib.plausibility.run import run_warnings
from calib.run.observation import observe
from calib.run.warnings import locked_wheels, saturated, swapped_axles

SEARCHED = (
    "a_x_scale",
    "a_x_against_v",
    "a_x_offset",
    "unexplained_drag",
    "unexplained_braking_force",
    "braking_force_missing",
    "pressure_lag",
    "force_step",
    "axles_swapped",
    "level_changed",
)
"""Codes of what effects, pads or roads make as well as mistakes do. Where the diagnosis explains
the logs, it has named their cause, and nothing is warned of."""


def log_warnings(judged: Sequence[JudgedLog]) -> tuple[PlausibilityWarning, ...]:
    """Warnings on every log, in their order, also of what the search may explain."""
    return tuple(warning for one in judged for warning in _of_log(one, judged))


def unexplained_warnings(
    warnings: Sequence[PlausibilityWarning], *, left: bool, grouped: bool
) -> tuple[PlausibilityWarning, ...]:
    """The warnings that the result does not explain.

    ``left`` whether something significant is left unexplained; ``grouped`` whether the logs have
    pads or roads of their own, which may be mistakes in their pressure.
    """
    explained = () if left else tuple(c for c in SEARCHED if c != "level_changed" or not grouped)
    return tuple(warning for warning in warnings if warning.code not in explained)


def _of_log(one: JudgedLog, judged: Sequence[JudgedLog]) -> Iterator[PlausibilityWarning]:
    sensor = judge_accelerometer(one.vehicle, one.known, one.blocks, one.noise)
    yield from run_warnings(one.log, one.signals, one.vehicle, sensor, one.response)
    seen = observe(one.log, full=False)
    yield from swapped_axles(one.log.name, seen)
    yield from locked_wheels(one.log.name, seen)
    yield from saturated(one.log.name, seen)
    yield from _level(one, judged)


def _level(one: JudgedLog, judged: Sequence[JudgedLog]) -> Iterator[PlausibilityWarning]:
    """Brakes that are not those of the other logs."""
    level = one.over_others(judged)
    if level is None or abs(math.log(level)) < LOADED:
        return
    yield PlausibilityWarning(
        "level_changed",
        one.log.name,
        level - 1.0,
        (math.expm1(-LOADED), math.expm1(LOADED)),
        (
            "p_mc of another run",
            "the scale or the zero of p_mc or a_x in this log",
            "pads that were wet or hot in this log",
        ),
        "compare p_mc and a_x of this log with those of the others; leave it out if the pads were "
        "not as usual",
    )
