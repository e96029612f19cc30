"""The index of a folder of runs: the operator's screen, last cars first.

    DIR/index.html       the page; DIR/live.html, the same, loads itself again every few seconds
    DIR/.index.json      what was read of each run, so that the next index reads new ones only

A run is a folder below DIR with a station.json, or with a refused.json, which is the newer of the
two where it is there; a run inside a run is not looked for. All three files are written whole: a
browser never sees a part.
"""

import json
import os
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from calib.base.bounded import VALIDATION, read_bounded
from calib.base.printable import printable
from calib.base.write import write_whole
from calib.line.station.files import DOCUMENT, REFUSED

INDEX, LIVE, KNOWN = "index.html", "live.html", ".index.json"
_SCHEMA = 1
UNREADABLE = "not readable"
"""Verdict of a run whose station.json or refused.json is damaged."""
NO_VERDICT = "refused"
"""Verdict of a car that could not be judged."""


@dataclass(frozen=True)
class IndexedRun:
    """One run as the index shows it.

    ``place``: its folder below DIR; ``at``: when its verdict was written [s since 1970]; ``why``:
    what failed or warned first, as (metric, stop, value, next step), empty for none; ``trend``:
    metrics over the line by name, and ``limits`` of them as (low, high); ``refusal``: why the car
    could not be judged.
    """

    place: str
    at: float
    verdict: str
    car: str = ""
    station: str = ""
    table: str = ""
    bad: int = 0
    why: tuple[str, str, float | None, str] | None = None
    trend: dict[str, float | None] | None = None
    limits: dict[str, tuple[float | None, float | None]] | None = None
    refusal: str = ""


TRENDS = ("pad_friction_f", "pad_friction_r", "pad_scale", "ramp_eta_zero")
"""Metrics of which the index shows the trend: the pads, and the zero."""


def runs_below(folder: Path) -> tuple[list[IndexedRun], bool]:
    """All runs below ``folder``, the last first, and whether any has changed since the last index.

    Those that `KNOWN` has are not read again.

    Raises OSError if ``folder`` cannot be read, and if `KNOWN` cannot be written.
    """
    known = _known(folder)
    found: dict[str, list[object]] = {}
    for path in documents(folder):
        with suppress(FileNotFoundError):  # a run that is being published again
            stat = path.stat()
            place = printable(os.path.relpath(path.parent, folder))
            stamp = [stat.st_mtime_ns, stat.st_size]
            if place in known and known[place][:2] == stamp:
                found[place] = known[place]
            else:
                found[place] = [*stamp, asdict(read_run(path, place, stat.st_mtime))]
    if found != known:
        content = {"schema": _SCHEMA, "runs": found}
        write_whole(folder / KNOWN, json.dumps(content).encode())
    runs = [IndexedRun(**entry[2]) for entry in found.values()]  # type: ignore[arg-type]
    return sorted(runs, key=lambda run: (-run.at, run.place)), found != known


def documents(folder: Path) -> Iterator[Path]:
    """What every run below ``folder`` wrote, hidden folders left out. Raises OSError."""

    def fail(error: OSError) -> None:
        if Path(error.filename) == folder:
            raise error

    for place, folders, files in os.walk(folder, onerror=fail):
        told = next((name for name in (REFUSED, DOCUMENT) if name in files), None)
        if told is not None:
            yield Path(place, told)
            folders.clear()
        folders[:] = sorted(name for name in folders if not name.startswith("."))


def read_run(path: Path, place: str, at: float) -> IndexedRun:
    """One run from what it wrote; if that is damaged, its verdict is `UNREADABLE`."""
    try:
        told = json.loads(read_bounded(path, VALIDATION))
        identity = told["identity"]
        car = str(identity.get("vin") or identity.get("serial") or "")
        station = str(identity.get("station", ""))
        if path.name == REFUSED:
            why = str(told["error"]["message"])
            return IndexedRun(place, at, NO_VERDICT, car, station, bad=1, refusal=why)
        return _judged(told, place, at, car, station)
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return IndexedRun(place, at, UNREADABLE)


def _judged(told: dict[str, Any], place: str, at: float, car: str, station: str) -> IndexedRun:
    checks = told["checks"]
    bad = [c for word in ("failed", "warning") for c in checks if c["verdict"] == word]
    first = bad[0] if bad else None
    return IndexedRun(
        place,
        at,
        str(told["verdict"]),
        car or str(told["vehicle"]),
        station,
        str(told["table"]["id"]),
        len(bad) + len(told["warnings"]),
        first and (first["figure"], first["scope"], first["value"], first["action"] or ""),
        {name: _trend(told, name) for name in TRENDS},
        {c["figure"]: tuple(c["fail"]) for c in checks if c["figure"] in TRENDS},
    )


def _trend(told: dict[str, Any], name: str) -> float | None:
    """Of the car; where it has none, the mean over the stops."""
    value: float | None = told["figures"].get(name)
    stops = [log["figures"].get(name) for log in told["validation"]["logs"]]
    known = [x for x in stops if x is not None]
    return sum(known) / len(known) if value is None and known else value


def _known(folder: Path) -> dict[str, list[object]]:
    """What an earlier index has read; nothing if it is damaged or of another version."""
    with suppress(OSError, ValueError, LookupError, TypeError, RecursionError):
        told = json.loads((folder / KNOWN).read_bytes())
        if told["schema"] == _SCHEMA:
            runs: dict[str, list[object]] = {
                place: entry for place, entry in told["runs"].items() if IndexedRun(**entry[2])
            }
            return runs
    return {}
