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
    header cell. A channel map may use either.
    """

    name: str
    unit: str | None
    full: str = ""


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
