"""Read the plan of a gauge study, and the metrics of its ramps.

log,car,station,road,vehicle                station, road and vehicle are optional
a/ramp1.csv,VIN 7,line 2,wet,cars/7.toml    paths are relative to the folder of the plan
"""

import csv
import os
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from calib.base.bounded import PLAN, bytes_of
from calib.base.errors import InputError
from calib.fitting.fit import fit
from calib.line.gauge.study import GaugeReading, metrics_of
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
    """Read a plan with commas or semicolons; ``vehicle`` is for rows without a vehicle file.

    Raises InputError if the file is not readable, if a log or a column occurs twice, and for ramps
    of several roads: the stiffness of the tyres depends on the road, so they are no repeats.
    """
    ramps = tuple(_rows(path, vehicle))
    if not ramps:
        raise InputError("the plan has no logs", where=path, expected="a row for each log")
    file, count = Counter(os.path.realpath(ramp.log) for ramp in ramps).most_common(1)[0]
    if count > 1:
        raise InputError(f"{file} occurs twice", where=path)
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
        header = text.partition("\n")[0]
        delimiter = ";" if ";" in text and "," not in header else ","
        lines = csv.reader(text.splitlines(), delimiter=delimiter)
        columns, *rows = [[cell.strip() for cell in row] for row in lines] or [[]]  # no rows
    except (UnicodeDecodeError, csv.Error) as cause:
        raise InputError(f"not a table: {cause}", where=path, expected=_FILE) from cause
    names = {*columns}
    is_complete, is_known = {"log", "car"} <= names, names <= {*_COLUMNS}
    if not (is_complete and is_known) or len(names) < len(columns):
        raise InputError(f"columns {', '.join(columns)}", where=path, expected=_FILE)
    for number, row in enumerate(rows, 2):
        if not any(row):
            continue
        cells = dict(zip(columns, row, strict=False))
        if len(row) > len(columns) or not (cells.get("log") and cells.get("car")):
            problem = f"row {number} has no log or car, or too many cells"
            raise InputError(problem, where=path, expected=_FILE)
        file = cells.pop("vehicle", "")
        vehicle_file = path.parent / file if file else vehicle
        yield PlannedRamp(path.parent / cells.pop("log"), vehicle=vehicle_file, **cells)


def readings(
    ramps: Sequence[PlannedRamp],
    channel_map: ChannelMap | None,
    names: Sequence[str],
    report: Callable[[], None] = lambda: None,
) -> tuple[GaugeReading, ...]:
    """Fit each ramp alone, and return its metrics ``names``. Each ramp must have a vehicle.

    ``report`` is called after each ramp. Raises LogError for a ramp that cannot be fitted,
    InputError for a ramp that was given twice.
    """
    from calib.car.vehicle_file import read_vehicle

    cars = {file: read_vehicle(file) for file in {ramp.vehicle for ramp in ramps} if file}
    gauge_readings: list[GaugeReading] = []
    fitted_logs: list[LogReference] = []
    for ramp in ramps:
        assert ramp.vehicle is not None
        log = read_log(ramp.log, channel_map)
        copied = next((fitted for fitted in fitted_logs if fitted.is_run_of(log)), None)
        if copied:
            raise InputError(f"the same run as {copied.name}", where=log.source, do="give it once")
        table = fit(cars[ramp.vehicle], [log])
        fitted_logs += table.provenance.logs
        metrics = metrics_of(table, log)
        figures = {name: metrics[name] for name in names}
        reading = GaugeReading(str(ramp.log), ramp.car, ramp.station, figures, log.digest)
        gauge_readings.append(reading)
        report()
    return tuple(gauge_readings)
