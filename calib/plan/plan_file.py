"""A plan as a document, and its runs as pressure over time for a robot."""

import json
import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from calib.base.bounded import VALIDATION, read_bounded
from calib.base.errors import InputError
from calib.plan.expected import HalfWidths
from calib.plan.measure import pressure_trace
from calib.plan.search import Plan

DOCUMENT = "plan.json"
"""Name of the document in a folder."""

_BAR = 1e5


def document(plan: Plan) -> dict[str, Any]:
    """The plan as a JSON document: half widths are relative [1], infinite if nothing is known."""
    track = plan.prior.track
    return {
        "vehicle": plan.prior.vehicle.name,
        "track": {"length": track.length, "speed": track.speed},
        "sensors": sorted(plan.prior.sensors),
        "noise": {name: level.sd for name, level in sorted(plan.prior.noise.items())},
        "want": {**plan.want.widths._asdict(), "seconds": plan.want.seconds},
        "before": plan.start._asdict(),
        "steps": [
            {
                "measure": step.measure.name,
                "text": step.measure.text,
                "driver": step.measure.driver,
                "seconds": step.seconds,
                "end": step.measure.end,
                "file": file,
                "half_width": step.widths._asdict(),
            }
            for step, file in zip(plan.steps, _files(plan), strict=True)
        ],
        "after": plan.after._asdict(),
        "seconds": plan.seconds,
        "met": plan.want.met_by(plan.after),
        "with_v": None if plan.with_speed is None else plan.with_speed._asdict(),
        "floor": plan.floor._asdict(),
        "floor_of_runs": plan.floor_of_runs._asdict(),
        "not_worth": {m.name: gain for m, gain in plan.not_worth.items()},
        "impossible": {m.name: reason for m, reason in plan.impossible.items()},
    }


def _files(plan: Plan) -> list[str | None]:
    """Name of the file with the pressure of each step, None for one without a pressure."""
    measures = [step.measure for step in plan.steps]
    return [f"{i}_{m.name}.csv" if m.kind == "ramp" else None for i, m in enumerate(measures, 1)]


def pressure_files(plan: Plan) -> Iterator[tuple[str, bytes]]:
    """Name and content of each file of pressure over time, of p_mc, every 10 ms."""
    for step, file in zip(plan.steps, _files(plan), strict=True):
        if file is not None:
            time, pressure = pressure_trace(plan.prior.vehicle, step.measure)
            lines = (f"{t:.2f},{p / _BAR:.3f}" for t, p in zip(time, pressure, strict=True))
            yield file, "\n".join(["time [s],p_mc [bar]", *lines, ""]).encode()


@dataclass(frozen=True)
class PlannedRuns:
    """What a fit asks of a plan: its ``steps`` by name, their largest ``end`` [g], the widths."""

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
