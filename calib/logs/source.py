"""What a reader of one file format hands over: the columns it found, and a way to read some."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_CELL = re.compile(r"\s*(.*?)\s*(?:\[([^\[\]]*)\])?\s*")


@dataclass(frozen=True)
class Column:
    """A column as the file names it. ``unit`` is None where the file says nothing of it.

    ``full`` names it among several of the same ``name``: with its group, message or bus.
    """

    name: str
    unit: str | None
    full: str = field(default="", repr=False)


@dataclass(frozen=True)
class Source:
    """A log file that was opened.

    ``columns`` in file order; ``read`` takes indices into them and returns one array each, as
    written, with NaN for an empty cell; ``notes`` what was odd but no error.
    """

    columns: tuple[Column, ...]
    read: Callable[[Sequence[int]], list[Array]]
    notes: tuple[str, ...] = ()


def column_from_cell(cell: str) -> Column:
    """Split a header cell ``name [unit]``.

    >>> column_from_cell("p_mc [bar]")
    Column(name='p_mc', unit='bar')
    >>> column_from_cell("p_mc")
    Column(name='p_mc', unit=None)
    """
    match = _CELL.fullmatch(cell)
    if match is None:  # brackets in odd places: take the cell as it stands
        return Column(cell.strip(), None)
    return Column(match[1], match[2].strip() if match[2] is not None else None)
