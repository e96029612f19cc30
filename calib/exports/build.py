"""Build the data set of a table: curves, maps and parameters with labels.

The data set has all rows of the table or the best few, in floating point or in fixed point.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import chain

import numpy as np

from calib.base.names import AXLE_NAMES
from calib.exports.dataset import MOST_AXES, Axis, Dataset, Grid, Scalar
from calib.exports.symbols import label, prefix
from calib.store.figures import effect_figures
from calib.store.version import Stored
from calib.table.breakpoints import misfit
from calib.table.exported import Precision, WrittenMap, written_map
from calib.table.maps import MAPS
from calib.table.table import Table

UNIT = "1"  # of every axis and curve: speed ratios, slips and normalised forces

_SHORT = {  # labels of effects that nearly every table has; others are called EFFECT_PARAMETER
    ("aerodynamic_drag", "drag_area"): "drag_area",
    ("rolling_resistance", "coefficient"): "rolling_coeff",
}

_ETA = "eta = omega_rear/omega_front, zeroed while rolling unbraked"
_TYRE = "normalised force as a function of slip, common tyre curve"
_AXES = {
    "z": "z, (brake force that the deceleration demands)/(M g), zeroed while rolling",
    "shift": "(eta - 1)/z",
    "slip": "ln(slip/z) less log_slip, over log_slip_sigma",
}
_COLUMNS = {
    "ratio": "ln of the pads' ratio, front over rear, over that of mu_n_f and mu_n_r",
    "change": "ln of the pads' ratio over that of the ramp",
    "level": "ln of the brake force over that which z demands",
    "log_slip": "mean of ln(slip/z)",
    "log_slip_sigma": "standard deviation of ln(slip/z)",
    "share": "share of the stops with this z that show such a shift",
    "prior": "width of the bounds of the ratio, divided by their width before eta is read",
}
_BOUNDS = ("_lower", "_upper")
_FLAT = {"log_slip", "log_slip_sigma", "share"}  # constant along the last axis, written without it


def build(
    stored: Stored,
    points: int | None = None,
    bits: int | None = None,
    *,
    single: bool = False,
    most_axes: int = MOST_AXES,
    first: str | None = None,
) -> Dataset:
    """Return the data set of a version, with ``points`` breakpoints on each axis, or all rows.

    ``bits`` are those of the fixed point, None for floating point, which has 32 bits if ``single``.
    A map of more than ``most_axes`` is sliced. Every label begins with ``first``, or with the
    table's name. Raises ExchangeError for more points than rows, a width that C does not have, and
    a rounded axis that does not increase.
    """
    table, precision = stored.table, Precision(points, bits, single)
    first = prefix(stored.name if first is None else first)
    axes, curves = zip(*_curves_of(table, first, precision), strict=True)
    map_axes, table_maps = zip(*maps_of(table, first, precision, most_axes), strict=True)
    return Dataset(
        stored=stored,
        prefix=first,
        axes=(*axes, *chain.from_iterable(map_axes)),
        curves=tuple(chain.from_iterable(curves)),
        maps=tuple(chain.from_iterable(table_maps)),
        scalars=tuple(_scalars(table, stored.version, first, precision)),
        bits=bits,
        single=single,
    )


def _curves_of(table: Table, first: str, precision: Precision) -> Iterator[tuple[Axis, list[Grid]]]:
    """Return each axis with its curves, at the rows that are breakpoints."""
    p, d, g = table.paper, table.difference, table.tyre  # curves f1 and f2, D, and force of a tyre
    over_eta = {
        "f1": ("f1 = F_f - z", p.f1, p.f1_lower, p.f1_upper, p.count, p.flag),
        "f2": ("f2 = F_r - z", p.f2, p.f2_lower, p.f2_upper, p.count, p.flag),
        "D": ("D = F_f - F_r", d.D, d.lower, d.upper, d.count, d.flag),
    }
    over_slip = {"g": (_TYRE, g.force, g.lower, g.upper, g.count, g.flag)}
    # shared: the axis serves several curves; origin: the value from which fixed point counts
    for name, meaning, x, shared, origin, curves in (
        ("eta", _ETA, p.eta, True, 1.0, over_eta),
        ("slip", "slip of the wheel", g.slip, False, 0.0, over_slip),
    ):
        name = label(first, name)
        y = np.array([values for _, values, *_ in curves.values()])
        rows = precision.rows(name, x, y)
        error = misfit(x, y, x[rows], y[:, rows])
        values, fixed = precision.axis(name, x[rows], origin)
        axis = Axis(name, meaning, UNIT, values, fixed, shared, origin, rows=len(x), misfit=error)
        grids = []
        for column, (text, *all_rows) in curves.items():
            median, low, high, count, flag = (values[rows] for values in all_rows)
            values, fixed = precision.numbers(median)
            head = label(first, column), text, UNIT
            grids.append(Grid(*head, values, fixed, column, (low, high), count, flag, axes=(axis,)))
        yield axis, grids


def _name(part: str, name: str) -> str:
    """Return the name of an axis or a column of a map in its label.

    `level_map` answers before eta is read: ``_0`` marks its ratio, the prior. The slip of a map is
    ``slip_apart``, since the tyre curve has an axis ``slip``.

    >>> _name("map", "slip"), _name("level_map", "z"), _name("level_map", "ratio_lower")
    ('slip_apart', 'z_level', 'ratio_0_lower')
    """
    if part != "level_map":
        return "slip_apart" if name == "slip" else name
    if name == "z":
        return "z_level"
    column, underscore, end = name.partition("_")
    return name if column == "level" else f"{column}_0{underscore}{end}"


def maps_of(
    table: Table, first: str, precision: Precision, most_axes: int
) -> Iterator[tuple[tuple[Axis, ...], list[Grid]]]:
    """Return axes and columns of each map, in slices if it has more than ``most_axes``."""
    for part in MAPS:
        table_map = getattr(table, part)
        exported = written_map(table_map, precision, label(first, part))
        axes = tuple(
            Axis(
                label(first, _name(part, name)), _AXES[name], UNIT, written.values, written.fixed,
                shared=True, origin=0.0, rows=rows, misfit=exported.misfit[name],
            )
            for (name, written), rows in zip(exported.axes.items(), table_map.shape, strict=True)
        )  # fmt: skip
        grids = [_grid(label(first, _name(part, x)), x, axes, exported) for x in exported.columns]
        parts = (sliced(grid) if len(grid.axes) > most_axes else [grid] for grid in grids)
        yield axes, [*chain.from_iterable(parts)]


def _grid(name: str, column: str, axes: tuple[Axis, ...], exported: WrittenMap) -> Grid:
    """Return a column of a map as a grid with the label ``name``."""
    columns, written = exported.columns, exported.columns[column]
    quantity, underscore, end = column.rpartition("_")
    is_bound = underscore + end in _BOUNDS
    meaning = f"{end} 95 % bound of {_COLUMNS[quantity]}" if is_bound else _COLUMNS[column]
    lower, upper = (columns.get(column + bound) for bound in _BOUNDS)
    bounds = (lower.values, upper.values) if lower and upper else None
    grid = Grid(name, meaning, UNIT, written.values, written.fixed, column, bounds, axes=axes)
    return _cut(grid, 0) if column in _FLAT else grid


def _cut(grid: Grid, index: int) -> Grid:
    """Return a map at one value of its last axis, without that axis."""
    part, bounds = slice(index, None, grid.shape[-1]), grid.bounds  # the last axis is the fastest
    return replace(
        grid,
        values=grid.values[part],
        fixed=replace(grid.fixed, raw=grid.fixed.raw[part]) if grid.fixed else None,
        axes=grid.axes[:-1],
        bounds=(bounds[0][part], bounds[1][part]) if bounds else None,
    )


def sliced(grid: Grid, values: Sequence[float] = ()) -> list[Grid]:
    """Return NAME_s1, NAME_s2, ...: a map at each of ``values`` of its last axis, or at all."""
    return [
        replace(
            _cut(grid, grid.axis.numbers.index(x)), label=label(grid.label, f"s{i}"),
            meaning=f"{grid.meaning}, at {grid.axis.label} {x!r}",
        )
        for i, x in enumerate(values or grid.axis.numbers, 1)
    ]  # fmt: skip


def _scalars(table: Table, version: int, first: str, precision: Precision) -> Iterator[Scalar]:
    """Return the parameters of car, pads, tyres and known effects."""
    car, pads = table.vehicle, table.calibration
    axles = (("f", car.front), ("r", car.rear))

    def scalar(
        name: str, meaning: str, unit: str, value: float, sigma: float | None = None
    ) -> Scalar:
        written = precision.wide.numbers(np.array([float(value)]))
        return Scalar(label(first, name), meaning, unit, written.values, written.fixed, sigma)

    yield scalar("version", "version of the table", "1", version)
    yield scalar("mass", "M_v, vehicle mass", "kg", car.mass)
    yield scalar("l_f", "l_f, centre of gravity to front axle", "m", car.cg_to_front_axle)
    yield scalar("l_r", "l_r, centre of gravity to rear axle", "m", car.cg_to_rear_axle)
    yield scalar("h", "h, height of the centre of gravity", "m", car.cg_height)
    yield scalar("l_w", "l_w, track width", "m", car.track_width)
    for a, axle in axles:
        gain = f"C of (3): torque of one wheel over mu P, {a}"
        yield scalar(f"R_{a}", f"R, rolling radius, {a}", "m", axle.rolling_radius)
        yield scalar(f"J_{a}", f"J_w, inertia of one wheel, {a}", "kg*m^2", axle.wheel_inertia)
        yield scalar(f"C_{a}", gain, "m^3", axle.torque_gain)
    for a, mu in (("f", pads.pad_friction_f), ("r", pads.pad_friction_r)):
        meaning = f"{AXLE_NAMES[a]} pad friction of the calibration"
        yield scalar(f"mu_{a}", meaning, "1", mu.value, mu.sigma)
    for a, axle in axles:
        meaning = f"{AXLE_NAMES[a]} pad friction of the vehicle file"
        yield scalar(f"mu_n_{a}", meaning, "1", axle.pad_friction)
    for name, meaning, x in (
        ("log_pad_ratio", "ln of mu_f/mu_r over the file's", pads.pad_log_ratio),
        ("slip_stiffness", "slip stiffness of the tyres of the calibration", pads.slip_stiffness),
    ):
        yield scalar(name, meaning, "1", x.value, x.sigma)
    for name in ("load_exponent", "radius_load"):
        drawn = getattr(table.draws, name)
        yield scalar(name, f"{name} of the tyres", "1", np.mean(drawn), float(np.std(drawn)))
    for figure in effect_figures(table):
        short = _SHORT.get((figure.effect, figure.name), f"{figure.effect}_{figure.name}")
        value, meaning = figure.value, f"{figure.name} of {figure.effect}"
        yield scalar(short, meaning, figure.unit, value.value, value.sigma)
