"""The maps of a table: the pads, given what an ECU measures, with 95 % bounds.

The bounds count what the ramp left open and how a stop may differ from it. Columns are flat,
row-major over the axes, so that a map is a plain table in every file format.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike

from calib.base.arrays import Array


@dataclass(frozen=True)
class Map:
    """Columns (n,) over every combination of the `AXES`, with ``z`` (n,) the slowest.

    A map is linear along each axis, and constant beyond its ends.
    """

    AXES: ClassVar[tuple[str, ...]] = ("z",)

    z: Array

    @classmethod
    def from_grids(cls, axes: Sequence[Array], **grids: Array) -> Self:
        """The map of ``grids`` by column, each of the shape of ``axes`` in the order of `AXES`."""
        flat = [x.ravel() for x in np.meshgrid(*axes, indexing="ij")]
        columns = {name: np.ravel(grid) for name, grid in grids.items()}
        return cls(**dict(zip(cls.AXES, flat, strict=True)), **columns)

    @property
    def axes(self) -> dict[str, Array]:
        """The values of each axis by its name, rising."""
        return {name: np.unique(getattr(self, name)) for name in self.AXES}

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values of each axis."""
        return tuple(x.size for x in self.axes.values())

    @property
    def names(self) -> tuple[str, ...]:
        """Columns that are no axes."""
        return tuple(one.name for one in fields(self) if one.name not in self.AXES)

    @property
    def bounded(self) -> tuple[str, ...]:
        """Columns with bounds: NAME_lower and NAME_upper are columns, too."""
        return tuple(name for name in self.names if f"{name}_lower" in self.names)

    @property
    def whole(self) -> bool:
        """Whether the rows are every combination of the axes once, in their order."""
        rows = zip(self.AXES, np.meshgrid(*self.axes.values(), indexing="ij"), strict=True)
        return all(np.array_equal(getattr(self, name), x.ravel()) for name, x in rows)

    def grid(self, name: str) -> Array:
        """A column in the `shape` of the axes."""
        column: Array = getattr(self, name)
        return column.reshape(self.shape)

    def on(self, axes: Sequence[Array]) -> Self:
        """The map, interpolated to other axes in the order of `AXES`."""
        return self.from_grids(axes, **self(*np.meshgrid(*axes, indexing="ij")))

    def __call__(self, *points: ArrayLike) -> dict[str, Array]:
        """Return the columns by name at ``points``, one array for each axis of `AXES`."""
        return dict(zip(self.names, Reader(self, self.names)(*points), strict=True))


class Reader:
    """Interpolator of columns of a map, constant beyond its ends."""

    def __init__(self, m: Map, columns: Sequence[str] | Sequence[Sequence[str]]) -> None:
        self.axes, names = list(m.axes.values()), np.array(columns)
        self._cells = np.stack([getattr(m, name) for name in names.flat])
        self._shape = names.shape

    def width(self, axis: int, x: Array) -> Array:
        """Width of the cell of an axis in which ``x`` lies."""
        points = self.axes[axis]
        end = np.clip(np.searchsorted(points, x, "right"), 1, points.size - 1)
        return points[end] - points[end - 1]

    def __call__(self, *points: ArrayLike) -> Array:
        """Return the columns at ``points``, an array (...) for each axis; shape (c, ...)."""
        each = np.broadcast_arrays(*points)
        corners = [(np.zeros(each[0].shape, np.intp), np.ones(each[0].shape))]
        for axis, x in zip(self.axes, each, strict=True):
            low = np.clip(np.searchsorted(axis, x, "right") - 1, 0, max(axis.size - 2, 0))
            high = np.minimum(low + 1, axis.size - 1)
            width = np.where(high > low, axis[high] - axis[low], 1.0)  # an axis may be one point
            share = np.clip((x - axis[low]) / width, 0.0, 1.0)
            ends = (low, 1.0 - share), (high, share)
            corners = [
                (row * axis.size + place, weight * part)
                for row, weight in corners
                for place, part in ends
            ]
        read = np.zeros((self._cells.shape[0], *each[0].shape))
        for row, weight in corners:
            read += self._cells.take(row, axis=1) * weight
        return read.reshape(*self._shape, *read.shape[1:])


