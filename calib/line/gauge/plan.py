"""The ramps of a gauge study: car and station of each from a plan file, and their metrics.

log,car,station,road,vehicle                station, road and vehicle are optional
a/ramp1.csv,VIN 7,line 2,wet,cars/7.toml    paths are relative to the plan's folder
"""

import csv
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from calib.base.bounded import PLAN, bytes_of
from calib.base.errors import InputError
from calib.base.toml import did_you_mean
from calib.fitting.fit import fit
from calib.line.gauge.study import GaugeReading, metrics_of, refuse_repeated
from calib.logs.channel_map import ChannelMap
from calib.logs.read import read_log
from calib.table.table import LogReference

_COLUMNS = ("log", "car", "station", "road", "vehicle")
_FILE = f"a CSV file with columns {', '.join(_COLUMNS)}"


@dataclass(frozen=True)
class Place:
    """A log of a study: ``station`` and ``road`` are "" if they are not given."""

    log: Path
    car: str
    station: str = ""
    vehicle: Path | None = None
    road: str = ""


def read_plan(
    path: Path, logs: Sequence[Path] = (), vehicle: Path | None = None
) -> tuple[Place, ...]:
    """Read a plan, one log a row, with commas or semicolons; of ``logs`` only, if there are any.

    ``vehicle`` is the file of the logs for which the plan names none.

    D, f1, f2 and the stiffness of the tyres depend on the road, so ramps of different roads are no
    repeats of each other and are refused. Raises InputError if the file is not readable, if a log
    or column occurs twice, and for a log without a row.
    """
    (_, heads), *rows = _cells(path)
    for head in ("log", "car", *heads):
        if head not in _COLUMNS:
            near = did_you_mean(head, _COLUMNS)
            raise InputError(f"unknown column {head!r}", where=path, expected=_FILE, do=near)
        if heads.count(head) != 1:
            raise InputError(f"no or two columns {head!r}", where=path, expected=_FILE)
    known: dict[str, Place] = {}
    for line, row in rows:
        place = _place(path, line, heads, row, vehicle)
        if known.setdefault(os.path.realpath(place.log), place) is not place:
            raise InputError(f"{place.log} occurs twice", where=path)
    for log in logs:
        if os.path.realpath(log) not in known:
            raise InputError(f"{log} is not in the plan", where=path, do="add a row for it")
    places = tuple(known[os.path.realpath(log)] for log in logs) or tuple(known.values())
    if not places:
        raise InputError("the plan has no logs", where=path, expected="a row for each log")
    if len({bool(place.station) for place in places}) > 1:
        raise InputError("some logs have a station and some have none", where=path)
    if roads := sorted({place.road for place in places})[1:]:
        raise InputError(
            f"ramps of {len(roads) + 1} roads are no repeats",
            where=path,
            expected="ramps of one road",
            do="name those of one road after the command",
        )
    return places


def _cells(path: Path) -> list[tuple[int, list[str]]]:
    """Number and cells of each line that is not empty, at least one."""
    data = bytes_of(path, PLAN, InputError, _FILE)
    try:
        lines = data.decode("utf-8-sig").splitlines()
        separator = ";" if lines and ";" in lines[0] and "," not in lines[0] else ","
        table = csv.reader((line if line.strip() else "" for line in lines), delimiter=separator)
        rows = [(table.line_num, list(map(str.strip, row))) for row in table if row]
    except (UnicodeDecodeError, csv.Error) as cause:
        raise InputError(f"not a table: {cause}", where=path, expected=_FILE) from cause
    if not rows or b"\0" in data:
        raise InputError("not a table", where=path, expected=_FILE)
    return rows


def _place(path: Path, line: int, heads: list[str], row: list[str], vehicle: Path | None) -> Place:
    if len(row) > len(heads):
        raise InputError(f"line {line} has more cells than columns", where=path)
    cells = dict.fromkeys(_COLUMNS, "") | dict(zip(heads, row, strict=False))
    for key in ("log", "car"):
        if not cells[key]:
            raise InputError(f"line {line} has no {key}", where=path)
    vehicle = path.parent / cells["vehicle"] if cells["vehicle"] else vehicle
    return Place(path.parent / cells["log"], cells["car"], cells["station"], vehicle, cells["road"])


def readings(
    places: Sequence[Place],
    channel_map: ChannelMap | None,
    reference: float,
    names: Sequence[str],
    done: Callable[[], None] = lambda: None,
) -> tuple[GaugeReading, ...]:
    """Metrics of these ``names`` of each ramp, fitted alone; each place must have a vehicle.

    ``reference`` is eta - 1 at which curves are compared [1]; ``done`` is called after each. Raises
    LogError for a ramp that cannot be fitted, and one that was given twice.
    """
    from calib.car.vehicle_file import read_vehicle

    cars = {file: read_vehicle(file) for file in {place.vehicle for place in places} if file}
    found: list[GaugeReading] = []
    parents: list[LogReference] = []
    for place in places:
        assert place.vehicle is not None
        log = read_log(place.log, channel_map)
        refuse_repeated(log, parents)
        table = fit(cars[place.vehicle], [log])
        parents += table.provenance.logs
        metrics = metrics_of(table, log, reference)
        kept = {name: metrics[name] for name in names}
        found.append(GaugeReading(str(place.log), place.car, place.station, kept, log.digest))
        done()
    return tuple(found)
