"""The numeric columns of a log, and the state of the search for channels among them."""

from collections import abc
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import InputError, LogError
from calib.base.names import AXLES, CHANNELS, TRUTH
from calib.base.plain import counted, quoted
from calib.base.units import from_si, is_unit, si_of, to_si
from calib.logs.channel_map import Mapping, assigned_column
from calib.logs.source import Column, ColumnSource, address_of, indices_of
from calib.logs.text.cells import column_from_cell
from calib.run.filters import centred_mean, samples_in

SMOOTH = 0.2  # width [s] over which a speed is smoothed before it is differentiated


@dataclass(frozen=True)
class Series:
    """A numeric column; ``name`` is an address that no other column has."""

    name: str
    column: Column
    values: Array  # (n,) in the unit `si`
    si: str | None  # SI unit; None if the unit is not known and the values are as written
    rate: float | None = None  # own sample rate [Hz], if it differs from that of the rows


def read_series(source: ColumnSource) -> tuple[list[Series], list[Series], dict[str, str]]:
    """Return the columns with a number in every row, those with gaps, and why others are unused."""
    complete, gapped, unused = list[Series](), list[Series](), dict[str, str]()
    for index, (column, values) in enumerate(zip(source.columns, source.each(), strict=True)):
        name = address_of(column, source.columns)
        if isinstance(values, LogError):
            unused[name] = values.problem
        elif column.name.startswith(TRUTH):
            unused[name] = "truth of a simulation"
        elif np.isnan(values).all():
            unused[name] = "empty"
        elif np.isinf(values).any():
            unused[name] = "has infinite values"
        else:
            si = _si_unit(column)
            values = to_si(values, str(column.unit), si) if si else values
            columns = gapped if np.isnan(values).any() else complete
            columns.append(Series(name, column, values, si, source.rates.get(index)))
    return complete, gapped, unused


def _si_unit(column: Column) -> str | None:
    unit, quantity = column.unit or "", CHANNELS.get(column.name)
    if quantity and is_unit(unit, quantity.si):  # `Hz` on a wheel is an angular speed
        return quantity.si
    return si_of(unit) if is_unit(unit) else None


class ColumnClock(NamedTuple):
    """Time of each row [s], shape (n,), and the mean step [s]."""

    time: Array
    step: float

    def width(self, seconds: float) -> int:
        """Number of samples in ``seconds`` [s], at least 1."""
        return samples_in(seconds, self.step)

    def smooth(self, x: Array) -> Array:
        """The mean of x (n,) over `SMOOTH`, taken as an odd number of samples."""
        half = self.width(SMOOTH) // 2
        return centred_mean(x, 2 * half + 1)

    def derivative(self, speed: Array) -> Array:
        """Derivative of a speed (n,) [unit/s], smoothed over `SMOOTH` before and after."""
        return self.smooth(np.gradient(self.smooth(speed), self.time))


Radii = tuple[float, float]
"""Radii [m] of front and rear wheels, with which a car computes speeds at the rim."""
GIVE_RADIUS = (
    "give the radius with which the car computes them: --radius 0.31; give it twice, front then "
    "rear, if they differ"
)

SURE, LIKELY = "sure", "likely"
"""Sure: name, unit and physics agree. Likely: one of the three is missing, none contradicts."""


@dataclass(frozen=True)
class Proposal:
    """The source that is proposed for a channel."""

    channel: str
    mapping: Mapping
    sure: str  # how sure the proposal is: `SURE` or `LIKELY`
    reasons: tuple[str, ...]


@dataclass(frozen=True)
class Doubt:
    """A question on a channel that only the user can answer."""

    channel: str
    candidates: tuple[str, ...]  # names of the columns of which one may be the channel
    why: str  # cause of the doubt
    do: str  # next step of the user

    def __str__(self) -> str:
        names = f": {', '.join(self.candidates)}" if self.candidates else ""
        return f"{self.why}{names}; {self.do}"


def rim_mapping(channel: str, source: str, unit: str | None, radii: Radii | None) -> Mapping | None:
    """The mapping of a wheel speed that the log has as a speed at the rim, or None."""
    if not channel.startswith("omega_") or not unit or radii is None or not is_unit(unit, "m/s"):
        return None
    axle = channel.removeprefix("omega_")[0]
    radius = radii[AXLES.index(axle)]
    return Mapping(source, "rad/s", scale=to_si(1.0, unit, "m/s") / radius)