@dataclass(frozen=True)
class PadMap(Map):
    """ln of the pads' ratio, given z, eta and slip. Shapes (n,), all [1].

    Axes: ``z`` brake force over the weight, by the zeroed deceleration; ``shift`` (eta - 1)/z;
    ``slip`` ln(slip/z) less its mean ``log_slip`` at this z and shift, over its standard deviation
    ``log_slip_sigma``. ``share`` of the stops with this z that have such a shift.

    ``ratio`` ln of front over rear pads, relative to the vehicle file; ``change`` the same relative
    to the ramp: medians with 95 % bounds. ``prior`` width of the bounds of the ratio over that
    without eta and slip: 1 where these say nothing.
    """

    AXES: ClassVar[tuple[str, ...]] = ("z", "shift", "slip")

    shift: Array
    slip: Array
    ratio: Array
    ratio_lower: Array
    ratio_upper: Array
    change: Array
    change_lower: Array
    change_upper: Array
    log_slip: Array
    log_slip_sigma: Array
    share: Array
    prior: Array


@dataclass(frozen=True)
class LevelMap(Map):
    """Level and ratio of the pads given z alone: medians with 95 % bounds, all [1].

    ``level`` ln of the true brake force over that by the zeroed deceleration z;
    ``ratio`` and ``change`` as in `PadMap`.
    """

    level: Array
    level_lower: Array
    level_upper: Array
    ratio: Array
    ratio_lower: Array
    ratio_upper: Array
    change: Array
    change_lower: Array
    change_upper: Array


_BLOCKS = {"forms": 5, "depart_eta": 10, "depart_slip": 10}
"""Fields of `Draws` that have several numbers a row, and how many."""


@dataclass(frozen=True)
class Draws:
    """Draws from the posterior of a fit, equally likely. Shapes (n,), all [1], or as said.

    ``log_pad_ratio`` ln of front over rear pads and ``log_pad_level`` ln of their level, over the
    vehicle file. ``compliance_f``, ``compliance_r`` slip per normalised force at small slip and
    half the weight. ``load_exponent`` by which the compliance grows with the load,
    ``peak_load_exponent`` by which the ``peak`` at half the weight falls with it. ``forms`` weights
    (n, 5), see `calib.car.tyre_forms`. ``radius_load`` fall of a rolling radius per
    100 % of load. ``v_late`` delay of v after the wheel speeds [s]. ``cg_to_front_axle``,
    ``cg_height`` [m]; ``weight`` M g [N]. ``depart_eta``, ``depart_slip`` relative shape
    discrepancy of eta - 1 and of the mean slip, at ten decelerations (n, 10).
    """

    log_pad_ratio: Array
    log_pad_level: Array
    compliance_f: Array
    compliance_r: Array
    load_exponent: Array
    peak_load_exponent: Array
    peak: Array
    forms: Array
    radius_load: Array
    v_late: Array
    cg_to_front_axle: Array
    cg_height: Array
    weight: Array
    depart_eta: Array
    depart_slip: Array

    @classmethod
    def from_columns(cls, **columns: Array) -> Self:
        """The draws of `columns`. Raises KeyError or TypeError where one is missing or unknown."""
        for name, count in _BLOCKS.items():
            parts = [columns.pop(f"{name}_{i}") for i in range(1, count + 1)]
            columns[name] = np.stack(parts, axis=1)
        return cls(**columns)


def columns(part: object) -> dict[str, Array]:
    """Columns (n,) of a curve, map or draws; NAME_1, NAME_2 and so on of a field (n, k)."""
    flat: dict[str, Array] = {}
    for name, x in vars(part).items():
        wide = {f"{name}_{i}": column for i, column in enumerate(x.T, 1)} if x.ndim > 1 else {}
        flat |= wide or {name: x}
    return flat


MAPS: dict[str, type[Map]] = {"map": PadMap, "level_map": LevelMap}
"""The maps of a table by name."""

UNITS = {"v_late": "s", "cg_to_front_axle": "m", "cg_height": "m", "weight": "N"}
"""Units of the columns that are not dimensionless."""
