"""Compare the half widths that a fit achieved with those of its plan.

This file imports nothing that makes a plan, so that `fit` starts quickly.
"""

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from calib.base.bounded import VALIDATION, read_bounded
from calib.base.errors import InputError
from calib.base.intervals import Z95
from calib.car.mass import MassUsed
from calib.logs.log import Log
from calib.run.run import Run
from calib.table.table import Table

DOCUMENT = "plan.json"  # file name of a plan in a folder
_WIDER = 1.15  # largest half width over the planned one [1]: plans err by 15 %
_SHORT = 0.9  # least end of a ramp over the planned end [1]


class HalfWidths(NamedTuple):
    """Relative half width of the 95 % interval [1] of the torque of front, rear and both axles."""

    front: float = 0.0
    rear: float = 0.0
    total: float = 0.0


def widths_of(table: Table) -> HalfWidths:
    """Return the half widths of the pad frictions and of the pad level of a table."""
    pads = table.calibration
    axles = (pads.pad_friction_f, pads.pad_friction_r)
    front, rear = (Z95 * pad.sigma / pad.value for pad in axles)
    return HalfWidths(front, rear, Z95 * math.sqrt(sum(table.budget.level.values())))  # variances


@dataclass(frozen=True)
class PlannedRuns:
    """A plan as a fit reads it."""

    steps: tuple[str, ...]  # names of the measures
    end: float  # largest deceleration of the ramps [g]
    sensors: frozenset[str]  # optional channels
    after: HalfWidths  # at the end of the plan


def read_plan(path: Path) -> PlannedRuns:
    """Read the file of a plan. Raises InputError for another file."""
    try:
        document = json.loads(read_bounded(path, VALIDATION))
        steps = document["steps"]
        ends = [float(step["end"]) for step in steps if step["measure"].startswith("ramp")]
        after = [document["after"][name] for name in HalfWidths._fields]
        return PlannedRuns(
            steps=tuple(str(step["measure"]) for step in steps),
            end=max(ends, default=0.0),
            sensors=frozenset(map(str, document["sensors"])),
            after=HalfWidths(*(math.inf if width is None else float(width) for width in after)),
        )
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        expected = f"the {DOCUMENT} of `brake-cal plan --out DIR`"
        raise InputError("is no plan", where=path, expected=expected) from error


class Achieved(NamedTuple):
    """Planned and achieved half widths [1]."""

    planned: HalfWidths
    achieved: HalfWidths
    reached: bool  # whether no half width is above `_WIDER` times the planned one
    reasons: tuple[str, ...]  # what the plan has and the fit has not


def compare(plan: PlannedRuns, table: Table, logs: Sequence[Log], mass: MassUsed) -> Achieved:
    """Compare a plan with the ``table``, the ``logs`` and the ``mass`` of a fit."""
    achieved = widths_of(table)
    pairs = zip(achieved, plan.after, strict=True)
    reached = all(width <= _WIDER * planned for width, planned in pairs)
    return Achieved(plan.after, achieved, reached, tuple(_reasons(plan, table, logs, mass)))


def _reasons(plan: PlannedRuns, table: Table, logs: Sequence[Log], mass: MassUsed) -> list[str]:
    roles = {log.role for log in table.provenance.logs}
    axles_alone = {Run(log, table.vehicle).alone for log in logs}
    was_done = {
        "weighing": mass.stated,
        "rollers": "bench" in roles,
        "coast": "coast" in roles,
        "rear_alone": "r" in axles_alone,
        "front_alone": "f" in axles_alone,
    }
    reasons = [f"{step} is missing" for step in plan.steps if not was_done.get(step, True)]
    end = table.quality["deceleration_max"]
    if end < _SHORT * plan.end:
        reasons.append(f"the ramps end at {end:.2f} g, planned was {plan.end:.2f} g")
    if "v" in plan.sensors and not any("v" in log for log in logs):
        reasons.append("no log has the speed v")
    return reasons


def document(achieved: Achieved) -> dict[str, object]:
    """Return the comparison as a JSON document."""
    widths = {"planned": achieved.planned._asdict(), "achieved": achieved.achieved._asdict()}
    return {**widths, "reached": achieved.reached, "reasons": list(achieved.reasons)}
