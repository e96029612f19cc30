"""A table as an ECU reads it: on fewer breakpoints, in integers or in single precision.

    numbers --Precision.numbers, .axis--> Written        one column
    Map     --written_map---------------> WrittenMap     `calib.exports` writes these numbers
    Table   --as_exported---------------> Table          validation judges this table

The axes of a map are rounded first, and its cells are interpolated from the whole map at the
rounded axes, so that rounding an axis adds no error.
"""

import math
from dataclasses import dataclass, replace
from typing import NamedTuple, TypeVar

import numpy as np

from calib.base.arrays import Array, Index
from calib.base.errors import ExchangeError
from calib.table.breakpoints import FEWEST, Misfit, place, place_weighted
from calib.table.curves import DifferenceCurve, PaperCurves, TyreCurve
from calib.table.maps import MAPS, Map
from calib.table.table import Table

_Curve = TypeVar("_Curve", DifferenceCurve, PaperCurves, TyreCurve)
BITS = (8, 16, 32)  # widths of the signed integer types of C
LEAST_BITS = 16
"""Least number of bits for axes of a map, which need small steps near 0, and scalars of a table."""
_MAX_SHIFT = 52  # largest `Fixed.shift`: the step is then that of a double at 1
_NOT_READ = ("share", "prior")  # columns that the estimator does not read
_LEAST_WIDTH = 1e-3  # least width of bounds that counts in the weights of breakpoints [1]


@dataclass(frozen=True)
class Fixed:
    """Fixed point: integers ``raw`` (n,) of ``bits``, with value = origin + raw * 2^-shift."""

    raw: Index
    bits: int
    origin: float
    shift: int
    error: float = 0.0  # largest rounding error, in the unit of the values; at most 2^-(shift + 1)

    @property
    def step(self) -> float:
        """Value of one step of the integers."""
        return math.ldexp(1.0, -self.shift)

    @property
    def values(self) -> Array:
        """Values of the integers (n,)."""
        return self.origin + np.ldexp(self.raw.astype(np.float64), -self.shift)


def _to_fixed(values: Array, bits: int, origin: float = 0.0) -> Fixed:
    """Return the nearest signed integers of ``bits`` for ``values`` (n,), with the finest step."""
    if bits not in BITS:
        expected = "one of " + ", ".join(map(str, BITS))
        raise ExchangeError(f"fixed point of {bits} bits", expected=expected)
    offsets = values - origin
    largest, max_integer = float(np.abs(offsets).max()), 2 ** (bits - 1) - 1
    shift = 0
    if largest > 0.0:
        shift = min(_MAX_SHIFT, math.floor(math.log2(max_integer) - math.log2(largest)))
        if math.ldexp(largest, shift) > max_integer:  # the logarithms are rounded
            shift -= 1
    raw = np.rint(np.ldexp(offsets, shift)).astype(np.int64)
    error = np.abs(Fixed(raw, bits, origin, shift).values - values).max()
    return Fixed(raw, bits, origin, shift, float(error))


class Written(NamedTuple):
    """A column as it is written: numbers ``values`` (n,), or the integers of ``fixed``."""

    values: Array
    fixed: Fixed | None = None

    @property
    def ecu_values(self) -> Array:
        """The numbers (n,) as an ECU reads them."""
        return self.values if self.fixed is None else self.fixed.values


@dataclass(frozen=True)
class Precision:
    """How a table is written: in integers of ``bits``, in ``single`` precision, else in double.

    Raises ExchangeError for integers together with single precision.
    """

    points: int | None = None  # number of rows to keep on each axis, None for all rows
    bits: int | None = None
    single: bool = False
    code: bool = False  # whether C code reads the table

    def __post_init__(self) -> None:
        if self.single and self.bits is not None:
            raise ExchangeError("single precision and fixed point", expected="one of the two")

    def __str__(self) -> str:
        points = "all rows" if self.points is None else f"{self.points} breakpoints"
        width = "single precision" if self.single else "double precision"
        width = f"{self.bits} bits" if self.bits else width
        return f"C code, {points}, {width}" if self.code else f"{points}, {width}"

    @property
    def wide(self) -> "Precision":
        """The precision with at least `LEAST_BITS` bits, for axes of maps and scalars."""
        return replace(self, bits=max(self.bits, LEAST_BITS)) if self.bits else self

    @property
    def floating(self) -> int:
        """Bits of a floating-point number in the ECU, which converts integers to single."""
        return 32 if self.single or self.bits else 64

    def computed(self, values: Array) -> Array:
        """Return numbers rounded to the floating point of the ECU."""
        return values.astype(np.float32).astype(np.float64) if self.floating == 32 else values

    def numbers(self, values: Array, origin: float = 0.0) -> Written:
        """Return numbers (n,) as written; ExchangeError for a width that C does not have."""
        if self.bits is not None:
            return Written(values, _to_fixed(values, self.bits, origin))
        return Written(self.computed(values))

    def axis(self, name: str, values: Array, origin: float = 0.0) -> Written:
        """Return an axis as in `numbers`; ExchangeError if rounding makes two breakpoints equal."""
        written = self.numbers(values, origin)
        if np.any(np.diff(written.ecu_values) <= 0.0):
            width, finer = f"{self.bits} bits", "more bits"
            if self.bits is None:
                width, finer = "single precision", "double precision"
            flaw = f"in {width} some breakpoints become equal"
            expected, do = "an axis that increases strictly", f"take fewer points, or {finer}"
            raise ExchangeError(flaw, where=name, expected=expected, do=do)
        # C code searches an axis in floating point, so its axes are not integers
        return Written(self.computed(written.ecu_values)) if self.code and self.bits else written

    def rows(self, name: str, x: Array, curves: Array) -> Index:
        """Return the rows of ``curves`` (k, n) over ``x`` to keep; ExchangeError with too few."""
        if self.points is None:
            return np.arange(len(x))
        if not FEWEST <= self.points <= len(x):
            expected = f"{FEWEST} to {len(x)}, the rows of the table"
            raise ExchangeError(f"{self.points} breakpoints", where=name, expected=expected)
        return place(x, curves, self.points)


