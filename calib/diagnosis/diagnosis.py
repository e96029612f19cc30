"""The result of a diagnosis, and how it is written: a JSON document, and a folder.

DIR/diagnosis.json  model.toml  report.html  sim/before/<log>.csv  sim/after/<log>.csv
"""

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, is_dataclass, replace
from pathlib import Path
from typing import Any

from calib.base.viewable import Viewable
from calib.base.warning import PlausibilityWarning
from calib.base.write import publish, work_folder, write_whole
from calib.car.model import Model
from calib.diagnosis.replays import CHANNELS, UNITS, Gap
from calib.diagnosis.verdict import Unexplained
from calib.logs.log import Log
from calib.logs.write import write_csv

_DOCUMENT, _MODEL, _REPORT = "diagnosis.json", "model.toml", "report.html"
_RANGE_UNITS = {"pressure": "Pa", "speed": "m/s", "temperature": "degC"}  # by field of a record


@dataclass(frozen=True)
class ParameterEstimate:
    """Value of a parameter in ``unit`` and its 95 % interval, cut off at the limits of the card."""

    value: float
    unit: str
    ci95: tuple[float, float]


@dataclass(frozen=True)
class Where:
    """Where an effect acts: the channel that shows it most, axle, and ranges of drivers, SI."""

    channel: str
    axle: str
    pressure: tuple[float, float]
    speed: tuple[float, float]
    temperature: tuple[float, float] | None


@dataclass(frozen=True)
class Evidence:
    """Rise of the mean squared innovation if an effect is left out, all else unchanged [1]."""

    innovation_gain: float
    innovation_gain_holdout: float


@dataclass(frozen=True)
class RunnerUp:
    """The most probable fit without an effect that is named."""

    name: str  # of its effects, with " + " between them
    innovation_gain: float  # fall of the mean squared innovation by these effects [1]


@dataclass(frozen=True)
class Named:
    """An accepted effect, with its evidence."""

    name: str
    parameters: dict[str, ParameterEstimate]
    where: Where
    evidence: Evidence
    runner_up: RunnerUp | None
    indistinguishable_from: tuple[str, ...]  # effects that fit the logs as well
    separate_by: str  # the drive that would separate these


@dataclass(frozen=True)
class Diagnosis(Viewable):
    """The result of a diagnosis; ``_before`` is without, ``_after`` with the effects."""

    verdict: str
    effects: tuple[Named, ...]
    unexplained: Unexplained | None  # None if nothing significant is left
    base: dict[str, ParameterEstimate]
    gap: Gap
    model_before: Model
    model_after: Model
    replays_before: tuple[Log, ...]  # hold-outs replayed open loop
    replays_after: tuple[Log, ...]
    measured: tuple[Log, ...]
    reduced_before: float  # mean squared innovation [1]
    reduced_after: float
    withdrawn: tuple[tuple[str, ...], ...]  # effects that do not hold on the hold-outs
    steps: tuple[tuple[str, ...], ...]  # effects that the search accepted in turn
    warnings: tuple[PlausibilityWarning, ...]  # on the logs, not explained

    def __repr__(self) -> str:
        names = ", ".join(effect.name for effect in self.effects)
        named = f"{self.verdict} {names}".strip()
        return f"Diagnosis: {named}, {self.gap.closed:.0%} of the gap closed"


def to_dict(diagnosis: Diagnosis) -> dict[str, Any]:
    """Return the document diagnosis.json; numbers that are not finite are null."""
    values = {
        "schema": 1,
        "verdict": diagnosis.verdict,
        "effects": diagnosis.effects,
        "unexplained": diagnosis.unexplained,
        "base": diagnosis.base,
        "innovation": {"before": diagnosis.reduced_before, "after": diagnosis.reduced_after},
        "steps": diagnosis.steps,
        "withdrawn": diagnosis.withdrawn,
        "gap": _gap(diagnosis.gap),
        "warnings": diagnosis.warnings,
    }
    document: dict[str, Any] = _plain(values)
    return document


def _plain(value: Any, unit: str = "") -> Any:
    """Return a value as JSON types: a record by its fields, a range with its unit."""
    if is_dataclass(value):
        value = {field.name: getattr(value, field.name) for field in fields(value)}
    if isinstance(value, Mapping):
        return {key: _plain(part, _RANGE_UNITS.get(key, "")) for key, part in value.items()}
    if isinstance(value, list | tuple):
        parts = [_plain(part) for part in value]
        return {"range": parts, "unit": unit} if unit else parts
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _gap(gap: Gap) -> dict[str, Any]:
    """The gap in units of the noise, and that of each channel in its unit."""
    channels = {}
    for channel, noise in zip(CHANNELS, gap.noise.tolist(), strict=True):
        rms_before, rms_after = gap.rms(channel=channel)
        channels[channel] = {
            "before": noise * rms_before,
            "after": noise * rms_after,
            "noise": noise,
            "closed": 1.0 - rms_after / rms_before if rms_before > 0.0 else None,
            "unit": UNITS[channel],
        }
    ends = {"before": gap.rms_before, "after": gap.rms_after, "closed": gap.closed}
    return {**ends, "by_channel": channels}


def files_of(stems: list[str]) -> list[Path]:
    """Return every file that a diagnosis with the hold-outs ``stems`` writes into its folder."""
    sims = [Path("sim", when, f"{stem}.csv") for when in ("before", "after") for stem in stems]
    return [Path(_DOCUMENT), Path(_MODEL), Path(_REPORT), *sims]


def write_folder(diagnosis: Diagnosis, report: str, out: Path) -> list[Path]:
    """Write everything to ``out``, the document last, and return the paths.

    Replays of an earlier run that are not made again are removed. Other files in ``out`` stay.
    Raises OSError if ``out`` cannot be written.
    """
    from calib.car.model_file import write_model

    document = json.dumps(to_dict(diagnosis), indent=2, allow_nan=False) + "\n"
    sims = (*diagnosis.replays_before, *diagnosis.replays_after)
    with work_folder(out) as work:
        write_whole(work / _DOCUMENT, document.encode())
        write_model(diagnosis.model_after, work / _MODEL)
        write_whole(work / _REPORT, report.encode())
        paths = files_of([sim.name for sim in diagnosis.replays_before])
        for sim, path in zip(sims, paths[-len(sims) :], strict=True):
            (work / path).parent.mkdir(parents=True, exist_ok=True)
            channels = {name: sim[name] for name in ("time", *CHANNELS)}
            write_csv(replace(sim, channels=channels, truth={}), work / path)
        return publish(work, out, _DOCUMENT, _replays)


def _replays(out: Path) -> list[str]:
    """Paths of the replays in a folder, relative to the folder."""
    return [path.relative_to(out).as_posix() for path in out.glob("sim/*/*.csv")]
