"""An opened log: its columns, and a function that reads some of them."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import TypeVar

from calib.base.arrays import Array
from calib.base.errors import LogError

T = TypeVar("T")


@dataclass(frozen=True)
class Column:
    """A column as the file names it; ``full`` is its longer name, if it has one."""

    name: str
    unit: str | None
    full: str = ""

    @property
    def full_name(self) -> str:
        """The longer name, if there is one, else the name."""
        return self.full or self.name

    @property
    def addresses(self) -> tuple[str, ...]:
        """Names for a channel map: the name, the name with the unit, the full name."""
        return (self.name, f"{self.name} [{self.unit}]", self.full_name)


def indices_of(address: str, columns: Sequence[Column]) -> list[int]:
    """Indices of the columns with an address."""
    return [i for i, column in enumerate(columns) if address in column.addresses]


def address_of(column: Column, columns: Sequence[Column]) -> str:
    """The first address that no other column has; the name of the column if there is none."""
    unique = (name for name in column.addresses if len(indices_of(name, columns)) == 1)
    return next(unique, column.name)


@dataclass(frozen=True)
class ColumnSource:
    """An opened table: ``read`` gives columns by index as written, NaN for empty cells.

    ``rates`` [Hz], by index, of columns that were recorded on another clock than the rows.
    """

    columns: tuple[Column, ...]
    read: Callable[[Sequence[int]], list[Array]]
    notes: tuple[str, ...] = ()
    rates: Mapping[int, float] = field(default_factory=dict)

    def each(self) -> list[Array | LogError]:
        """Every column, or the error of one that holds no numbers."""
        return each_of(self.read, range(len(self.columns)))


def each_of(
    read: Callable[[Sequence[int]], Sequence[T]], indices: Sequence[int]
) -> list[T | LogError]:
    """The result of ``read`` for each index, or the error of one that cannot be read."""
    with suppress(LogError):
        return [*read(indices)] if indices else []
    results: list[T | LogError] = []
    for index in indices:
        try:
            results += read([index])
        except LogError as error:
            results.append(error)
    return results


CLOCK = Column("time", "s")  # first column of every recording: the common clock after resampling


@dataclass(frozen=True)
class ChannelTrace:
    """One channel as it was recorded; traces of equal ``clock`` share their timestamps.

    ``time`` [s], in the order of the file, and ``values`` as written, NaN where invalid, are (n,).
    A ``state``, such as a gear, holds its last value.
    """

    clock: str
    time: Array
    values: Array
    state: bool = False
    name: str = ""


@dataclass(frozen=True)
class Recording:
    """An opened log of several clocks: ``read`` gives a trace for each index.

    ``columns`` begin with ``CLOCK``, which has no trace; ``close`` closes the file.
    """

    columns: tuple[Column, ...]
    read: Callable[[Sequence[int]], list[ChannelTrace]]
    notes: tuple[str, ...] = ()
    close: Callable[[], None] = lambda: None


def damaged(where: object, flaw: str, expected: str = "an undamaged file") -> LogError:
    """The error for a file that is cut off or damaged."""
    return LogError(flaw, where=where, expected=expected, do="copy the log again")
