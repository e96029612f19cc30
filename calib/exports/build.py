"""A version of a table as a `Dataset`, on all of its rows or on the best selection of them."""

from dataclasses import replace

import numpy as np

from calib.base.errors import ExchangeError
from calib.car.vehicle import Axle
from calib.exports.breakpoints import FEWEST, Indices, misfit, place
from calib.exports.dataset import BY_A_PERSON, Axis, Curve, Dataset, Scalar, label, prefix
from calib.store.evidence import PRELIMINARY, UNPROVED, Quality
from calib.store.figures import effect_figures
from calib.store.version import Stored
from calib.table.table import BY_HAND, Array, Table

UNIT = "1"
"""Unit of every axis and curve: speed ratios, slips and normalised forces."""

SHORT = {
    ("aerodynamic_drag", "drag_area"): "drag_area",
    ("rolling_resistance", "coefficient"): "rolling_coeff",
}
"""Short words for the effects that nearly every table has; other names are in full, and cut."""


def build(stored: Stored, points: int | None = None, quality: Quality = UNPROVED) -> Dataset:
    """The data set of ``stored``, with ``points`` breakpoints on each axis or all rows.

    Raises ExchangeError if the table has fewer rows than ``points``.
    """
    table, first = stored.table, prefix(stored.name)
    axes: list[Axis] = []
    curves: list[Curve] = []
    for axis, over in _groups(table, first):
        kept = _kept(axis, over, points)
        axes.append(_thin_axis(axis, over, kept))
        curves += [_thin(curve, kept) for curve in over]
    return Dataset(
        id=stored.id,
        version=stored.version,
        digest=stored.digest,
        program=table.provenance.program,
        vehicle=table.vehicle.name,
        prefix=first,
        axes=tuple(axes),
        curves=tuple(curves),
        scalars=tuple(_scalars(table, stored.version, first)),
        quality=quality if stored.state.released else replace(quality, state=PRELIMINARY),
        release=stored.state,
        parents=tuple(parent.id for parent in table.provenance.parents),
        by_hand=table.by_hand,
    )


def _groups(table: Table, first: str) -> list[tuple[Axis, list[Curve]]]:
    """Each axis with all rows, and the curves over it."""
    p, d, g = table.paper, table.difference, table.tyre
    name, same = label(first, "eta"), np.array_equal(p.eta, d.eta)
    own = name if same else label(first, "eta_D")
    bands_1, bands_2 = (p.f1_lower, p.f1_upper), (p.f2_lower, p.f2_upper)
    f1 = _curve(first, "f1", name, "f1 = F_f - z", p.f1, *bands_1, p.count, p.flag)
    f2 = _curve(first, "f2", name, "f2 = F_r - z", p.f2, *bands_2, p.count, p.flag)
    D = _curve(first, "D", own, "D = F_f - F_r", d.D, d.lower, d.upper, d.count, d.flag)
    eta = "eta = omega_rear/omega_front, zeroed while rolling unbraked"
    groups = [(_axis(name, eta, p.eta, True, 1.0), [f1, f2, D] if same else [f1, f2])]
    if not same:
        groups.append((_axis(own, eta, d.eta, True, 1.0), [D]))
    slip = label(first, "slip")
    what = "normalised force over slip, common tyre curve"
    tyre = _curve(first, "g", slip, what, g.force, g.lower, g.upper, g.count, g.flag)
    return [*groups, (_axis(slip, "slip of the wheel", g.slip, False, 0.0), [tyre])]


def _axis(name: str, meaning: str, x: Array, shared: bool, origin: float) -> Axis:
    return Axis(name, meaning, UNIT, x, shared, origin, len(x), misfit(x, x[None], x, x[None]))


def _curve(
    first: str, name: str, axis: str, meaning: str, y: Array, lower: Array, upper: Array,
    count: Array, flag: Array,
) -> Curve:  # fmt: skip
    rows = int(np.count_nonzero(flag == BY_HAND))
    if rows:
        meaning += f", {rows} row{'s' * (rows > 1)} {BY_A_PERSON}"
    return Curve(label(first, name), axis, meaning, UNIT, y, lower, upper, count, flag)


def _kept(axis: Axis, over: list[Curve], points: int | None) -> Indices:
    if points is None:
        return np.arange(axis.rows)
    if not FEWEST <= points <= axis.rows:
        raise ExchangeError(
            f"{points} breakpoints",
            where=axis.label,
            expected=f"{FEWEST} to {axis.rows}, the rows of the table",
        )
    return place(axis.values, np.array([c.values for c in over]), points)


def _thin_axis(axis: Axis, over: list[Curve], kept: Indices) -> Axis:
    x, y = axis.values, np.array([c.values for c in over])
    return replace(axis, values=x[kept], misfit=misfit(x, y, x[kept], y[:, kept]))


def _thin(c: Curve, kept: Indices) -> Curve:
    arrays = ("values", "lower", "upper", "count", "flag")
    return replace(c, **{name: getattr(c, name)[kept] for name in arrays})


def _scalars(table: Table, version: int, first: str) -> list[Scalar]:
    car, pads, tyre = table.vehicle, table.calibration, table.posterior

    def scalar(name: str, what: str, unit: str, value: float, sigma: float | None = None) -> Scalar:
        return Scalar(label(first, name), what, unit, float(value), sigma)

    mu_f, mu_r = pads.pad_friction_f, pads.pad_friction_r
    keys = {one.key for one in table.by_hand}
    of_f, of_r = (
        BY_A_PERSON if f"pad_friction_{axle}" in keys else "of the calibration" for axle in "fr"
    )
    return [
        scalar("version", "version of the table", "1", version),
        scalar("mass", "M_v, vehicle mass", "kg", car.mass),
        scalar("l_f", "l_f, centre of gravity to front axle", "m", car.cg_to_front_axle),
        scalar("l_r", "l_r, centre of gravity to rear axle", "m", car.cg_to_rear_axle),
        scalar("h", "h, height of the centre of gravity", "m", car.cg_height),
        scalar("l_w", "l_w, track width", "m", car.track_width),
        *(scalar(*row) for row in [*_wheel("f", car.front), *_wheel("r", car.rear)]),
        scalar("mu_f", f"front pad friction {of_f}", "1", mu_f.value, mu_f.sigma),
        scalar("mu_r", f"rear pad friction {of_r}", "1", mu_r.value, mu_r.sigma),
        *(
            scalar(name, f"{name} of the tyre", "1", tyre.value(name), tyre.sigma(name))
            for name in tyre.names
        ),
        *(
            scalar(
                SHORT.get((of.effect, of.name), f"{of.effect}_{of.name}"),
                f"{of.name} of {of.effect}",
                of.unit,
                of.value.value,
                of.value.sigma,
            )
            for of in effect_figures(table)
        ),
    ]


def _wheel(side: str, axle: Axle) -> list[tuple[str, str, str, float]]:
    return [
        (f"R_{side}", f"R, rolling radius, {side}", "m", axle.rolling_radius),
        (f"J_{side}", f"J_w, inertia of one wheel, {side}", "kg*m^2", axle.wheel_inertia),
        (f"C_{side}", f"C of (3): torque of one wheel over mu P, {side}", "m^3", axle.torque_gain),
    ]