@dataclass(frozen=True)
class WrittenMap:
    """A map as it is written."""

    axes: dict[str, Written]
    columns: dict[str, Written]
    misfit: dict[str, Misfit]  # by axis, with the place of the largest error on this axis


def written_map(whole: Map, how: Precision, label: str) -> WrittenMap:
    """Return a map with at most ``how.points`` values on each axis; errors as `Precision.axis`."""
    axes = {}
    for i, (name, x) in enumerate(whole.axes.items()):
        values = x[_rows(whole, i, how.points)]
        axes[name] = how.wide.axis(f"{label}, {name}", values)
    reduced = whole.on([axis.ecu_values for axis in axes.values()])
    columns = {name: how.numbers(getattr(reduced, name)) for name in whole.names}
    return WrittenMap(axes, columns, _misfit(whole, reduced))


def _rows(whole: Map, i: int, points: int | None) -> Index:
    """Return the rows of axis ``i`` to keep, for all columns that are read."""
    x = list(whole.axes.values())[i]
    if points is None:
        return np.arange(x.size)
    bounded = whole.bounded_columns[0]
    width = whole.grid(f"{bounded}_upper") - whole.grid(f"{bounded}_lower")
    share = whole.grid("share") if "share" in whole.names else 1.0  # of the stops
    weight = share / np.maximum(width, _LEAST_WIDTH) ** 2

    def curves(grid: Array) -> Array:  # slices of a grid along the axis, (k, n)
        return np.moveaxis(grid, i, -1).reshape(-1, x.size)

    names = [name for name in whole.names if name not in _NOT_READ]
    columns = np.concatenate([curves(whole.grid(name)) for name in names])
    weights = np.tile(curves(weight), (len(names), 1))
    return place_weighted(x, columns, weights, max(points, FEWEST))


def _misfit(whole: Map, reduced: Map) -> dict[str, Misfit]:
    """Errors of a reduced map by axis, at the cells of the whole map: there the largest one is."""
    interpolated = reduced.on(list(whole.axes.values()))
    names = [name + end for name in whole.bounded_columns for end in ("_lower", "", "_upper")]
    gaps = np.array([getattr(interpolated, name) - getattr(whole, name) for name in names])
    row = int(np.argmax(np.abs(gaps))) % whole.z.size  # gaps are (columns, rows)
    worst, rms = float(np.abs(gaps).max()), float(np.sqrt(np.mean(gaps**2, axis=1).max()))
    return {name: Misfit(worst, float(getattr(whole, name)[row]), rms) for name in whole.AXES}


def as_exported(table: Table, how: Precision) -> Table:
    """Return a table with curves and maps as an ECU reads them in an export of this precision.

    Bands, counts and flags of curves are not rounded, nor are mass, lengths and pads, which an
    export has within 0.003 %. Raises ExchangeError as `Precision` does.
    """
    p, d, g = table.paper, table.difference, table.tyre
    rows = how.rows("eta", p.eta, np.array([p.f1, p.f2, d.D]))
    tyre_rows = how.rows("slip", g.slip, g.force[None])
    maps = {}
    for name in MAPS:
        whole = getattr(table, name)
        written = written_map(whole, how, name)
        columns = {key: column.ecu_values for key, column in written.columns.items()}
        axes = [axis.ecu_values for axis in written.axes.values()]
        maps[name] = whole.from_grids(axes, **columns)
    return replace(
        table,
        paper=_curve(p, rows, how, "eta", ("f1", "f2"), origin=1.0),
        difference=_curve(d, rows, how, "eta", ("D",), origin=1.0),
        tyre=_curve(g, tyre_rows, how, "slip", ("force",), origin=0.0),
        **maps,
    )


def _curve(
    curve: _Curve, rows: Index, how: Precision, axis: str, names: tuple[str, ...], origin: float
) -> _Curve:
    """Return ``rows`` of a curve; the axis and the columns ``names`` are as an ECU reads them."""
    columns = {name: column[rows] for name, column in vars(curve).items()}
    columns[axis] = how.axis(axis, columns[axis], origin).ecu_values
    columns |= {name: how.numbers(columns[name]).ecu_values for name in names}
    return type(curve)(**columns)
