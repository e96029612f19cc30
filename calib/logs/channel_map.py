"""A channel map: which columns of a foreign log are channels, with their units and signs.

columns of a log, channel map --assign--> for each channel its column and the conversion to SI
"""

from collections import Counter, abc
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import ChannelMapError, LogError
from calib.base.names import CHANNELS, FLAGS, TRUTH, TRUTH_UNITS
from calib.base.plain import quoted
from calib.base.toml import nearest
from calib.base.units import UnknownUnit, is_unit, si_of, to_si, unit_of
from calib.logs.log import Origin
from calib.logs.source import ChannelTrace, Column, address_of, indices_of
from calib.logs.text.dialect import DETECTED, TextFormat

MAP_IT = "name foreign columns in a channel map (--map); `brake-cal map` proposes one"

Databases = abc.Mapping[str, tuple[Path, ...]]
"""Files that describe the frames of a bus (DBC, ARXML, KCD, SYM), by bus; "" stands for all."""


@dataclass(frozen=True)
class Mapping:
    """Entry of a channel map: value = sign * (scale * written value + offset), in ``unit``."""

    source: str  # the column
    unit: str | None = None  # None is the unit in the header of the file
    sign: int = 1
    scale: float = 1.0
    offset: float = 0.0
    delay: float = 0.0  # [s], positive if the channel was recorded late

    def in_unit(self, written: Array) -> Array:
        """Convert values (n,) of the file to the unit of the mapping."""
        return self.sign * (self.scale * written + self.offset)


@dataclass(frozen=True)
class ChannelMap:
    """The content of a channel map; ``where`` is the path of its file."""

    where: str
    channels: dict[str, Mapping]  # by canonical name
    text: TextFormat = DETECTED
    ignore: tuple[str, ...] = ()  # columns that are not to be channels
    databases: Databases = field(default_factory=dict)


@dataclass(frozen=True)
class Assigned:
    """A channel and its column in the file."""

    channel: str
    index: int  # index of the column
    unit: str  # unit of the values after the mapping
    si: str  # SI unit of the channel
    mapping: Mapping
    column: str  # name of the column

    def to_si(self, written: Array) -> Array:
        """Convert values (n,) of the file to SI."""
        return to_si(self.mapping.in_unit(written), self.unit, self.si)

    def named(self, trace: ChannelTrace) -> ChannelTrace:
        """Give a trace the name of its channel; a flag becomes a state."""
        return replace(trace, is_state=trace.is_state or self.channel in FLAGS, name=self.channel)

    def origin(self) -> Origin:
        """Return how the SI value follows from the file; every conversion is linear."""
        at_zero, at_one = (float(v) for v in self.to_si(np.array([0.0, 1.0])))
        return Origin(self.channel, self.column, self.unit, at_one - at_zero, at_zero)


def assign(
    columns: tuple[Column, ...],
    channel_map: ChannelMap | None,
    require: tuple[str, ...],
    where: str,
) -> tuple[list[Assigned], tuple[str, ...], list[str]]:
    """Return the channels of the file ``where``, the names of its other columns, and notes.

    A channel is a column that the map names, or else a column with the name of a channel. An
    optional channel of the second kind is left out, with a note, if its unit is not known. Raises
    LogError for any other channel without a known unit, and for a channel that is missing or occurs
    twice; ChannelMapError for a source that is not in the file.
    """
    mapped = channel_map.channels if channel_map else {}
    ignore = channel_map.ignore if channel_map else ()
    map_path = channel_map.where if channel_map else None
    assigned = [_mapped(name, entry, columns, map_path, where) for name, entry in mapped.items()]
    mapped_indices, notes = {item.index for item in assigned}, list[str]()
    for index, column in enumerate(columns):
        name, quantity = column.name, CHANNELS.get(column.name)
        if index in mapped_indices or name in mapped or name in ignore:
            continue
        si = quantity.si if quantity else _truth_si(column)
        is_optional = quantity is not None and not quantity.required and name not in require
        if si and is_optional and not is_unit(column.unit or "", si):
            flaw = f"the unknown unit {column.unit!r}" if column.unit else "no unit"
            do = "name its unit in the header or in a channel map"
            notes.append(f"{name} has {flaw} and was left out: {do}")
        elif si:
            assigned.append(assigned_column(name, index, column, Mapping(name), si, where))
    count = Counter(item.channel for item in assigned)
    if twice := next((channel for channel in count if count[channel] > 1), None):
        flaw, expected = "the channel occurs twice", "one column of that name"
        do = _choose_one([item.index for item in assigned if item.channel == twice], columns)
        raise LogError(flaw, where=f"{where}: {twice}", expected=expected, do=do)
    indices = {item.index for item in assigned}
    ignored = tuple(c.name for i, c in enumerate(columns) if i not in indices)
    _refuse_missing([name for name in require if name not in count], ignored, where)
    return assigned, ignored, notes


