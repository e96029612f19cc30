"""The differences of two tables, and whether both are the same fit.

Processors round sums in another order, so the numbers of one fit differ from the seventh digit on.
Two tables are the same fit where program, logs, vehicle and settings are equal, and no number
differs by more than `TOLERANCE`.
"""

import json
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calib.base.arrays import Array
from calib.base.digest import canonical_json, sha256
from calib.base.intervals import Z95
from calib.table.maps import MAPS, Map, PadMap
from calib.table.table import Table, Value

TOLERANCE = 1e-5
"""Largest difference of two numbers over the largest of their list or column [1].

A value is compared over itself or its sigma, whichever is larger.
"""
_VALUE = {"value", "sigma"}
"""Keys of a fitted value in a record."""
_RESULTS = ("calibration", "effects", "noise", "quality")
"""Sections of the record that hold numbers of the fit."""
_SURE = 0.95  # share of the cells that decides the verdict [1]

_EQUAL, _WITHIN, _DIFFERENT = "equal", "equal within bands", "different"
"""Verdicts on two tables; the second where no difference exceeds the 95 % bands of both."""


@dataclass(frozen=True)
class _Curve(Map):
    """A curve as a map over one axis, which may be eta or slip."""

    value: Array
    value_lower: Array
    value_upper: Array


@dataclass(frozen=True)
class _CurveGap:
    """Distance of one curve or map of ``b`` from that of ``a`` on their common axes [1].

    The axis is eta or slip; that of a map is z, over the part that both have of its other axes.
    ``largest`` the b - a of largest magnitude, ``at`` its place; ``in_bands`` magnitude over the
    combined 95 % half-width that 95 % of the cells do not exceed, as 95 % bands promise no more;
    infinite without a band. Cells of a map have the weight of their share of the stops.
    """

    curve: str
    start: float
    end: float
    largest: float
    at: float
    in_bands: float


@dataclass(frozen=True)
class _RecordChange:
    """One key of the records that differs; the JSON of both values, None where there is none."""

    key: str
    a: str | None
    b: str | None


@dataclass(frozen=True)
class _ValueGap:
    """A fitted value of ``a`` and ``b`` [1], and their distance over the combined half-width."""

    name: str
    a: float
    b: float
    in_bands: float


@dataclass(frozen=True)
class Difference:
    """Differences of two tables.

    ``curves`` and maps with a common axis, names of those without one in ``apart``; ``values`` of
    the pads; ``changes`` of the record by section: vehicle, quality, provenance and so on;
    ``identical`` if nothing differs, not in the draws either.
    """

    curves: tuple[_CurveGap, ...]
    apart: tuple[str, ...]
    values: tuple[_ValueGap, ...]
    changes: dict[str, tuple[_RecordChange, ...]]
    identical: bool

    @property
    def verdict(self) -> str:
        """`equal`; `equal within bands`, of 95 %; or `different`."""
        if self.identical:
            return _EQUAL
        gaps = [g.in_bands for g in self.curves] + [g.in_bands for g in self.values]
        return _DIFFERENT if self.apart or max(gaps, default=0.0) > 1.0 else _WITHIN


def diff(a: Table, b: Table) -> Difference:
    """Compare two tables: curves and maps on their common axes, pads, records by key.

    Curves and maps are linear between rows.
    """
    others, pads = _curves(b), vars(b.calibration)
    gaps = {name: _gap(name, *one, others[name][0]) for name, one in _curves(a).items()}
    return Difference(
        curves=tuple(gap for gap in gaps.values() if gap is not None),
        apart=tuple(name for name, gap in gaps.items() if gap is None),
        values=tuple(_value_gap(n, x, pads[n]) for n, x in vars(a.calibration).items()),
        changes=changes(a, b),
        identical=a.digest == b.digest,
    )


def _curves(table: Table) -> dict[str, tuple[Map, str]]:
    """Each curve, and each bounded column of the maps, named as "map ratio"."""
    d, p, g = table.difference, table.paper, table.tyre
    curves: dict[str, tuple[Map, str]] = {
        "D": (_Curve(d.eta, d.D, d.lower, d.upper), "value"),
        "f1": (_Curve(p.eta, p.f1, p.f1_lower, p.f1_upper), "value"),
        "f2": (_Curve(p.eta, p.f2, p.f2_lower, p.f2_upper), "value"),
        "g": (_Curve(g.slip, g.force, g.lower, g.upper), "value"),
    }
    maps = {name: getattr(table, name) for name in MAPS}
    return curves | {f"{n} {column}": (m, column) for n, m in maps.items() for column in m.bounded}


def _gap(name: str, a: Map, column: str, b: Map) -> _CurveGap | None:
    """Gap of one column on the same cells; None where the axes have no part in common."""
    axes = []
    for x, y in zip(a.axes.values(), b.axes.values(), strict=True):
        values = np.union1d(x, y)  # both are linear between these, so the largest gap is at one
        axes.append(values[(values >= max(x[0], y[0])) & (values <= min(x[-1], y[-1]))])
    if not all(axis.size for axis in axes):
        return None
    a, b = a.on(axes), b.on(axes)
    gap = getattr(b, column) - getattr(a, column)
    ends = [(getattr(m, f"{column}_upper"), getattr(m, f"{column}_lower")) for m in (a, b)]
    band = np.hypot(*((upper - lower) / 2 for upper, lower in ends))
    shares = (m.share if isinstance(m, PadMap) else np.ones_like(m.z) for m in (a, b))
    in_bands = _quantile(_over(gap, band), np.minimum(*shares))
    worst = int(np.argmax(np.abs(gap)))
    start, end, largest, place = (float(x) for x in (a.z[0], a.z[-1], gap[worst], a.z[worst]))
    return _CurveGap(name, start, end, largest, place, in_bands)


def _quantile(x: Array, weights: Array) -> float:
    """Quantile `_SURE` of ``x`` (n,) with ``weights`` (n,)."""
    order = np.argsort(x)
    below = np.cumsum(weights[order])
    return float(x[order][np.searchsorted(below, _SURE * below[-1])]) if below[-1] > 0.0 else 0.0


def _value_gap(name: str, a: Value, b: Value) -> _ValueGap:
    gap, band = np.array([b.value - a.value]), np.array([Z95 * math.hypot(a.sigma, b.sigma)])
    return _ValueGap(name, a.value, b.value, float(_over(gap, band)[0]))


def _over(gap: Array, band: Array) -> Array:
    """Gaps over their bands (n,); 0 where both are, infinite without a band."""
    over = np.where(gap == 0.0, 0.0, math.inf)
    np.divide(np.abs(gap), band, out=over, where=(band > 0.0) & (gap != 0.0))
    return over


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
    return sha256(canonical_json(inputs_of_fit))


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
