"""The columns of a source that hold numbers, with what their unit says."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.errors import LogError
from calib.logs.source import Column, ColumnSource
from calib.names import CHANNELS
from calib.units import UnknownUnit, is_unit, si_of, to_si

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Series:
    """One column with numbers in every row, shape (n,); ``si`` of its unit, None if it has none.

    ``values`` are in SI where the unit is known, else as written.
    """

    column: Column
    values: Array
    si: str | None

    @property
    def name(self) -> str:
        """The name of the column."""
        return self.column.name

    @property
    def moves(self) -> bool:
        """Whether it has more than one value."""
        return bool(np.ptp(self.values) > 0.0)


def read_series(source: ColumnSource) -> tuple[list[Series], dict[str, str]]:
    """The columns of numbers, and of the others by name why they are none."""
    found, left = [], {}
    for column, values in zip(source.columns, _arrays(source), strict=True):
        if isinstance(values, str):
            left[column.name] = values
        elif column.name.startswith("true_"):
            left[column.name] = "truth of a simulation"
        elif not np.isfinite(values).all():
            empty = np.isnan(values).all()
            left[column.name] = "empty" if empty else "has rows without a value"
        else:
            found.append(_series(column, values))
    return found, left


def _arrays(source: ColumnSource) -> list[Array | str]:
    """Every column, or why it cannot be read; all at once where that works."""
    try:
        return list(source.read(range(len(source.columns))))
    except LogError:
        return [_one(source, index) for index in range(len(source.columns))]


def _one(source: ColumnSource, index: int) -> Array | str:
    try:
        return source.read([index])[0]
    except LogError as error:
        return f"no numbers: {error.what}"


def _series(column: Column, values: Array) -> Series:
    si = None
    if column.unit:
        own = CHANNELS.get(column.name)
        try:
            # A unit of one's own channel is looked up there: `Hz` is no frequency on a wheel.
            si = own.si if own and is_unit(column.unit, own.si) else si_of(column.unit)
        except UnknownUnit:
            return Series(column, values, "?")
        values = to_si(values, column.unit, si)
    return Series(column, values, si)
