"""An opened log: its columns, and a function that reads some of them.

A `ColumnSource` is a table: its columns share one clock. A `Recording`, such as one of bus frames,
has a clock for each message or group.
"""

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import TypeVar

from calib.base.arrays import Array
from calib.base.errors import LogError

T = TypeVar("T")


@dataclass(frozen=True)
class Column:
    """A column as the file names it."""

    name: str
    unit: str | None
    full: str = ""  # a longer name if there is one, such as ``group.name``

    @property
    def full_name(self) -> str:
        """The longer name, or else the name."""
        return self.full or self.name

    @property
    def addresses(self) -> tuple[str, ...]:
        """Names by which a channel map can choose the column."""
        return (self.name, f"{self.name} [{self.unit}]", self.full_name)


def indices_of(address: str, columns: Sequence[Column]) -> list[int]:
    """Indices of the columns that have this address."""
    return [i for i, column in enumerate(columns) if address in column.addresses]


def address_of(column: Column, columns: Sequence[Column]) -> str:
    """First address of a column that no other column has, or its name if there is none."""
    for address in column.addresses:
        if len(indices_of(address, columns)) == 1:
            return address
    return column.name


@dataclass(frozen=True)
class ColumnSource:
    """An opened table of n rows."""

    columns: tuple[Column, ...]
    read: Callable[[Sequence[int]], list[Array]]
    """Returns the values (n,) of columns, by their indices, as written; NaN for no value."""
    notes: tuple[str, ...] = ()
    rates: Mapping[int, float] = field(default_factory=dict)
    """Sample rates [Hz] of the columns of a resampled recording, by index of the column."""

    def each(self) -> list[Array | LogError]:
        """Read all columns; the error takes the place of one that cannot be read."""
        return read_each(self.read, range(len(self.columns)))


def read_each(
    read: Callable[[Sequence[int]], Sequence[T]], indices: Sequence[int]
) -> list[T | LogError]:
    """Read columns by their indices; the error takes the place of one that cannot be read."""
    if not indices:
        return []
    with suppress(LogError):
        return [*read(indices)]  # faster than one by one
    results: list[T | LogError] = []
    for index in indices:
        try:
            results += read([index])
        except LogError as error:
            results.append(error)
    return results


CLOCK = Column("time", "s")


@dataclass(frozen=True)
class ChannelTrace:
    """One channel as it was recorded, in the order of the file."""

    clock: str  # name of the clock; traces of one clock have the same times
    time: Array  # [s] (n,)
    values: Array  # as written (n,), NaN if invalid
    is_state: bool = False  # a state, such as a gear, keeps its value until the next sample
    name: str = ""  # of the channel or column; given after the trace was read


@dataclass(frozen=True)
class Recording:
    """An opened log of several clocks; ``read`` returns the traces of columns by their indices."""

    columns: tuple[Column, ...]  # the first is `CLOCK`, which has no trace before resampling
    read: Callable[[Sequence[int]], list[ChannelTrace]]
    notes: tuple[str, ...] = ()
    close: Callable[[], None] = lambda: None


def damaged(where: object, flaw: str, expected: str = "an undamaged file") -> LogError:
    """Return the error for a file that is cut off or damaged."""
    return LogError(flaw, where=where, expected=expected, do="copy the log again")
