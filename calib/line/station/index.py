"""Find the runs below a folder, for the index page on the operator's screen.

A run is a folder with a station.json or a refused.json. Where both files stand, the refusal is the
newer one and counts. Folders inside a run are not searched.
"""

import json
import os
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

from calib.base.bounded import VALIDATION, read_bounded
from calib.base.errors import printable
from calib.line.station.files import DOCUMENT, REFUSED

INDEX, LIVE = "index.html", "live.html"  # the page, and a copy that reloads itself
UNREADABLE = "not readable"  # verdict of a run whose station.json or refused.json is damaged
NO_VERDICT = "refused"  # verdict of a car that could not be judged


@dataclass(frozen=True)
class IndexedRun:
    """One run as the index shows it."""

    place: str  # folder of the run, relative to that of the index
    written_at: float  # time of the verdict [s since 1970]
    verdict: str
    car: str = ""
    station: str = ""
    bad: int = 0  # number of checks and warnings that speak against the car
    worst: tuple[str, str, float | None, str] | None = None  # metric, scope, value, next step
    trend: dict[str, float | None] | None = None  # the metrics `TRENDS` by name
    limits: dict[str, tuple[float | None, float | None]] | None = None  # of `trend`: low, high
    refusal: str = ""  # reason why the car could not be judged


TRENDS = ("torque_per_bar_f", "torque_per_bar_r", "pad_scale", "ramp_eta_zero")
"""Metrics of the ramp, of which the index shows the trend over the cars."""


def runs_below(folder: Path) -> list[IndexedRun]:
    """Return all runs below ``folder``, the last first. Raises OSError if it cannot be read."""
    indexed = []
    for path in _documents(folder):
        with suppress(FileNotFoundError):  # the run is just being replaced
            place = printable(os.path.relpath(path.parent, folder))
            indexed.append(_run(path, place, path.stat().st_mtime))
    return sorted(indexed, key=lambda run: (-run.written_at, run.place))


def _documents(folder: Path) -> Iterator[Path]:
    """Yield the document of every run below ``folder``, but not in hidden folders."""
    os.scandir(folder).close()  # raises OSError; `os.walk` leaves out what it cannot read
    for place, folders, files in os.walk(folder):
        document = next((name for name in (REFUSED, DOCUMENT) if name in files), None)
        if document is not None:
            yield Path(place, document)
            folders.clear()
        folders[:] = sorted(name for name in folders if not name.startswith("."))


def _run(path: Path, place: str, written_at: float) -> IndexedRun:
    """Read the document of a run; the verdict is `UNREADABLE` if the document is damaged."""
    try:
        document = json.loads(read_bounded(path, VALIDATION))
        identity = document["identity"]
        car = str(identity.get("vin") or identity.get("serial") or document.get("vehicle", ""))
        run = IndexedRun(place, written_at, NO_VERDICT, car, str(identity.get("station", "")))
        if path.name == REFUSED:
            return replace(run, bad=1, refusal=str(document["error"]["message"]))
        checks = document["checks"]
        metrics = document["figures"] | document.get("pads_of_ramp", {})
        words = "failed", "warning"
        bad = [check for word in words for check in checks if check["verdict"] == word]
        reasons = [(c["figure"], c["scope"], c["value"], c["action"] or "") for c in bad]
        return replace(
            run,
            verdict=str(document["verdict"]),
            bad=len(bad) + len(document["warnings"]),
            worst=reasons[0] if reasons else None,
            trend={name: metrics.get(name) for name in TRENDS},
            limits={c["figure"]: tuple(c["fail"]) for c in checks if c["figure"] in TRENDS},
        )
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return IndexedRun(place, written_at, UNREADABLE)
