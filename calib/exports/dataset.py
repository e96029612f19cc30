"""The data set of an export: a table as axes, curves, maps and scalars that have labels.

`calib.exports.build` makes it of a version, and each format of `calib.exports.write` writes it.
"""

from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Any

from calib.base.arrays import Array
from calib.base.digest import sha256
from calib.car.effects.combined import sensed
from calib.exports.symbols import Addresses, Measured, Within
from calib.store.version import Stored
from calib.table.breakpoints import Misfit
from calib.table.exported import LEAST_BITS, Fixed

_CLAMP = (
    "outside an axis the value at its nearest end holds (clamped, never extrapolated); "
    "the estimator marks such samples as not valid"
)
_NOT_RELEASED = "NOT RELEASED, not for use in a vehicle: "
_KINDS = ("VALUE", "CURVE", "MAP", "CUBOID")  # in A2L and CDF, by number of axes
MOST_AXES = len(_KINDS) - 1  # of an object in A2L and CDF

Numbers = tuple[float, ...]
Cells = tuple[tuple[Numbers, ...], Numbers]
"""Axes of a curve or map, the slowest first, and its values."""


@dataclass(frozen=True)
class Content:
    """The numbers of an export by label."""

    axes: dict[str, Numbers]  # those that several curves or maps share
    scalars: dict[str, float]
    grids: dict[str, Cells]  # curves and maps

    def __len__(self) -> int:
        return len(self.axes) + len(self.scalars) + len(self.grids)

    @property
    def checksum(self) -> str:
        """SHA-256 over labels and numbers with all their bits, in hex."""
        lines = [f"scalar {name} {float(x).hex()}" for name, x in sorted(self.scalars.items())]
        lines += [f"axis {name} {_hex(x)}" for name, x in sorted(self.axes.items())]
        grids = []
        for name, (axes, values) in self.grids.items():
            kind = "map" if len(axes) > 1 else "curve"
            grids.append(f"{kind} {name} {' by '.join(map(_hex, axes))} of {_hex(values)}")
        return sha256("\n".join(lines + sorted(grids)).encode())


def _hex(values: Numbers) -> str:
    return " ".join(v.hex() for v in values)


@dataclass(frozen=True)
class Object:
    """Numbers under one label: an axis, a curve or map, or a scalar."""

    label: str
    meaning: str
    unit: str
    values: Array  # (n,) [unit]
    fixed: Fixed | None  # the values in fixed point, None in floating point
    axes: tuple["Axis", ...] = field(default=(), kw_only=True)  # the slowest first
    within: Within | None = field(default=None, kw_only=True)  # place in a larger object, if any

    @property
    def place(self) -> Within:
        """Place in the memory. An object that is part of no larger one has its own symbol."""
        return self.within or Within(self.label)

    @property
    def kind(self) -> str:
        """Kind of the object in A2L and CDF."""
        return "AXIS_PTS" if isinstance(self, Axis) else _KINDS[len(self.axes)]

    @property
    def numbers(self) -> list[float]:
        """The values as floats of Python, whose texts read back to the last bit."""
        return list(map(float, self.values))

    @property
    def span(self) -> str:
        """Range of the values, in words."""
        return f"range {min(self.numbers)!r} to {max(self.numbers)!r}"


@dataclass(frozen=True)
class Axis(Object):
    """Breakpoints, which increase strictly."""

    shared: bool  # whether several curves or maps have this axis
    origin: float  # of the fixed point
    rows: int  # number of rows of the table
    misfit: Misfit  # interpolation error between the breakpoints, before rounding

    @property
    def reduced(self) -> bool:
        """Whether the breakpoints are fewer than the rows of the table."""
        return len(self.values) < self.rows

    @property
    def placed(self) -> str:
        """Number of breakpoints and their interpolation error, in words."""
        if not self.reduced:
            return f"all {self.rows} rows of the table; interpolation error 0"
        m = self.misfit
        return (
            f"{len(self.values)} of {self.rows} rows; interpolation error at most {m.worst:.6g} "
            f"(at {m.worst_at:.8g}), rms {m.rms:.6g}"
        )


