"""What a fit reached of its plan, and why not more; it imports nothing that makes a plan."""

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

DOCUMENT = "plan.json"
"""Name of the document of a plan in a folder."""

_WIDER = 1.15  # half width over the planned one [1] that misses it: a plan is right to 15 %
_SHORT = 0.9  # end of a ramp over the planned one [1] below which it ended early


class HalfWidths(NamedTuple):
    """Relative half width of the 95 % interval [1] of the torque of front, rear and both axles."""

    front: float = 0.0
    rear: float = 0.0
    total: float = 0.0


def widths_of(table: Table) -> HalfWidths:
    """Half widths by the pads of a table, and by the level of both axles."""
    pads = table.calibration
    axles = (pads.pad_friction_f, pads.pad_friction_r)
    front, rear = (Z95 * pad.sigma / pad.value for pad in axles)
    return HalfWidths(front, rear, Z95 * math.sqrt(sum(table.budget.level.values())))


@dataclass(frozen=True)
class PlannedRuns:
    """A plan as a fit reads it: names of its ``steps``, their largest ``end`` [g], the widths."""

    steps: tuple[str, ...]
    end: float
    sensors: frozenset[str]
    after: HalfWidths


def read_plan(path: Path) -> PlannedRuns:
    """Read the document of a plan. Raises InputError for a file that is none."""
    try:
        written = json.loads(read_bounded(path, VALIDATION))
        steps, widths = written["steps"], [written["after"][x] for x in HalfWidths._fields]
        ends = [float(step["end"]) for step in steps if step["measure"].startswith("ramp")]
        return PlannedRuns(
            steps=tuple(str(step["measure"]) for step in steps),
            end=max(ends, default=0.0),
            sensors=frozenset(map(str, written["sensors"])),
            after=HalfWidths(*(math.inf if width is None else float(width) for width in widths)),
        )
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        expected = f"the {DOCUMENT} of `brake-cal plan --out DIR`"
        raise InputError("is no plan", where=path, expected=expected) from error


class Achieved(NamedTuple):
    """Planned and achieved half widths [1], whether they were ``reached``, and reasons why not."""

    planned: HalfWidths
    achieved: HalfWidths
    reached: bool
    reasons: tuple[str, ...]


def compare(plan: PlannedRuns, table: Table, logs: Sequence[Log], mass: MassUsed) -> Achieved:
    """Compare the half widths of a table with those of a plan.

    ``logs`` and ``mass`` are those of the fit. Reasons are what the plan has and the fit has not.
    """
    achieved = widths_of(table)
    reached = all(a <= _WIDER * p for a, p in zip(achieved, plan.after, strict=True))
    return Achieved(plan.after, achieved, reached, tuple(_missing(plan, table, logs, mass)))


def _missing(plan: PlannedRuns, table: Table, logs: Sequence[Log], mass: MassUsed) -> list[str]:
    roles = {log.role for log in table.provenance.logs}
    axles = {Run(log, table.vehicle).alone for log in logs}
    happened = {
        "weighing": mass.stated,
        "rollers": "bench" in roles,
        "coast": "coast" in roles,
        "rear_alone": "r" in axles,
        "front_alone": "f" in axles,
    }
    reasons = [f"{step} is missing" for step in plan.steps if not happened.get(step, True)]
    end = table.quality["deceleration_max"]
    if end < _SHORT * plan.end:
        reasons.append(f"the ramps end at {end:.2f} g, planned was {plan.end:.2f} g")
    if "v" in plan.sensors and not any("v" in log for log in logs):
        reasons.append("no log has the speed v")
    return reasons


def document(achieved: Achieved) -> dict[str, object]:
    """The comparison as a JSON document."""
    widths = {"planned": achieved.planned._asdict(), "achieved": achieved.achieved._asdict()}
    return {**widths, "reached": achieved.reached, "reasons": list(achieved.reasons)}
