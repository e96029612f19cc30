"""The differences of two tables, and whether both are the same fit.

Processors round sums in another order, so the numbers of one fit differ from the seventh digit on.
Two tables are the same fit where program, logs, vehicle and settings are equal, and no number
differs by more than `TOLERANCE`.
"""

import hashlib
import json
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calib.base.arrays import Array
from calib.base.digest import canonical_json
from calib.base.intervals import Z95
from calib.table.breakpoints import squared
from calib.table.maps import MAPS, Map, PadMap, columns
from calib.table.table import Table, Value

TOLERANCE = 1e-5
"""Largest difference of two numbers over the largest of their list or column [1].

A value is compared over itself or its sigma, whichever is larger.
"""
_VALUE = {"value", "sigma"}
"""Keys of a fitted value in a record."""
_RESULTS = ("calibration", "effects", "noise", "quality")
"""Sections of the record that hold numbers of the fit."""
_SURE = 0.95  # share of the stops that decides the verdict on a map [1]

_EQUAL, _WITHIN, _DIFFERENT = "equal", "equal within bands", "different"
"""Verdicts on two tables; the second where no difference exceeds the 95 % bands of both."""


@dataclass(frozen=True)
class _CurveGap:
    """Distance of one curve or map of ``b`` from that of ``a`` on their common axis [1].

    The axis is eta or slip; that of a map is z, over the part that both have of its other axes.
    ``largest`` the b - a of largest magnitude, ``at`` its place; ``rms`` over the axis, or over the
    cells of a map; ``in_bands`` largest magnitude over the combined 95 % half-width, infinite
    without a band.
    """

    curve: str
    start: float
    end: float
    largest: float
    at: float
    rms: float
    in_bands: float


@dataclass(frozen=True)
class _RecordChange:
    """One key of the records that differs; the JSON of both values, None where there is none."""

    key: str
    a: str | None
    b: str | None


@dataclass(frozen=True)
class _ValueGap:
    """A fitted value of ``a`` and ``b`` [1], and their distance as in `_CurveGap`."""

    name: str
    a: float
    b: float
    in_bands: float


@dataclass(frozen=True)
class Difference:
    """Differences of two tables.

    ``curves`` and maps with a common axis, names of those without one in ``apart``; ``values`` of
    pads and draws; ``changes`` of the record by section: vehicle, quality, provenance and so on.
    """

    curves: tuple[_CurveGap, ...]
    apart: tuple[str, ...]
    values: tuple[_ValueGap, ...]
    changes: dict[str, tuple[_RecordChange, ...]]

    @property
    def identical(self) -> bool:
        """Whether neither curves nor records differ."""
        moved = any(g.largest != 0.0 for g in self.curves) or any(v.a != v.b for v in self.values)
        return not self.changes and not self.apart and not moved

    @property
    def verdict(self) -> str:
        """`equal`; `equal within bands`, of 95 %; or `different`."""
        if self.identical:
            return _EQUAL
        gaps = [g.in_bands for g in self.curves] + [g.in_bands for g in self.values]
        return _DIFFERENT if self.apart or max(gaps, default=0.0) > 1.0 else _WITHIN


def diff(a: Table, b: Table) -> Difference:
    """Compare two tables: curves and maps on their common axes, records by key.

    Curves and maps are linear between rows; of the draws the means are compared.
    """
    curves_b, values_a, values_b = _axes(b), _values(a), _values(b)
    gaps = {name: _gap(name, curve, curves_b[name]) for name, curve in _axes(a).items()}
    gaps |= _map_gaps(a, b)
    return Difference(
        curves=tuple(gap for gap in gaps.values() if gap is not None),
        apart=tuple(name for name, gap in gaps.items() if gap is None),
        values=tuple(_value_gap(n, x, values_b[n]) for n, x in values_a.items() if n in values_b),
        changes=changes(a, b),
    )


def _values(table: Table) -> dict[str, Value]:
    """The pads, and mean and standard deviation of the draws."""
    draws = columns(table.draws).items()
    means = {f"draws {name}": Value(float(x.mean()), float(x.std())) for name, x in draws}
    return {**vars(table.calibration), **means}


