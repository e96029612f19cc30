"""An opened log file: its columns, and a function that reads some of them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Column:
    """A column as the file names it. ``unit`` is None if the file has no unit for it.

    ``full`` distinguishes columns of the same ``name``: with group, message or bus, or the whole
    header cell.
    """

    name: str
    unit: str | None
    full: str = ""

    @property
    def addresses(self) -> tuple[str, ...]:
        """What a channel map may call it: its name, also with the unit, or its full name."""
        return (self.name, f"{self.name} [{self.unit}]", self.full or self.name)


def called(address: str, columns: Sequence[Column]) -> list[int]:
    """The indices of the columns with this address."""
    return [i for i, column in enumerate(columns) if address in column.addresses]


def address_of(column: Column, columns: Sequence[Column]) -> str:
    """The first address that only this one of the columns has; its name if there is none."""
    own = (one for one in column.addresses if len(called(one, columns)) == 1)
    return next(own, column.name)


@dataclass(frozen=True)
class ColumnSource:
    """An opened log file.

    ``columns`` in file order; ``read`` takes indices into them and returns one array each, as
    written, with NaN for an empty cell, and raises LogError for a column that holds no numbers;
    ``notes`` on oddities that are no errors; ``rates`` of the columns that were recorded on another
    clock than that of the rows [Hz], by index.
    """

    columns: tuple[Column, ...]
    read: Callable[[Sequence[int]], list[Array]]
    notes: tuple[str, ...] = ()
    rates: Mapping[int, float] = field(default_factory=dict)
