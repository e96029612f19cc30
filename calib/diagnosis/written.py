"""A diagnosis as it is written down: a JSON document of a fixed schema, and a folder.

DIR/diagnosis.json  model.toml  report.html  sim/before/<log>.csv  sim/after/<log>.csv
"""

import json
import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from typing import Any

from calib.base.write import publish, workshop, write_whole
from calib.car.effects.empirical import DRIVERS
from calib.diagnosis.diagnosis import Diagnosis
from calib.diagnosis.replays.gap import CHANNELS, UNITS, Gap
from calib.logs.write import write_csv

DOCUMENT, MODEL, REPORT = "diagnosis.json", "model.toml", "report.html"

# units of the fields that are ranges
_RANGES = {"pressure": "Pa", "speed": "m/s", "temperature": "degC", "time": "s"}


def to_dict(found: Diagnosis) -> dict[str, Any]:
    """The whole diagnosis, JSON-able, most of it field by field; null for what is not finite."""
    names = [effect.name for effect in found.effects]
    rest, gap = found.unexplained, found.gap
    whole = {
        "schema": 1,
        "verdict": found.verdict,
        "effects": found.effects,
        "own_effects": [
            {"name": name, "file": one.file, "sha256": one.sha256, "named": name in names}
            for name, one in found.model_after.effects.own.items()
        ],
        "known": found.model_before.vehicle.effects.parameters,
        "unexplained": rest
        and {
            **plain(rest),
            "beside": names,
            "in_model": found.model_after.effects.terms != (),
            "replays": found.left,
            "innovation": found.reduced_after if names else found.reduced_before,
            "term": plain(rest.term) | {"driver_unit": DRIVERS[rest.term.driver]},
            "runners_up": [
                {"place": place, "driver": driver, "explained": share}
                for place, driver, share in rest.runners_up
            ],
        },
        "own_states": found.own,
        "sides": found.sides,
        "confusion": found.confusion,
        "not_resolved": [drive.effect for drive in found.drives],
        "would_show": found.drives,
        "base": found.base,
        "innovation": {"before": found.reduced_before, "after": found.reduced_after},
        "noise": {"from": found.noise.source, "at_floor": found.noise.at_floor},
        "left": found.left,
        "steps": found.steps,
        "withdrawn": found.withdrawn,
        "gap": {
            **_gap(gap),
            "closed": gap.closed,
            "unit": "rms over the noise of the sensors",
            "by_log": {log: _gap(gap, log) for log in gap.logs},
        },
        "warnings": found.warnings,
    }
    return {key: plain(value) for key, value in whole.items()}


def text_of(found: Diagnosis) -> str:
    """The text of diagnosis.json."""
    return json.dumps(to_dict(found), indent=2, allow_nan=False) + "\n"


def plain(value: Any) -> Any:
    """A value as JSON types: a record by its fields, a range with its unit."""
    if is_dataclass(value):
        value = {field.name: getattr(value, field.name) for field in fields(value)}
    if isinstance(value, Mapping):
        return {
            key: {"range": plain(part), "unit": _RANGES[key]}
            if key in _RANGES and isinstance(part, tuple)
            else plain(part)
            for key, part in value.items()
        }
    if isinstance(value, list | tuple):
        return [plain(part) for part in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _gap(gap: Gap, log: str | None = None) -> dict[str, Any]:
    """The gap of one log or all, over the noise; of each channel in its unit."""
    channels = {}
    for channel, noise in zip(CHANNELS, gap.noise.tolist(), strict=True):
        before, after = gap.of(log, channel)
        channels[channel] = {
            "before": noise * before,
            "after": noise * after,
            "noise": noise,
            "closed": 1.0 - after / before if before > 0.0 else None,
            "unit": UNITS[channel],
        }
    before, after = gap.of(log)
    return {"before": before, "after": after, "by_channel": channels}


def files_of(stems: list[str]) -> list[Path]:
    """Every file that a diagnosis with these hold-outs writes, relative to its folder."""
    sims = [Path("sim", when, f"{s}.csv") for when in ("before", "after") for s in stems]
    return [Path(DOCUMENT), Path(MODEL), Path(REPORT), *sims]


def write_folder(found: Diagnosis, document: str, report: str, out: Path) -> list[Path]:
    """Write everything to ``out``, the document last, and return the paths.

    Replays of an earlier run that are not made again are removed. Other files in ``out`` stay.
    Raises OSError if ``out`` cannot be written.
    """
    from calib.car.model_file import write_model

    with workshop(out) as work:
        write_whole(work / DOCUMENT, document.encode())
        write_model(found.model_after, work / MODEL)
        write_whole(work / REPORT, report.encode())
        sims, paths = (*found.before, *found.after), files_of([sim.name for sim in found.before])
        for sim, path in zip(sims, paths[-len(sims) :], strict=True):
            (work / path).parent.mkdir(parents=True, exist_ok=True)
            told = {name: sim[name] for name in ("time", *CHANNELS)}
            write_csv(replace(sim, channels=told, truth={}), work / path)
        return publish(work, out, DOCUMENT, _replays)


def _replays(out: Path) -> list[str]:
    return [path.relative_to(out).as_posix() for path in out.glob("sim/*/*.csv")]
