"""Car and station of each log, from a plan file.

log,car,station,road,vehicle            plan.csv; station, road and vehicle are optional
a/ramp1.csv,VIN 7,line 2,wet,cars/7.toml    paths are relative to the plan's folder
"""

import csv
import os
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from calib.base.bounded import PLAN, bytes_of
from calib.base.errors import InputError
from calib.base.toml import did_you_mean

COLUMNS = ("log", "car", "station", "road", "vehicle")
FILE = f"a CSV file with columns {', '.join(COLUMNS)}"


@dataclass(frozen=True)
class Place:
    """A log of a study: ``station`` and ``road`` are "" if they are not given."""

    log: Path
    car: str
    station: str = ""
    vehicle: Path | None = None
    road: str = ""


def read_plan(path: Path) -> tuple[Place, ...]:
    """Read a plan, one log a row, with commas or semicolons between cells.

    Raises InputError if the file is not readable, or if a log or column occurs twice.
    """
    (_, heads), *rows = _cells(path)
    for head in heads:
        if head not in COLUMNS:
            near = did_you_mean(head, COLUMNS)
            raise InputError(f"unknown column {head!r}", where=path, expected=FILE, do=near)
    for head in ("log", "car", *heads):
        if heads.count(head) != 1:
            raise InputError(f"no or two columns {head!r}", where=path, expected=FILE)
    places = tuple(_place(path, line, heads, row) for line, row in rows)
    if not places:
        raise InputError("the plan has no logs", where=path, expected="a row for each log")
    log, times = Counter(os.path.realpath(place.log) for place in places).most_common(1)[0]
    if times > 1:
        raise InputError(f"{log} occurs twice", where=path)
    for key in ("station", "road"):
        if len({bool(getattr(place, key)) for place in places}) > 1:
            raise InputError(f"some logs have a {key} and some have none", where=path)
    return places


def _cells(path: Path) -> list[tuple[int, list[str]]]:
    """Number and cells of each line that is not empty, at least one."""
    data = bytes_of(path, PLAN, InputError, FILE)
    try:
        lines = data.decode("utf-8-sig").splitlines()
        separator = ";" if lines and ";" in lines[0] and "," not in lines[0] else ","
        table = csv.reader((line if line.strip() else "" for line in lines), delimiter=separator)
        rows = [(table.line_num, list(map(str.strip, row))) for row in table if row]
    except (UnicodeDecodeError, csv.Error) as cause:
        raise InputError(f"not a table: {cause}", where=path, expected=FILE) from cause
    if not rows or b"\0" in data:
        raise InputError("not a table", where=path, expected=FILE)
    return rows


def _place(path: Path, line: int, heads: list[str], row: list[str]) -> Place:
    if len(row) > len(heads):
        raise InputError(f"line {line} has more cells than columns", where=path)
    cells = dict.fromkeys(COLUMNS, "") | dict(zip(heads, row, strict=False))
    for key in ("log", "car"):
        if not cells[key]:
            raise InputError(f"line {line} has no {key}", where=path)
    vehicle = path.parent / cells["vehicle"] if cells["vehicle"] else None
    return Place(path.parent / cells["log"], cells["car"], cells["station"], vehicle, cells["road"])


def on_road(places: tuple[Place, ...], road: str | None, plan: Path) -> tuple[Place, ...]:
    """The places on ``road``; None for the only road of the plan, or a plan without roads.

    D, f1, f2 and the stiffness of the tyres depend on the road, so ramps of different roads are no
    repeats of each other. Raises InputError for several roads without a choice, and an unknown one.
    """
    roads = sorted({place.road for place in places} - {""})
    if road is None and len(roads) < 2:
        return places
    if road not in roads:
        what = f"no ramp on road {road!r}" if road else f"ramps of {len(roads)} roads"
        known = f"one road: {', '.join(roads)}" if roads else "a column road"
        do = "" if road else "choose one with --road: ramps of two roads are no repeats"
        raise InputError(what, where=plan, expected=known, do=do)
    return tuple(place for place in places if place.road == road)
