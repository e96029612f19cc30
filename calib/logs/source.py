"""What a reader of one file format hands over: the columns it found, and a way to read some."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Column:
    """A column as the file names it. ``unit`` is None where the file says nothing of it.

    ``full`` names it among several of the same ``name``: with its group, message or bus, or as
    the whole header cell. A channel map may use either.
    """

    name: str
    unit: str | None
    full: str = ""


@dataclass(frozen=True)
class ColumnSource:
    """A log file that was opened.

    ``columns`` in file order; ``read`` takes indices into them and returns one array each, as
    written, with NaN for an empty cell, and raises LogError for a column that holds no numbers;
    ``notes`` what was odd but no error.
    """

    columns: tuple[Column, ...]
    read: Callable[[Sequence[int]], list[Array]]
    notes: tuple[str, ...] = ()
