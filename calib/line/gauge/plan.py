"""The plan of a gauge study, car and station of each ramp, and the metrics of these ramps.

log,car,station,road,vehicle                station, road and vehicle are optional
a/ramp1.csv,VIN 7,line 2,wet,cars/7.toml    paths are relative to the plan's folder
"""

import csv
import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from calib.base.bounded import PLAN, bytes_of
from calib.base.errors import InputError
from calib.fitting.fit import fit
from calib.line.gauge.study import GaugeReading, metrics_of, refuse_repeated
from calib.logs.channel_map import ChannelMap
from calib.logs.read import read_log
from calib.table.table import LogReference

_COLUMNS = ("log", "car", "station", "road", "vehicle")
_FILE = f"a CSV file with columns {', '.join(_COLUMNS)}; the last three may be left out"


@dataclass(frozen=True)
class PlannedRamp:
    """A ramp of a study; ``station`` and ``road`` are "" if they are not given."""

    log: Path
    car: str
    station: str = ""
    vehicle: Path | None = None
    road: str = ""


def read_plan(path: Path, vehicle: Path | None = None) -> tuple[PlannedRamp, ...]:
    """Read a plan with commas or semicolons; ``vehicle`` is the file where it names none.

    Raises InputError if the file is not readable, if a log or column occurs twice, and for ramps of
    several roads: the stiffness of the tyres depends on the road, so they are no repeats.
    """
    ramps = tuple(_rows(path, vehicle))
    if not ramps:
        raise InputError("the plan has no logs", where=path, expected="a row for each log")
    files = [os.path.realpath(ramp.log) for ramp in ramps]
    if twice := [file for file in files if files.count(file) > 1]:
        raise InputError(f"{twice[0]} occurs twice", where=path)
    if len({bool(ramp.station) for ramp in ramps}) > 1:
        raise InputError("some logs have a station and some have none", where=path)
    if len({ramp.road for ramp in ramps}) > 1:
        do = "write a plan for each road"
        raise InputError("ramps of several roads are no repeats", where=path, do=do)
    return ramps


def _rows(path: Path, vehicle: Path | None) -> Iterator[PlannedRamp]:
    data = bytes_of(path, PLAN, InputError, _FILE)
    try:
        text = data.decode("utf-8-sig")
        if "\0" in text:
            raise csv.Error("it holds a NUL")
        delimiter = ";" if ";" in text and "," not in text.partition("\n")[0] else ","
        lines = csv.reader(text.splitlines(), delimiter=delimiter)
        rows = [[cell.strip() for cell in row] for row in lines]
    except (UnicodeDecodeError, csv.Error) as cause:
        raise InputError(f"not a table: {cause}", where=path, expected=_FILE) from cause
    heads = rows[0] if rows else []
    if not {"log", "car"} <= {*heads} <= {*_COLUMNS} or len({*heads}) < len(heads):
        raise InputError(f"columns {', '.join(heads)}", where=path, expected=_FILE)
    for number, row in enumerate(rows[1:], 2):
        if not any(row):
            continue
        cells = dict(zip(heads, row, strict=False))
        if len(row) > len(heads) or not (cells.get("log") and cells.get("car")):
            problem = f"row {number} has no log or car, or too many cells"
            raise InputError(problem, where=path, expected=_FILE)
        named = cells.pop("vehicle", "")
        file = path.parent / named if named else vehicle
        yield PlannedRamp(path.parent / cells.pop("log"), vehicle=file, **cells)


def readings(
    ramps: Sequence[PlannedRamp],
    channel_map: ChannelMap | None,
    names: Sequence[str],
    report: Callable[[], None] = lambda: None,
) -> tuple[GaugeReading, ...]:
    """Metrics ``names`` of each ramp, fitted alone; each ramp must have a vehicle.

    ``report`` is called after each ramp. Raises LogError for a ramp that cannot be fitted,
    InputError for one that was given twice.
    """
    from calib.car.vehicle_file import read_vehicle

    cars = {file: read_vehicle(file) for file in {ramp.vehicle for ramp in ramps} if file}
    each: list[GaugeReading] = []
    parents: list[LogReference] = []
    for ramp in ramps:
        assert ramp.vehicle is not None
        log = read_log(ramp.log, channel_map)
        refuse_repeated(log, parents)
        table = fit(cars[ramp.vehicle], [log])
        parents += table.provenance.logs
        metrics = metrics_of(table, log)
        chosen = {name: metrics[name] for name in names}
        each.append(GaugeReading(str(ramp.log), ramp.car, ramp.station, chosen, log.digest))
        report()
    return tuple(each)
