"""The numeric columns of a source, in SI if their unit is known."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calib.base.errors import LogError
from calib.base.names import CHANNELS
from calib.base.units import UnknownUnit, is_unit, si_of, to_si
from calib.logs.clock import step_of
from calib.logs.gaps import ONLY, fill_rows
from calib.logs.source import Column, ColumnSource, address_of

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Series:
    """A numeric column; ``si`` is the SI unit, None without a unit.

    ``values``, shape (n,), are in SI if the unit is known, else as written. ``rate`` is that of its
    samples [Hz], None if they are the rows. ``name`` is the address that only this column has.
    """

    name: str
    column: Column
    values: Array
    si: str | None
    rate: float | None = None

    @property
    def moves(self) -> bool:
        """Whether it has more than one value."""
        return bool(np.ptp(self.values) > 0.0)


def read_series(source: ColumnSource) -> tuple[list[Series], list[Series], dict[str, str]]:
    """The columns with a number in every row, those with gaps, and for the others the reason."""
    found, with_gaps, left = list[Series](), list[Series](), dict[str, str]()
    for index, (column, values) in enumerate(zip(source.columns, _arrays(source), strict=True)):
        name = address_of(column, source.columns)
        if isinstance(values, str):
            left[name] = values
        elif column.name.startswith("true_"):
            left[name] = "truth of a simulation"
        elif np.isnan(values).all():
            left[name] = "empty"
        elif np.isinf(values).any():
            left[name] = "has infinite values"
        else:
            item = replace(_series(name, column, values), rate=source.rates.get(index))
            (with_gaps if np.isnan(values).any() else found).append(item)
    return found, with_gaps, left


def without_gaps(series: Series, time: Array) -> Series | str:
    """The column with its short gaps bridged, or why it cannot be used.

    ``time`` of the rows [s], shape (n,).
    """
    filled, _, _ = fill_rows({series.name: series.values}, time)
    values, known = filled[series.name], time[~np.isnan(series.values)]
    missing = np.flatnonzero(np.isnan(values))
    if missing.size:
        first = f"{missing.size} of {time.size} rows, first at {time[missing[0]]:.3f} s"
        return f"no value in {first}; gaps are bridged {ONLY}"
    return replace(series, values=values, rate=series.rate or 1.0 / step_of(known))


def finest(series: list[Series]) -> list[Series]:
    """Those that were sampled more than half as fast as the fastest; all if rates are unknown."""
    top = max((item.rate or 0.0 for item in series), default=0.0)
    return [item for item in series if 2.0 * (item.rate or 0.0) >= top]


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
        return error.what


def _series(name: str, column: Column, values: Array) -> Series:
    si = None
    if column.unit:
        own = CHANNELS.get(column.name)
        try:
            # For a canonical channel only its own units count: `Hz` on a wheel is an angular speed.
            si = own.si if own and is_unit(column.unit, own.si) else si_of(column.unit)
        except UnknownUnit:
            return Series(name, column, values, "?")
        values = to_si(values, column.unit, si)
    return Series(name, column, values, si)
