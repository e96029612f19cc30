"""Conditions that every table must satisfy, whether its fit is good or not."""

from collections.abc import Iterator

import numpy as np

from calib.base.arrays import Array
from calib.base.digest import canonical_json
from calib.base.errors import not_finite
from calib.car.forces import axle_loads
from calib.table.maps import MAPS, Map, columns
from calib.table.table import COLUMNS, Table

_TOLERANCE = 1e-9  # of (18) [1]: a million times the rounding error, as f1 and f2 are below 1


def violations(table: Table) -> tuple[str, ...]:
    """Return the conditions that ``table`` violates, in words."""
    shapes = tuple(_shapes(table))
    if shapes:  # the other checks need columns of equal length
        return shapes
    checks = (_finite, _axes, _bands, _zero, _constraint)
    return tuple(flaw for check in checks for flaw in check(table))


def _parts(table: Table) -> Iterator[tuple[str, dict[str, Array]]]:
    """Yield the name and the columns of each curve and map, and of the draws."""
    for name in COLUMNS:
        yield name, columns(getattr(table, name))


def _shapes(table: Table) -> Iterator[str]:
    """Columns of a part must have one shape, (n,), with at least two rows."""
    for name, part in _parts(table):
        first, *others = sorted({column.shape for column in part.values()})
        if others or len(first) != 1:
            yield f"{name}: columns of different shapes {[first, *others]}"
        elif first[0] < 2:
            yield f"{name}: fewer than two rows"


def require_finite(table: Table) -> None:
    """Raise NotFiniteError with the name of the quantity if a number is not finite."""
    flaw = next(_finite(table), None)
    if flaw is not None:
        raise not_finite(flaw.partition(":")[0], table.name)  # the name is before the colon


def _finite(table: Table) -> Iterator[str]:
    for name, part in _parts(table):
        for key, column in part.items():
            if not np.all(np.isfinite(column)):
                yield f"{name}.{key}: not finite in row {int(np.argmin(np.isfinite(column)))}"
    record, _ = table.content()
    for key, value in record.items():
        try:
            canonical_json({key: value})
        except ValueError:
            yield f"{key}: holds a number that is not finite"


def _axes(table: Table) -> Iterator[str]:
    """Axes must increase, and maps must be complete."""
    d, p, g = table.difference, table.paper, table.tyre
    for name, axis in (("difference.eta", d.eta), ("paper.eta", p.eta), ("tyre.slip", g.slip)):
        if not np.all(np.diff(axis) > 0.0):
            yield f"{name}: does not increase from row to row"
    if not np.array_equal(d.eta, p.eta):
        yield "paper.eta: not that of difference"
    for name in MAPS:
        part: Map = getattr(table, name)
        if not part.is_complete:
            yield f"{name}: its rows are not every combination of {', '.join(part.AXES)} once"


def _bands(table: Table) -> Iterator[str]:
    """Each value must be within its own 95 % band."""
    d, p, g = table.difference, table.paper, table.tyre
    bands: dict[str, tuple[Array, Array, Array]] = {
        "difference.D": (d.lower, d.D, d.upper),
        "paper.f1": (p.f1_lower, p.f1, p.f1_upper),
        "paper.f2": (p.f2_lower, p.f2, p.f2_upper),
        "tyre.force": (g.lower, g.force, g.upper),
    }
    for name in MAPS:
        part = columns(getattr(table, name))
        for key in getattr(table, name).bounded_columns:
            bands[f"{name}.{key}"] = (part[f"{key}_lower"], part[key], part[f"{key}_upper"])
    for name, (lower, value, upper) in bands.items():
        if not np.all((lower <= value + 1e-12) & (value <= upper + 1e-12)):
            yield f"{name}: outside its own 95 % band"


def _zero(table: Table) -> Iterator[str]:
    """D must be 0 at eta = 1."""
    eta, D = table.difference.eta, table.difference.D
    if not eta[0] <= 1.0 <= eta[-1]:
        yield "difference.eta: does not reach 1"
        return
    D_at_one = float(np.interp(1.0, eta, D))
    if abs(D_at_one) > 1e-12:
        yield f"difference.D: {D_at_one:.3g} at eta = 1, where it must be 0"


def _constraint(table: Table) -> Iterator[str]:
    """Equation (18) must hold in every row."""
    paper = table.paper
    F_zf, F_zr = axle_loads(table.vehicle, paper.z)
    error = np.abs(paper.f1 + F_zr / F_zf * paper.f2)  # (18)
    worst = int(np.argmax(error))
    if not error[worst] <= _TOLERANCE:
        yield f"paper: (18) is off by {error[worst]:.3g} in row {worst}"