@dataclass(frozen=True)
class Grid(Object):
    """A curve or map: values (n,) at every combination of its axes, the first axis the slowest.

    The bounds of a map are grids of their own, too.
    """

    column: str  # name in the table
    bounds: tuple[Array, Array] | None  # lower and upper end of 95 %, if the column has bounds
    count: Array | None = None  # of blocks in each row of a curve, None of a map
    flag: Array | None = None  # of each row of a curve, None of a map

    @property
    def axis(self) -> Axis:
        """The fastest axis, along which the values lie side by side."""
        return self.axes[-1]

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of breakpoints of each axis."""
        return tuple(len(axis.values) for axis in self.axes)

    @property
    def nested(self) -> Any:
        """The values, nested as the axes are."""
        return self.values.reshape(self.shape).tolist()

    @property
    def is_bound(self) -> bool:
        """Whether the grid is a bound of another grid."""
        return self.column.endswith(("_lower", "_upper"))


@dataclass(frozen=True)
class Scalar(Object):
    """One number; ``sigma``: its standard deviation if it was fitted, else None."""

    sigma: float | None


@dataclass(frozen=True)
class Dataset:
    """The exported data of a version: integers of ``bits``, or ``single`` precision, or double."""

    stored: Stored
    prefix: str  # first part of all labels
    axes: tuple[Axis, ...]
    curves: tuple[Grid, ...]
    maps: tuple[Grid, ...]
    scalars: tuple[Scalar, ...]
    bits: int | None
    single: bool
    addresses: Addresses = field(default_factory=Addresses)  # for A2L
    measured: tuple[Measured, ...] = ()  # variables for A2L

    @property
    def epk(self) -> str:
        """Label of the digest in the memory, by which A2L identifies the program: its EPK."""
        return f"{self.prefix}_digest"

    @property
    def objects(self) -> tuple[Object, ...]:
        """Axes, curves, maps, scalars."""
        return (*self.axes, *self.curves, *self.maps, *self.scalars)

    @property
    def number_format(self) -> str:
        """Number format of a file for an ECU, in words."""
        if self.bits is None:
            return "float" if self.single else "double"
        exceptions = "; scalars and axes of maps int16_t" if self.bits < LEAST_BITS else ""
        return f"int{self.bits}_t, value = origin + step * raw{exceptions}"

    @property
    def date(self) -> str:
        """Day [UTC] on which the table was stored; today for a table in no store."""
        return self.stored.state.stored_at[:10] or datetime.now(UTC).date().isoformat()

    @property
    def quality(self) -> str:
        """State in CDF 2.0: preliminary until the release, then checked if it was validated."""
        if not self.stored.state.released:
            return "prelimCalibrated"
        return "checked" if self.stored.state.verdict else "calibrated"

    def content(self) -> Content:
        """Return the numbers by label."""
        grids: dict[str, Cells] = {}
        for grid in (*self.curves, *self.maps):
            grids[grid.label] = tuple(tuple(x.numbers) for x in grid.axes), tuple(grid.numbers)
        return Content(
            {axis.label: tuple(axis.numbers) for axis in self.axes if axis.shared},
            {scalar.label: scalar.numbers[0] for scalar in self.scalars},
            grids,
        )

    def facts(self) -> dict[str, str]:
        """Return what every file says about itself, by key."""
        stored, table, content = self.stored, self.stored.table, self.content()
        not_sensed = (f"{name}: {why}" for name, why in table.not_sensed.items())
        may_be_empty = {
            "parents": ", ".join(parent.id for parent in table.provenance.parents),
            "effects to take out": ", ".join(sensed(table.vehicle.effects).described),
            "effects not known to the ECU": "; ".join(not_sensed),
        }
        return {
            "table": stored.id,
            "version": str(stored.version),
            "digest": stored.digest,
            "program": table.provenance.program,
            "vehicle": table.vehicle.name,
            **{key: text for key, text in may_be_empty.items() if text},
            "ends": _CLAMP,
            **{f"breakpoints {a.label}": a.placed for a in self.axes},
            "validation": stored.state.verdict or "none",
            "state": self.quality,
            "release": ("" if stored.state.released else _NOT_RELEASED) + stored.state.with_reason,
            "objects": str(len(content)),
            "checksum": content.checksum,
        }
