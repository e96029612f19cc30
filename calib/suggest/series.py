"""The numeric columns of a source, in SI if their unit is known."""

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
    """A column with a number in every row; ``si`` is the SI unit, None without a unit.

    ``values``, shape (n,), are in SI if the unit is known, else as written.
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
    """The numeric columns, and for the others the reason, by name."""
    found, left = [], {}
    for column, values in zip(source.columns, _arrays(source), strict=True):
        if isinstance(values, str):
            left[column.name] = values
        elif column.name.startswith("true_"):
            left[column.name] = "truth of a simulation"
        elif not np.isfinite(values).all():
            empty = np.isnan(values).all()
            left[column.name] = "empty" if empty else "has missing values"
        else:
            found.append(_series(column, values))
    return found, left


def _arrays(source: ColumnSource) -> list[Array | str]:
    """The values of every column, or why it cannot be read; read all at once if possible."""
    try:
        return list(source.read(range(len(source.columns))))
    except LogError:
        return [_one(source, index) for index in range(len(source.columns))]


def _one(source: ColumnSource, index: int) -> Array | str:
    try:
        return source.read([index])[0]
    except LogError as error:
        return f"not numeric: {error.what}"


def _series(column: Column, values: Array) -> Series:
    si = None
    if column.unit:
        own = CHANNELS.get(column.name)
        try:
            # For a canonical channel only its own units count: `Hz` on a wheel is an angular speed.
            si = own.si if own and is_unit(column.unit, own.si) else si_of(column.unit)
        except UnknownUnit:
            return Series(column, values, "?")
        values = to_si(values, column.unit, si)
    return Series(column, values, si)
