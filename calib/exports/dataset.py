"""A version of a table as calibration tools use it: axes, curves and maps, scalars, their origin.

Every format writes one `Dataset`, on all rows of the table or on the best selection of them, in
double or in fixed point.
"""

import hashlib
import re
import unicodedata
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import partial
from typing import ClassVar

import numpy as np

from calib.base.arrays import Array, Index
from calib.base.intervals import Z95
from calib.base.names import AXLE_NAMES
from calib.car.effects.combined import not_sensed, sensed
from calib.store.evidence import PRELIMINARY, UNPROVED, Quality
from calib.store.figures import effect_figures
from calib.store.version import Stored
from calib.table.breakpoints import Misfit, misfit
from calib.table.exported import LEAST_BITS, Precision, WrittenMap, written_map
from calib.table.fixed_point import Fixed
from calib.table.maps import MAPS
from calib.table.table import Table

LONGEST, LONGEST_PREFIX = 31, 16
"""Characters of a label (significant in every C99 compiler), and of its first part."""

_MARK = 4
"""Digits of the digest behind a shortened name."""

_CLAMP = (
    "outside an axis the value at its nearest end holds (clamped, never extrapolated); "
    "the estimator marks such samples as not valid"
)
"""Values of a look-up beyond the ends, as in `calib.estimation.baselines`."""

UNIT = "1"
"""Unit of every axis and curve: speed ratios, slips and normalised forces."""

_NOT = "NOT RELEASED, not for use in a vehicle: "
"""Before the state of a version that is not released, in every format."""

SHORT = {
    ("aerodynamic_drag", "drag_area"): "drag_area",
    ("rolling_resistance", "coefficient"): "rolling_coeff",
}
"""Short words for the effects that nearly every table has; other names are in full, and cut."""


def prefix(name: str) -> str:
    """Label of a table's name, at most 16 characters.

    >>> prefix("sedan-2up"), prefix("2up"), prefix("Müller")
    ('sedan_2up', 't_2up', 'Muller_a784')
    """
    plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode()
    word = re.sub(r"[^A-Za-z0-9]+", "_", plain).strip("_")
    if not word[:1].isalpha():
        word = f"t_{word}".rstrip("_")
    whole = re.fullmatch(r"[A-Za-z0-9._-]+", name) is not None
    return word if whole and len(word) <= LONGEST_PREFIX else _marked(word, name, LONGEST_PREFIX)


def label(*parts: str) -> str:
    """Label of one curve or scalar, at most 31 characters.

    >>> label("sedan_2up", "f1")
    'sedan_2up_f1'
    """
    whole = "_".join(parts)
    return whole if len(whole) <= LONGEST else _marked(whole, whole, LONGEST)


def _marked(word: str, name: str, longest: int) -> str:
    mark = hashlib.sha256(name.encode("utf-8", "surrogatepass")).hexdigest()[:_MARK]
    return f"{word[: longest - _MARK - 1].rstrip('_')}_{mark}"


_NONE_GIVEN = (
    "all addresses are 0 and little endian is assumed: `tables export --elf FILE` takes them from "
    "the linked program"
)


@dataclass(frozen=True)
class Addresses:
    """Address of each object by label, and the byte order; ``remarks`` on what was assumed."""

    by_label: dict[str, int] = field(default_factory=dict)
    big_endian: bool = False
    remarks: tuple[str, ...] = (_NONE_GIVEN,)

    def of(self, name: str) -> int:
        """Address of an object; 0 where no program was given."""
        return self.by_label.get(name, 0)


@dataclass(frozen=True)
class Object:
    """What has a label: ``values`` (n,) in ``unit``; ``fixed`` the same in fixed point, or None."""

    label: str
    meaning: str
    unit: str
    values: Array
    fixed: Fixed | None
    kind: ClassVar[str]

    @property
    def numbers(self) -> list[float]:
        """The values as Python's own floats: their texts read back to the last bit."""
        return [float(x) for x in self.values]

    @property
    def span(self) -> str:
        """Range of the values, in words."""
        return f"range {min(self.numbers)!r} to {max(self.numbers)!r}"

    @property
    def band(self) -> Array:
        """Values that the limits of the object must hold."""
        return self.values