@dataclass
class Search:
    """State of the search; the proposals of the user are in ``proposals`` from the start."""

    series: list[Series]  # columns with a number in every row
    gapped: list[Series]  # columns with gaps, until they are resampled
    unused: dict[str, str]  # reason against a column, by its name
    user_specified: dict[str, str]  # source by channel, as the user wrote it
    radii: Radii | None
    proposals: dict[str, Proposal] = field(default_factory=dict)  # by channel
    doubts: list[Doubt] = field(default_factory=list)
    clock: ColumnClock | None = None

    def free(self) -> list[Series]:
        """Complete columns that are neither proposed nor refused."""
        proposed = {p.mapping.source for p in self.proposals.values()}
        return [s for s in self.series if s.name not in proposed and s.name not in self.unused]

    def refuse(self, item: Series, why: str) -> None:
        """Leave a column out; the first reason counts."""
        self.unused.setdefault(item.name, why)

    def propose(self, channel: str, mapping: Mapping, is_sure: bool, *reasons: str) -> None:
        """Propose a channel that the user did not give."""
        if channel not in self.user_specified:
            sure = SURE if is_sure else LIKELY
            self.proposals[channel] = Proposal(channel, mapping, sure, reasons)

    def doubt(self, channel: str, candidates: abc.Iterable[str], why: str, do: str) -> None:
        """Ask which of these columns is a channel that the user did not give."""
        if channel not in self.user_specified:
            self.doubts.append(Doubt(channel, tuple(candidates), why, do))

    def values_of_user(self, channel: str) -> Array | None:
        """The values (n,) [SI] of the column that the user gave for a channel; None without one."""
        if channel not in self.user_specified or channel not in self.proposals:
            return None
        mapping = self.proposals[channel].mapping
        item = next((s for s in (*self.series, *self.gapped) if s.name == mapping.source), None)
        if item is None or mapping.unit is None:  # without a unit of the user nothing is converted
            return item.values if item else None
        # undo the conversion with the unit of the file, then convert with that of the user
        written = from_si(item.values, str(item.column.unit), item.si) if item.si else item.values
        return to_si(mapping.in_unit(written), mapping.unit, CHANNELS[channel].si)


def start_search(
    source: ColumnSource, where: str, user_specified: abc.Mapping[str, str], radii: Radii | None
) -> Search:
    """Begin a search in the log ``where`` with the proposals of the user, as `suggest` has them."""
    search = Search(*read_series(source), dict(user_specified), radii)
    for channel, cell in user_specified.items():
        if channel not in CHANNELS:
            raise InputError(f"there is no channel {channel!r}", expected=", ".join(CHANNELS))
        if cell:
            search.proposals[channel] = _proposal_of_user(channel, cell, source, where, radii)
    return search


def _proposal_of_user(
    channel: str, cell: str, source: ColumnSource, where: str, radii: Radii | None
) -> Proposal:
    columns, from_user, si = source.columns, column_from_cell(cell), CHANNELS[channel].si
    indices = indices_of(cell, columns) or indices_of(from_user.name, columns)
    if len(indices) != 1:
        count = counted(len(indices), "column") if indices else "no column"
        names = [address_of(columns[i], columns) for i in indices] or [c.name for c in columns]
        raise InputError(f"{where} has {count} {cell!r}", expected=f"one of {quoted(names)}")
    column = columns[indices[0]]
    address = address_of(column, columns)
    unit = from_user.unit
    if column.name == cell or unit == column.unit:
        unit = None  # the unit of the file
    if mapping := rim_mapping(channel, address, unit or column.unit, radii):
        return Proposal(channel, mapping, SURE, ("given, with the radius of its axle",))
    if channel.startswith("omega_") and is_unit(unit or column.unit or "", "m/s"):
        raise InputError(f"{cell!r} is a speed at the rim", where=channel, do=GIVE_RADIUS)
    assigned_column(channel, indices[0], column, Mapping(address, unit), si, where)
    return Proposal(channel, Mapping(address, unit), SURE, ("given",))