def _map_gaps(a: Table, b: Table) -> dict[str, _CurveGap | None]:
    """The gap of each bounded column of the maps, named as "map ratio"; None of a map of one."""
    gaps: dict[str, _CurveGap | None] = {}
    for name in MAPS:
        first, second = getattr(a, name), getattr(b, name)
        axes = _common(first, second)
        for column in first.bounded:
            key = f"{name} {column}"
            gaps[key] = _map_gap(key, column, first.on(axes), second.on(axes)) if axes else None
    return gaps


def _common(a: Map, b: Map) -> list[Array]:
    """The values of the axes of both on the part that both have; empty where there is none."""
    axes = []
    for x, y in zip(a.axes.values(), b.axes.values(), strict=True):
        start, end = max(x[0], y[0]), min(x[-1], y[-1])
        values = np.union1d(x, y)
        axes.append(values[(values >= start) & (values <= end)])
    return axes if all(axis.size for axis in axes) else []


def _map_gap(name: str, column: str, a: Map, b: Map) -> _CurveGap:
    """Gap of one column of two maps on the same cells; they are linear in between.

    ``in_bands`` is that of 95 % of the stops, as 95 % bands promise no more; cells have the weight
    of their share of the stops.
    """
    gap = getattr(b, column) - getattr(a, column)
    ends = [(getattr(m, f"{column}_upper"), getattr(m, f"{column}_lower")) for m in (a, b)]
    band = np.hypot(*((upper - lower) / 2 for upper, lower in ends))
    # share of the stops in each cell; equal where the map has none
    shares = (m.share if isinstance(m, PadMap) else np.ones_like(m.z) for m in (a, b))
    in_bands = _quantile(_over(gap, band), np.minimum(*shares))
    return _gap_of(name, a.z, gap, float(np.mean(gap**2)), in_bands)


def _gap_of(name: str, x: Array, gap: Array, square: float, in_bands: float) -> _CurveGap:
    """The gap with its largest value; ``square`` is the mean of gap^2."""
    worst = int(np.argmax(np.abs(gap)))
    ends, largest = (float(x[0]), float(x[-1])), float(gap[worst])
    return _CurveGap(name, *ends, largest, float(x[worst]), math.sqrt(square), in_bands)


def _quantile(x: Array, weights: Array) -> float:
    """Quantile `_SURE` of ``x`` (n,) with ``weights`` (n,)."""
    order = np.argsort(x)
    below = np.cumsum(weights[order])
    return float(x[order][np.searchsorted(below, _SURE * below[-1])]) if below[-1] > 0.0 else 0.0


def _value_gap(name: str, a: Value, b: Value) -> _ValueGap:
    band = np.asarray(Z95 * math.hypot(a.sigma, b.sigma))
    return _ValueGap(name, a.value, b.value, _in_bands(np.asarray(b.value - a.value), band))


def _in_bands(gap: Array, band: Array) -> float:
    """Largest gap over its band; 0 where both are, as at eta = 1."""
    return float(np.max(_over(gap, band), initial=0.0))


def _over(gap: Array, band: Array) -> Array:
    """Gaps over their bands (n,); 0 where both are, infinite without a band."""
    over = np.where(gap == 0.0, 0.0, math.inf)
    np.divide(np.abs(gap), band, out=over, where=(band > 0.0) & (gap != 0.0))
    return over


def _axes(table: Table) -> dict[str, tuple[Array, Array, Array]]:
    """Axis, value and 95 % half-width of each curve."""
    d, p, g = table.difference, table.paper, table.tyre
    return {
        "D": (d.eta, d.D, (d.upper - d.lower) / 2),
        "f1": (p.eta, p.f1, (p.f1_upper - p.f1_lower) / 2),
        "f2": (p.eta, p.f2, (p.f2_upper - p.f2_lower) / 2),
        "g": (g.slip, g.force, (g.upper - g.lower) / 2),
    }


