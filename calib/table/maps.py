"""The maps of a table: level and ratio of the pads over what an ECU measures, with 95 % bounds.

The bounds count what the ramp left open and how a stop may differ from the ramp. A map is stored as
flat columns, row-major over its axes. `Draws` are the cars from which the maps are made.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike

from calib.base.arrays import Array


@dataclass(frozen=True)
class Map:
    """Columns (n,) over every combination of the values of the `AXES`; ``z`` changes slowest.

    A map is linear along each axis, and constant beyond the ends of an axis.
    """

    AXES: ClassVar[tuple[str, ...]] = ("z",)

    z: Array

    @classmethod
    def from_grids(cls, axes: Sequence[Array], **grids: Array) -> Self:
        """Return the map over ``axes``, in the order of `AXES`, with a column for each grid."""
        flat = [x.ravel() for x in np.meshgrid(*axes, indexing="ij")]
        columns = {name: np.ravel(grid) for name, grid in grids.items()}
        return cls(**dict(zip(cls.AXES, flat, strict=True)), **columns)

    @property
    def axes(self) -> dict[str, Array]:
        """The values of each axis by name, rising."""
        return {name: np.unique(getattr(self, name)) for name in self.AXES}

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values of each axis."""
        return tuple(x.size for x in self.axes.values())

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns that are no axes."""
        return tuple(field.name for field in fields(self) if field.name not in self.AXES)

    @property
    def bounded_columns(self) -> tuple[str, ...]:
        """Names of the columns with bounds, the columns NAME_lower and NAME_upper."""
        return tuple(name for name in self.names if f"{name}_lower" in self.names)

    @property
    def is_complete(self) -> bool:
        """Whether the rows are every combination of the axes once, in the order of `AXES`."""
        columns = zip(self.AXES, np.meshgrid(*self.axes.values(), indexing="ij"), strict=True)
        return all(np.array_equal(getattr(self, name), x.ravel()) for name, x in columns)

    def grid(self, name: str) -> Array:
        """A column in the `shape` of the axes."""
        column: Array = getattr(self, name)
        return column.reshape(self.shape)

    def on(self, axes: Sequence[Array]) -> Self:
        """Return the map interpolated to other axes, in the order of `AXES`."""
        columns = self(*np.meshgrid(*axes, indexing="ij"))
        return self.from_grids(axes, **columns)

    def __call__(self, *points: ArrayLike) -> dict[str, Array]:
        """Return the columns by name at ``points``, one array for each axis of `AXES`."""
        return dict(zip(self.names, Reader(self, self.names)(*points), strict=True))


class Reader:
    """Interpolates columns of a map, linearly in each cell.

    ``columns`` are c names, or r rows of c names. The result has their shape, (c,) or (r, c),
    followed by that of the points.
    """

    def __init__(self, m: Map, columns: Sequence[str] | Sequence[Sequence[str]]) -> None:
        self.axes, names = list(m.axes.values()), np.array(columns)
        self._columns = np.stack([getattr(m, name) for name in names.flat])
        self._shape = names.shape

    def width(self, axis: int, x: Array) -> Array:
        """Width of the cell of an axis in which ``x`` lies."""
        points = self.axes[axis]
        end = np.clip(np.searchsorted(points, x, "right"), 1, points.size - 1)
        return points[end] - points[end - 1]

    def __call__(self, *points: ArrayLike) -> Array:
        """Return the columns at ``points``, one array (...) for each axis."""
        coordinates = np.broadcast_arrays(*points)
        shape = coordinates[0].shape
        # each corner of the cell around a point: its row in the map, and its weight
        corners = [(np.zeros(shape, np.intp), np.ones(shape))]
        for axis, x in zip(self.axes, coordinates, strict=True):
            low = np.clip(np.searchsorted(axis, x, "right") - 1, 0, max(axis.size - 2, 0))
            high = np.minimum(low + 1, axis.size - 1)
            width = np.where(high > low, axis[high] - axis[low], 1.0)  # an axis may be one point
            share = np.clip((x - axis[low]) / width, 0.0, 1.0)
            corners_before, corners = corners, []
            for row, weight in corners_before:
                corners.append((row * axis.size + low, weight * (1.0 - share)))
                corners.append((row * axis.size + high, weight * share))
        values = np.zeros((self._columns.shape[0], *shape))
        for row, weight in corners:
            values += self._columns.take(row, axis=1) * weight
        return values.reshape(*self._shape, *shape)


@dataclass(frozen=True)
class PadMap(Map):
    """ln of the pads' ratio given z, eta, slip: medians with 95 % bounds. Shapes (n,), all [1]."""

    AXES: ClassVar[tuple[str, ...]] = ("z", "shift", "slip")
    # z is the brake force over the weight, from the zeroed deceleration

    shift: Array  # (eta - 1)/z
    slip: Array  # ln(slip/z) less `log_slip`, over `log_slip_sigma`
    ratio: Array  # ln of front over rear brake force at equal pressure, less that of the file
    ratio_lower: Array
    ratio_upper: Array
    change: Array  # ln of front over rear pad friction, relative to the ramp
    change_lower: Array
    change_upper: Array
    log_slip: Array  # mean of ln(slip/z) at this z and shift
    log_slip_sigma: Array  # its standard deviation
    share: Array  # share of the stops with this z that have this shift
    prior: Array  # width of the bounds of `ratio` over that given z alone, at most 1