def _mapped(
    name: str, entry: Mapping, columns: tuple[Column, ...], map_path: str | None, where: str
) -> Assigned:
    indices = indices_of(entry.source.strip(), columns)
    if not indices:
        names = [column.name for column in columns]
        flaw = f"{where} has no column {entry.source!r} for {name}"
        do = _suggestion(entry.source, names)
        raise ChannelMapError(flaw, where=map_path, expected=f"one of {quoted(names)}", do=do)
    if len(indices) > 1:
        flaw = f"{len(indices)} columns are called {entry.source!r}"
        do = _choose_one(indices, columns)
        raise LogError(flaw, where=f"{where}: {name}", expected="one", do=do)
    column = columns[indices[0]]
    return assigned_column(name, indices[0], column, entry, CHANNELS[name].si, where)


def assigned_column(
    channel: str, index: int, column: Column, entry: Mapping, si: str, where: str
) -> Assigned:
    """Assign a column to a channel. Raises LogError for a missing or a wrong unit."""
    unit, place = entry.unit or column.unit, f"{where}: {channel}"
    if not unit:
        expected, do = f"a unit in the header, such as [{si}]", "name it there or in a channel map"
        raise LogError("the unit is missing", where=place, expected=expected, do=do)
    try:
        unit_of(unit, si)
    except UnknownUnit as cause:
        do = "correct the header or use a channel map"
        raise LogError(str(cause), where=place, do=do) from cause
    return Assigned(channel, index, unit, si, entry, column.name)


def _truth_si(column: Column) -> str | None:
    """SI unit of a truth channel, by its name or else by its unit; None if there is none."""
    if not column.name.startswith(TRUTH):
        return None
    for stem, si in TRUTH_UNITS.items():
        if column.name.startswith(f"{stem}_"):
            return si
    unit = column.unit or ""
    return si_of(unit) if is_unit(unit) else None


def _choose_one(indices: list[int], columns: tuple[Column, ...]) -> str:
    addresses = [address_of(columns[i], columns) for i in indices]
    if len(set(addresses)) < len(addresses):
        return "rename one of them"
    return f"name one of them in a channel map: {', '.join(map(repr, addresses))}"


def _refuse_missing(missing: list[str], ignored: tuple[str, ...], where: str) -> None:
    if not missing:
        return
    flaw = f"no column is named {' or '.join(missing)}"
    others = f"; the log also has {quoted(ignored)}" if ignored else ""
    expected = f"a column for each of these channels{others}"
    hints = [_suggestion(name, list(ignored), f" to be {name}") for name in missing]
    do = "; ".join([*filter(None, hints), MAP_IT])
    raise LogError(flaw, where=where, expected=expected, do=do)


def _suggestion(word: str, names: list[str], use: str = "") -> str:
    """Ask whether the name nearest to ``word`` is meant; "" if none is near."""
    by_lower = {name.lower(): name for name in names}
    close = nearest(word.lower(), by_lower)
    return "" if close is None else f"is {by_lower[close]!r} meant{use}?"
