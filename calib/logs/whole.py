"""Read every numeric column of a log, on one clock, to look at it, cut it or convert it.

Columns that are no channels are read, too, and values stay in the units of the file. A mapped
column has its canonical name and the unit of the map.
"""

from collections.abc import Collection
from dataclasses import dataclass, replace
from itertools import chain, count
from pathlib import Path

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import LogError
from calib.base.names import CHANNELS
from calib.base.units import is_unit, to_si
from calib.logs.channel_map import MAP_IT, ChannelMap, assign
from calib.logs.clock import GAP, check_increasing, step_of
from calib.logs.formats import as_table, stem_of
from calib.logs.log import Log
from calib.logs.read import open_log, refuse_mapped_time
from calib.logs.source import Recording

TIME = "time"


@dataclass(frozen=True)
class WholeColumn:
    """One column of a log."""

    name: str
    unit: str | None
    values: Array  # (n,) in ``unit``, NaN for no value
    rate: float | None = None  # [Hz], as recorded, if the column was resampled


@dataclass(frozen=True)
class WholeLog:
    """All numeric columns of a log, of equal length; ``notes`` say what the reader changed."""

    name: str
    source: str
    digest: str
    columns: tuple[WholeColumn, ...]
    notes: tuple[str, ...] = ()

    @property
    def time(self) -> Array:
        """Increasing times of the rows [s] (n,). Raises LogError if the log has none."""
        for column in self.columns:
            if column.name == TIME and column.unit:
                time = to_si(column.values, column.unit, "s")
                check_increasing(time, self.source)
                return time
        raise LogError("no channel time with a unit", where=self.source, do=MAP_IT)

    def only(self, names: Collection[str]) -> "WholeLog":
        """Return the log with only its time and the columns with these names."""
        chosen = (c for c in self.columns if c.name in names or c.name == TIME)
        return replace(self, columns=tuple(chosen))


def read_whole(path: Path, channel_map: ChannelMap | None = None) -> WholeLog:
    """Read every numeric column, on the clock that `read_log` takes. Raises as `read_log`."""
    with open_log(path, channel_map) as opened:
        assigned, _, _ = assign(opened.source.columns, channel_map, (), str(path))
        by_index = {item.index: item for item in assigned}
        if isinstance(opened.source, Recording):
            refuse_mapped_time(assigned, channel_map)
        source = as_table(opened.source, str(path), by_index)
    # columns that the map ignores have a name that is wrong, so they are left out here, too
    ignore = channel_map.ignore if channel_map else ()
    columns, notes = list[WholeColumn](), list[str]()
    names = {item.channel for item in by_index.values()}
    for index, (column, values) in enumerate(zip(source.columns, source.each(), strict=True)):
        if isinstance(values, LogError) or column.name in ignore:
            why = values.problem if isinstance(values, LogError) else "the map ignores it"
            notes.append(f"{column.full_name} was left out: {why}")
            continue
        name, unit = column.name, column.unit
        if item := by_index.get(index):
            name, unit, values = item.channel, item.unit, item.mapping.in_unit(values)
        else:
            numbered = (f"{column.full_name}#{number}" for number in count(2))
            possible = chain((name, column.full_name), numbered)
            name = next(x for x in possible if x not in names)
        names.add(name)
        columns.append(WholeColumn(name, unit, values, source.rates.get(index)))
    if not columns:
        raise LogError("no column holds numbers", where=path, expected="a log")
    all_notes = (*source.notes, *notes)
    return WholeLog(stem_of(path), str(path), opened.digest, tuple(columns), all_notes)


def channels_log(log: WholeLog) -> Log:
    """Return the complete channels with a known unit, in SI. Raises LogError without a time."""
    channels = {}
    for column in in_si(log).columns:
        quantity = CHANNELS.get(column.name)
        if quantity and column.unit == quantity.si and np.isfinite(column.values).all():
            channels[column.name] = column.values
    return Log(log.name, log.source, log.digest, channels | {TIME: log.time})


def cut(log: WholeLog, start: float | None = None, end: float | None = None) -> WholeLog:
    """Keep the rows from ``start`` to ``end`` [s], inclusive. Raises LogError if none is left."""
    time = log.time
    first = 0 if start is None else int(np.searchsorted(time, start, side="left"))
    stop = time.size if end is None else int(np.searchsorted(time, end, side="right"))
    if stop <= first:
        low = "the start" if start is None else f"{start:g} s"
        high = "the end" if end is None else f"{end:g} s"
        expected = f"times from {time[0]:g} to {time[-1]:g} s"
        raise LogError(f"no sample from {low} to {high}", where=log.source, expected=expected)
    columns = (replace(c, values=c.values[first:stop]) for c in log.columns)
    return replace(log, columns=tuple(columns))


def in_si(log: WholeLog) -> WholeLog:
    """Convert the channels with a known unit to SI, the units of the C code of an ECU."""
    columns = []
    for column in log.columns:
        quantity = CHANNELS.get(column.name)
        if quantity and column.unit and is_unit(column.unit, quantity.si):
            values = to_si(column.values, column.unit, quantity.si)
            column = replace(column, values=values, unit=quantity.si)
        columns.append(column)
    return replace(log, columns=tuple(columns))


@dataclass(frozen=True)
class Inventory:
    """Range, number of samples, sample rate and gaps of a column."""

    name: str
    unit: str | None
    low: float | None  # lowest value, in ``unit``
    high: float | None
    samples: int
    rate: float | None  # [Hz]
    gaps: tuple[tuple[float, float], ...]  # start and length of each [s]


def inventory(log: WholeLog) -> tuple[Inventory, ...]:
    """Describe every column but the time. Raises LogError without a valid time."""
    time, result = log.time, []
    for column in log.columns:
        if column.name == TIME:
            continue
        present = np.isfinite(column.values)
        times, values = time[present], column.values[present]
        low, high = (values.min(), values.max()) if values.size else (None, None)
        steps = np.diff(times)
        mean = step_of(times) if steps.size else 0.0
        gaps = [(float(times[i]), float(steps[i])) for i in np.flatnonzero(steps > GAP * mean)]
        rate = column.rate or (1.0 / mean if steps.size else None)
        row = Inventory(column.name, column.unit, low, high, values.size, rate, tuple(gaps))
        result.append(row)
    return tuple(result)