@dataclass(frozen=True)
class LevelMap(Map):
    """Level and ratio of the pads given z alone: medians with 95 % bounds. Shapes (n,), all [1]."""

    level: Array  # ln of the true brake force over the brake force by the zeroed deceleration z
    level_lower: Array
    level_upper: Array
    ratio: Array  # as in `PadMap`
    ratio_lower: Array
    ratio_upper: Array
    change: Array  # as in `PadMap`
    change_lower: Array
    change_upper: Array


_WIDTHS = {"forms": 5, "depart_eta": 10, "depart_slip": 10}
"""Number of columns of the fields of `Draws` that have several."""


@dataclass(frozen=True)
class Draws:
    """Cars drawn from the posterior of a fit, equally likely. Shapes (n,), unit [1], or as said."""

    log_pad_ratio: Array  # ln of the pads' ratio, relative to the vehicle file
    log_pad_level: Array  # ln of the pads' level, relative to the vehicle file
    compliance_f: Array  # slip per normalised force at small slip and half the weight
    compliance_r: Array
    load_exponent: Array  # of the growth of the compliance with the load
    peak_load_exponent: Array  # of the fall of the peak with the load
    peak: Array  # largest normalised force at half the weight
    forms: Array  # weights of `calib.car.tyre_forms` (n, 5)
    radius_load: Array  # relative fall of a rolling radius per 100 % of load
    v_late: Array  # delay of v after the wheel speeds [s]
    cg_to_front_axle: Array  # [m]
    cg_height: Array  # [m]
    weight: Array  # M g [N]
    depart_eta: Array  # relative error of the model's eta - 1, at ten decelerations (n, 10)
    depart_slip: Array  # relative error of the model's mean slip, at ten decelerations (n, 10)

    @classmethod
    def from_columns(cls, **columns: Array) -> Self:
        """Return the draws of flat `columns`. Raises KeyError or TypeError for other columns."""
        for name, count in _WIDTHS.items():
            parts = [columns.pop(f"{name}_{i}") for i in range(1, count + 1)]
            columns[name] = np.stack(parts, axis=1)
        return cls(**columns)


def columns(part: object) -> dict[str, Array]:
    """Return the columns (n,) of a part by name; a field NAME (n, k) is NAME_1, NAME_2 ..."""
    flat: dict[str, Array] = {}
    for name, x in vars(part).items():
        if x.ndim > 1:
            flat |= {f"{name}_{i}": column for i, column in enumerate(x.T, 1)}
        else:
            flat[name] = x
    return flat


MAPS: dict[str, type[Map]] = {"map": PadMap, "level_map": LevelMap}
UNITS = {"v_late": "s", "cg_to_front_axle": "m", "cg_height": "m", "weight": "N"}
"""Units of the columns with a unit other than 1."""