def _gap(
    name: str, a: tuple[Array, Array, Array], b: tuple[Array, Array, Array]
) -> _CurveGap | None:
    start, end = max(a[0][0], b[0][0]), min(a[0][-1], b[0][-1])
    if not start < end:
        return None
    # Both curves are linear between these points, so the largest gap is at one of them.
    x = np.union1d(a[0], b[0])
    x = np.union1d(x[(x >= start) & (x <= end)], [start, end])
    gap = np.interp(x, b[0], b[1]) - np.interp(x, a[0], a[1])
    band = np.hypot(np.interp(x, a[0], a[2]), np.interp(x, b[0], b[2]))
    return _gap_of(name, x, gap, squared(x, gap) / (x[-1] - x[0]), _in_bands(gap, band))


def changes(a: Table, b: Table) -> dict[str, tuple[_RecordChange, ...]]:
    """The keys of two records that differ, by section."""
    first, second = _flat(_record(a)), _flat(_record(b))
    changed: dict[str, tuple[_RecordChange, ...]] = {}
    for key in sorted({*first, *second}):
        if first.get(key) != second.get(key):
            section, _, subkey = key.partition(".")
            change = _RecordChange(subkey or section, first.get(key), second.get(key))
            changed[section] = (*changed.get(section, ()), change)
    return changed


def _record(table: Table) -> dict[str, Any]:
    """The record without one number for each row: the spread of D, fingerprints of logs."""
    record, _ = table.content()
    record.get("spread", {}).pop("D", None)
    for log in record["provenance"]["logs"]:
        log.pop("fingerprint", None)
    return record


def _flat(value: object, path: str = "") -> dict[str, str]:
    """Single values of a JSON value, by dotted key; logs by name, other lists by position."""
    if isinstance(value, dict):
        items = {str(key): part for key, part in value.items()}
    elif isinstance(value, list):
        names = [part["name"] for part in value if isinstance(part, dict) and "name" in part]
        named = len(set(names)) == len(value)
        items = dict(zip(names if named else map(str, range(len(value))), value, strict=True))
    else:
        return {path: json.dumps(value)}
    leaves: dict[str, str] = {}
    for key, part in items.items():
        leaves |= _flat(part, f"{path}.{key}" if path else key)
    return leaves


def inputs(record: dict[str, Any]) -> str:
    """SHA-256 over the inputs of the fit in a record, and over the program.

    Fingerprints follow from the logs, so their numbers do not count.
    """
    origin = record["provenance"]
    logs = [{**log, "fingerprint": "fingerprint" in log} for log in origin["logs"]]
    inputs_of_fit = {name: record.get(name) for name in ("name", "vehicle")}
    inputs_of_fit["provenance"] = {**origin, "logs": logs}
    return hashlib.sha256(canonical_json(inputs_of_fit)).hexdigest()


def same(a: Table, b: Table) -> bool:
    """Whether two tables have equal inputs, and numbers equal within `TOLERANCE`."""
    (record_a, curves_a), (record_b, curves_b) = a.content(), b.content()
    if inputs(record_a) != inputs(record_b):
        return False
    left, right = (
        dict(_leaves({**{name: record[name] for name in _RESULTS}, **curves}))
        for record, curves in ((record_a, curves_a), (record_b, curves_b))
    )
    return left.keys() == right.keys() and all(_near(left[key], right[key]) for key in left)


def _leaves(value: Any, path: str = "") -> Iterator[tuple[str, NDArray[Any]]]:
    """Numbers, lists and columns by dotted key; a fitted value is one of them."""
    if isinstance(value, dict) and value.keys() != _VALUE:
        for key, part in value.items():
            yield from _leaves(part, f"{path}.{key}")
    else:
        yield path, np.asarray([*value.values()] if isinstance(value, dict) else value)


def _near(a: NDArray[Any], b: NDArray[Any]) -> bool:
    if a.shape != b.shape or a.dtype.kind not in "fi":
        return bool(np.array_equal(a, b))
    scale = max(np.max(np.abs(x), initial=0.0) for x in (a, b))
    return bool(np.all(np.abs(a - b) <= TOLERANCE * scale))