@dataclass(frozen=True)
class Axis(Object):
    """Breakpoints, strictly increasing; ``shared`` by several curves, or the own axis of one.

    ``rows`` of the table; ``misfit`` between the breakpoints; ``origin`` of the fixed point.
    """

    shared: bool
    origin: float
    rows: int
    misfit: Misfit
    kind = "AXIS_PTS"

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
            f"(at {m.at:.8g}), rms {m.rms:.6g}"
        )


@dataclass(frozen=True)
class Curve(Object):
    """Values over ``axis`` with their 95 % band, counts and flags; shapes (n,)."""

    axis: Axis
    lower: Array
    upper: Array
    count: Array
    flag: Array
    kind = "CURVE"

    @property
    def band(self) -> Array:
        """Values and their band."""
        return np.concatenate((self.values, self.lower, self.upper))

    @property
    def axes(self) -> tuple[Axis]:
        """The one axis."""
        return (self.axis,)

    @property
    def fixed_misfit(self) -> float | None:
        """Largest error of the curve over its axis when both are rounded; None in double."""
        if self.fixed is None or self.axis.fixed is None:
            return None
        x, y = self.axis.fixed.values, self.fixed.values
        return misfit(self.axis.values, self.values[None], x, y[None]).worst


@dataclass(frozen=True)
class Grid(Object):
    """Values (n,) over every combination of ``axes``, row-major, the first axis the slowest.

    ``column`` of the table's map; ``bounds`` its 95 % bounds, if it has any.
    """

    axes: tuple[Axis, ...]
    column: str
    bounds: tuple[Array, Array] | None

    @property
    def axis(self) -> Axis:
        """The axis along which the values lie side by side."""
        return self.axes[-1]

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of breakpoints of each axis."""
        return tuple(len(axis.values) for axis in self.axes)

    @property
    def is_bound(self) -> bool:
        """Whether it is a bound of another grid."""
        return self.column.endswith(("_lower", "_upper"))


class LineGrid(Grid):
    """Over one axis."""

    kind = "CURVE"


class PlaneGrid(Grid):
    """Over two axes."""

    kind = "MAP"


class CubeGrid(Grid):
    """Over three axes."""

    kind = "CUBOID"


_GRIDS = {1: LineGrid, 2: PlaneGrid, 3: CubeGrid}

MOST_AXES = max(_GRIDS)
"""Number of axes of the largest map."""


@dataclass(frozen=True)
class Scalar(Object):
    """One number; ``sigma`` one standard deviation where it was fitted."""

    sigma: float | None
    kind = "VALUE"

    @property
    def band(self) -> Array:
        """The 95 % band."""
        return self.values + Z95 * (self.sigma or 0.0) * np.array([-1.0, 1.0])


Numbers = tuple[float, ...]


@dataclass(frozen=True)
class Content:
    """The bare numbers: shared axes, curves as (x, y), scalars, each by label.

    ``maps`` as their axes, the slowest first, and their values.
    """

    axes: dict[str, Numbers]
    curves: dict[str, tuple[Numbers, Numbers]]
    scalars: dict[str, float]
    maps: dict[str, tuple[tuple[Numbers, ...], Numbers]] = field(default_factory=dict)

    def __len__(self) -> int:
        """Number of the objects."""
        return len(self.axes) + len(self.curves) + len(self.scalars) + len(self.maps)

    @property
    def checksum(self) -> str:
        """SHA-256 over labels and numbers with all their bits [hex]."""
        lines = [f"scalar {n} {float(v).hex()}" for n, v in sorted(self.scalars.items())]
        lines += [f"axis {n} {_hex(v)}" for n, v in sorted(self.axes.items())]
        lines += [f"curve {n} {_hex(x)} of {_hex(y)}" for n, (x, y) in sorted(self.curves.items())]
        for n, (over, y) in sorted(self.maps.items()):
            lines.append(f"map {n} {' by '.join(map(_hex, over))} of {_hex(y)}")
        return hashlib.sha256("\n".join(lines).encode()).hexdigest()


def _hex(values: Numbers) -> str:
    return " ".join(v.hex() for v in values)


@dataclass(frozen=True)
class Dataset:
    """The exported data of ``stored``, in integers of ``bits``, in ``single`` precision or double.

    ``date`` of the export, for CDF: a table has none. ``addresses`` for A2L.
    """

    stored: Stored
    prefix: str
    axes: tuple[Axis, ...]
    curves: tuple[Curve, ...]
    grids: tuple[Grid, ...]
    scalars: tuple[Scalar, ...]
    quality: Quality
    bits: int | None
    single: bool
    date: str
    addresses: Addresses = Addresses()

    @property
    def id(self) -> str:
        """Name and version of the table."""
        return self.stored.id

    @property
    def objects(self) -> tuple[Object, ...]:
        """Axes, curves, maps, scalars."""
        return (*self.axes, *self.curves, *self.grids, *self.scalars)

    @property
    def lines(self) -> tuple[Curve | Grid, ...]:
        """What has one axis: curves, and maps of one axis."""
        return (*self.curves, *(one for one in self.grids if len(one.axes) == 1))

    @property
    def maps(self) -> tuple[Grid, ...]:
        """Maps of more axes."""
        return tuple(one for one in self.grids if len(one.axes) > 1)

    @property
    def numbers(self) -> str:
        """How the numbers of a file for an ECU are written."""
        floating = "float" if self.single else "double"
        if self.bits is None:
            return floating
        wide = "; scalars and axes of maps int16_t" * (self.maps != () and self.bits < LEAST_BITS)
        return f"int{self.bits}_t, value = origin + step * raw{wide}"

    def content(self) -> Content:
        """The bare numbers."""
        return Content(
            {a.label: tuple(a.numbers) for a in self.axes if a.shared},
            {c.label: (tuple(c.axis.numbers), tuple(c.numbers)) for c in self.lines},
            {s.label: s.numbers[0] for s in self.scalars},
            {
                m.label: (tuple(tuple(a.numbers) for a in m.axes), tuple(m.numbers))
                for m in self.maps
            },
        )

    @property
    def _effects(self) -> dict[str, str]:
        """Known effects that the ECU has to take out, and those that it cannot."""
        effects = self.stored.table.vehicle.effects
        beyond = not_sensed(effects)
        told = {
            "effects to take out": ", ".join(sensed(effects).described),
            "effects not known to the ECU": "; ".join(f"{k}: {why}" for k, why in beyond.items()),
        }
        return {key: text for key, text in told.items() if text}

    def facts(self) -> dict[str, str]:
        """Facts that every file states, by key."""
        stored, table, content = self.stored, self.stored.table, self.content()
        parents = ", ".join(parent.id for parent in table.provenance.parents)
        return {
            "table": stored.id,
            "version": str(stored.version),
            "digest": stored.digest,
            "program": table.provenance.program,
            "vehicle": table.vehicle.name,
            **({"parents": parents} if parents else {}),
            **self._effects,
            "ends": _CLAMP,
            **{f"breakpoints {a.label}": a.placed for a in self.axes},
            "validation": self.quality.words,
            "state": self.quality.state,
            "release": ("" if stored.state.released else _NOT) + stored.state.why,
            "objects": str(len(content)),
            "checksum": content.checksum,
        }


def build(
    stored: Stored,
    points: int | None = None,
    quality: Quality = UNPROVED,
    bits: int | None = None,
    date: str = "",
    *,
    single: bool = False,
    most_axes: int = MOST_AXES,
    first: str | None = None,
) -> Dataset:
    """The data set of ``stored``, with ``points`` breakpoints on each axis or all rows.

    ``most_axes`` of a map that the format can hold: one of more is written in slices; ``first``
    part of every label, of the table's name if not given. Raises ExchangeError for more points than
    rows, a width that C does not have, and a rounded axis that does not increase.
    """
    table, how = stored.table, Precision(points, bits, single)
    first = prefix(stored.name if first is None else first)
    p, d, g = table.paper, table.difference, table.tyre
    ratio = "eta = omega_rear/omega_front, zeroed while rolling unbraked"
    force = "normalised force over slip, common tyre curve"
    paper: list[_Row] = [
        ("f1", "f1 = F_f - z", p.f1, p.f1_lower, p.f1_upper, p.count, p.flag),
        ("f2", "f2 = F_r - z", p.f2, p.f2_lower, p.f2_upper, p.count, p.flag),
    ]
    gap: list[_Row] = [("D", "D = F_f - F_r", d.D, d.lower, d.upper, d.count, d.flag)]
    tyre: list[_Row] = [("g", force, g.force, g.lower, g.upper, g.count, g.flag)]
    over_eta = [("eta", p.eta, [*paper, *gap])]
    if not np.array_equal(p.eta, d.eta):
        over_eta = [("eta", p.eta, paper), ("eta_D", d.eta, gap)]
    group = partial(_group, first, how)
    groups = [group((name, ratio, x, True, 1.0), over) for name, x, over in over_eta]
    groups.append(group(("slip", "slip of the wheel", g.slip, False, 0.0), tyre))
    maps = [*maps_of(table, first, how, most_axes)]
    return Dataset(
        stored=stored,
        prefix=first,
        axes=(*(axis for axis, _ in groups), *(axis for axes, _ in maps for axis in axes)),
        curves=tuple(curve for _, curves in groups for curve in curves),
        grids=tuple(grid for _, grids in maps for grid in grids),
        scalars=tuple(_scalars(table, stored.version, first, how)),
        quality=quality if stored.state.released else replace(quality, state=PRELIMINARY),
        bits=bits,
        single=single,
        date=date,
    )


_Row = tuple[str, str, Array, Array, Array, Array, Array]
"""Name, meaning, values, band, counts and flags of a curve."""


def _group(
    first: str,
    how: Precision,
    axis: tuple[str, str, Array, bool, float],
    over: list[_Row],
) -> tuple[Axis, list[Curve]]:
    """An axis (name, meaning, values, shared, origin) and its curves, on the rows that are kept."""
    name, meaning, x, shared, origin = axis
    y = np.array([values for _, _, values, *_ in over])
    name = label(first, name)
    kept = how.rows(name, x, y)
    error, written = misfit(x, y, x[kept], y[:, kept]), how.axis(name, x[kept], origin)
    made = Axis(name, meaning, UNIT, *written, shared, origin, len(x), error)
    return made, [_curve(first, how, made, kept, *row) for row in over]


def _curve(
    first: str, how: Precision, axis: Axis, kept: Index, name: str, meaning: str, *columns: Array
) -> Curve:
    values, *others = (column[kept] for column in columns)
    return Curve(label(first, name), meaning, UNIT, *how.numbers(values), axis, *others)


_AXES = {
    "z": "z, brake force that the deceleration demands over M g, zeroed while rolling",
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
    "prior": "share of the ratio that is prior",
}
_BOUNDS = ("_lower", "_upper")

_FLAT = {"log_slip", "log_slip_sigma", "share"}
"""Columns that are the same along the last axis, and are written without it."""


def _name(part: str, name: str) -> str:
    """An axis or a column of a map in its label.

    >>> _name("map", "slip"), _name("level_map", "z"), _name("level_map", "ratio_lower")
    ('slip_apart', 'z_level', 'ratio_0_lower')
    """
    if part == "level_map":
        of, _, end = name.partition("_")
        return {"z": "z_level", "level": name}.get(of, f"{of}_0_{end}".rstrip("_"))
    return "slip_apart" if name == "slip" else name


def maps_of(
    table: Table, first: str, how: Precision, most_axes: int
) -> Iterator[tuple[tuple[Axis, ...], list[Grid]]]:
    """Axes and columns of each map; those with more axes than a format holds in slices."""
    for part in MAPS:
        if (held := getattr(table, part)) is None:
            continue
        made = written_map(held, how, label(first, part))
        axes = tuple(
            Axis(
                label(first, _name(part, name)), _AXES[name], UNIT, *written,
                shared=True, origin=0.0, rows=rows, misfit=made.misfit[name],
            )
            for (name, written), rows in zip(made.axes.items(), held.shape, strict=True)
        )  # fmt: skip
        whole = [_grid(label(first, _name(part, x)), x, axes, made) for x in made.columns]
        slices = [_slices(one) if len(one.axes) > most_axes else [one] for one in whole]
        yield axes, [one for some in slices for one in some]


def _grid(name: str, column: str, axes: tuple[Axis, ...], made: WrittenMap) -> Grid:
    end = next((end for end in _BOUNDS if column.endswith(end)), "")
    of = _COLUMNS[column.removesuffix(end)]
    meaning = f"{end[1:]} 95 % bound of {of}" if end else of
    ends = [made.columns[column + e].values for e in _BOUNDS if column + e in made.columns]
    bounds = (ends[0], ends[1]) if ends else None
    whole = _GRIDS[len(axes)](name, meaning, UNIT, *made.columns[column], axes, column, bounds)
    return _cut(whole, 0) if column in _FLAT else whole


def _cut(one: Grid, at: int) -> Grid:
    """A map at one value of its last axis, without that axis."""
    step = one.shape[-1]
    fixed, bounds = one.fixed, one.bounds
    return _GRIDS[len(one.axes) - 1](
        one.label,
        one.meaning,
        one.unit,
        one.values[at::step],
        fixed and replace(fixed, raw=fixed.raw[at::step]),
        one.axes[:-1],
        one.column,
        bounds and (bounds[0][at::step], bounds[1][at::step]),
    )


def _slices(one: Grid) -> list[Grid]:
    """A map at each value of its last axis: NAME_s1 at the first, and so on."""
    return [
        replace(
            _cut(one, i), label=label(one.label, f"s{i + 1}"),
            meaning=f"{one.meaning}, at {one.axis.label} {x!r}",
        )
        for i, x in enumerate(one.axis.numbers)
    ]  # fmt: skip


def _scalars(table: Table, version: int, first: str, how: Precision) -> Iterator[Scalar]:
    car, pads, tyre = table.vehicle, table.calibration, table.posterior
    mapped = table.map is not None
    wide = how.wide if mapped else how

    def scalar(name: str, what: str, unit: str, value: float, sigma: float | None = None) -> Scalar:
        written = wide.numbers(np.array([float(value)]))
        return Scalar(label(first, name), what, unit, *written, sigma)

    yield scalar("version", "version of the table", "1", version)
    yield scalar("mass", "M_v, vehicle mass", "kg", car.mass)
    yield scalar("l_f", "l_f, centre of gravity to front axle", "m", car.cg_to_front_axle)
    yield scalar("l_r", "l_r, centre of gravity to rear axle", "m", car.cg_to_rear_axle)
    yield scalar("h", "h, height of the centre of gravity", "m", car.cg_height)
    yield scalar("l_w", "l_w, track width", "m", car.track_width)
    for a, axle in (("f", car.front), ("r", car.rear)):
        gain = f"C of (3): torque of one wheel over mu P, {a}"
        yield scalar(f"R_{a}", f"R, rolling radius, {a}", "m", axle.rolling_radius)
        yield scalar(f"J_{a}", f"J_w, inertia of one wheel, {a}", "kg*m^2", axle.wheel_inertia)
        yield scalar(f"C_{a}", gain, "m^3", axle.torque_gain)
    for a, mu in (("f", pads.pad_friction_f), ("r", pads.pad_friction_r)):
        what = f"{AXLE_NAMES[a]} pad friction of the calibration"
        yield scalar(f"mu_{a}", what, "1", mu.value, mu.sigma)
    for a, axle in (("f", car.front), ("r", car.rear)) if mapped else ():
        what = f"{AXLE_NAMES[a]} pad friction of the vehicle file"
        yield scalar(f"mu_n_{a}", what, "1", axle.pad_friction)
    for name in tyre.names:
        yield scalar(name, f"{name} of the tyre", "1", tyre.value(name), tyre.sigma(name))
    for of in effect_figures(table):
        short = SHORT.get((of.effect, of.name), f"{of.effect}_{of.name}")
        value, what = of.value, f"{of.name} of {of.effect}"
        yield scalar(short, what, of.unit, value.value, value.sigma)
