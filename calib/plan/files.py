"""The files of a plan: its JSON document, and the pressure of each ramp over time."""

from collections.abc import Iterator
from typing import Any

from calib.base.units import BAR
from calib.plan.measure import pressure_trace
from calib.plan.search import Plan


def document(plan: Plan) -> dict[str, Any]:
    """Return the JSON document; half widths are relative [1], infinite if nothing is known."""
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
    """Return the name of the pressure file of each step; None for a step without a pressure."""
    measures = [step.measure for step in plan.steps]
    return [f"{i}_{m.name}.csv" if m.kind == "ramp" else None for i, m in enumerate(measures, 1)]


def pressure_files(plan: Plan) -> Iterator[tuple[str, bytes]]:
    """Yield name and content of each pressure file: p_mc over time, at `RATE`."""
    for step, file in zip(plan.steps, _files(plan), strict=True):
        if file is not None:
            time, pressure = pressure_trace(plan.prior.vehicle, step.measure)
            lines = (f"{t:.2f},{p / BAR:.3f}" for t, p in zip(time, pressure, strict=True))
            yield file, "\n".join(["time [s],p_mc [bar]", *lines, ""]).encode()
