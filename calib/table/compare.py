"""The differences of two tables, and whether both are the same fit.

`diff` compares any two tables. `is_same_fit` asks whether program, logs, vehicle and settings are
equal and no number differs by more than `TOLERANCE`: processors add in different orders, so the
numbers of one fit may differ from the seventh digit on.
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
"""Largest difference of two numbers over the largest number of their list or column [1].

A fitted value and its sigma count as one list.
"""
_VALUE = {"value", "sigma"}
"""Keys of a fitted value in a record."""
_RESULTS = ("calibration", "effects", "noise", "quality")
"""Sections of the record that hold numbers of the fit."""
_SHARE_OF_CELLS = 0.95  # that must be within the 95 % bands, as bands promise no more [1]

_EQUAL, _WITHIN, _DIFFERENT = "equal", "equal within bands", "different"
"""Verdicts on two tables. Tables are within bands where no difference exceeds the 95 % bands."""


@dataclass(frozen=True)
class _Curve(Map):
    """A curve as a map over one axis: ``z`` is here eta or slip."""

    value: Array
    value_lower: Array
    value_upper: Array


@dataclass(frozen=True)
class _CurveGap:
    """Difference b - a of a curve or a column of a map, where their axes overlap [1].

    ``start`` and ``end`` are on the axis eta, slip or, for a map, z. ``largest`` is the difference
    of largest magnitude, ``at`` its place on that axis. ``in_bands`` is a magnitude over the
    combined half width of both 95 % bands: the one that 95 % of the cells do not exceed, infinite
    without a band. Cells of a map have the weight of their share of the stops.
    """

    curve: str
    start: float
    end: float
    largest: float
    at: float
    in_bands: float


@dataclass(frozen=True)
class _RecordChange:
    """A key of the records that differs: JSON of its value in each table, None if it is missing."""

    key: str
    a: str | None
    b: str | None


@dataclass(frozen=True)
class _ValueGap:
    """A fitted value of both tables [1], and its difference over the combined half width."""

    name: str
    a: float
    b: float
    in_bands: float


@dataclass(frozen=True)
class Difference:
    """Differences of two tables.

    ``curves`` are the curves and columns of maps whose axes overlap; ``apart`` names the others.
    ``values`` are the fitted values of the pads. ``changes`` are keys of the record by section,
    such as vehicle or quality. ``identical`` says that nothing differs, not even the draws.
    """

    curves: tuple[_CurveGap, ...]
    apart: tuple[str, ...]
    values: tuple[_ValueGap, ...]
    changes: dict[str, tuple[_RecordChange, ...]]
    identical: bool

    @property
    def verdict(self) -> str:
        """`equal`, `equal within bands` or `different`."""
        if self.identical:
            return _EQUAL
        gaps = [gap.in_bands for gap in self.curves] + [gap.in_bands for gap in self.values]
        return _DIFFERENT if self.apart or max(gaps, default=0.0) > 1.0 else _WITHIN


def diff(a: Table, b: Table) -> Difference:
    """Compare two tables: curves and maps where their axes overlap, pads, records by key."""
    curves_b, pads_b = _curves(b), vars(b.calibration)
    gaps = {
        name: _gap(name, column, curve, curves_b[name][0])
        for name, (curve, column) in _curves(a).items()
    }
    return Difference(
        curves=tuple(gap for gap in gaps.values() if gap is not None),
        apart=tuple(name for name, gap in gaps.items() if gap is None),
        values=tuple(_value_gap(n, x, pads_b[n]) for n, x in vars(a.calibration).items()),
        changes=changes(a, b),
        identical=a.digest == b.digest,
    )


def _curves(table: Table) -> dict[str, tuple[Map, str]]:
    """Each curve, and each bounded column of a map, as a map and the name of its column.

    The keys are names such as "D" and "map ratio".
    """
    d, p, g = table.difference, table.paper, table.tyre
    curves: dict[str, tuple[Map, str]] = {
        "D": (_Curve(d.eta, d.D, d.lower, d.upper), "value"),
        "f1": (_Curve(p.eta, p.f1, p.f1_lower, p.f1_upper), "value"),
        "f2": (_Curve(p.eta, p.f2, p.f2_lower, p.f2_upper), "value"),
        "g": (_Curve(g.slip, g.force, g.lower, g.upper), "value"),
    }
    for name in MAPS:
        part: Map = getattr(table, name)
        curves |= {f"{name} {column}": (part, column) for column in part.bounded_columns}
    return curves


def _gap(name: str, column: str, a: Map, b: Map) -> _CurveGap | None:
    """Return the gap of a column where the axes of ``a`` and ``b`` overlap, None if they do not."""
    axes = []
    for x, y in zip(a.axes.values(), b.axes.values(), strict=True):
        # both maps are linear between the values of both axes, so the largest gap is at a value
        values = np.union1d(x, y)
        axes.append(values[(values >= max(x[0], y[0])) & (values <= min(x[-1], y[-1]))])
    if not all(axis.size for axis in axes):
        return None
    a, b = a.on(axes), b.on(axes)
    gap = getattr(b, column) - getattr(a, column)
    half_widths = np.hypot(_half_widths(a, column), _half_widths(b, column))
    weights = np.ones_like(gap)
    if isinstance(a, PadMap) and isinstance(b, PadMap):
        weights = np.minimum(a.share, b.share)
    in_bands = _quantile(_in_bands(gap, half_widths), weights)
    worst = int(np.argmax(np.abs(gap)))
    start, end, place = float(a.z[0]), float(a.z[-1]), float(a.z[worst])
    return _CurveGap(name, start, end, float(gap[worst]), place, in_bands)


def _half_widths(m: Map, column: str) -> Array:
    """Half width of the 95 % band of a column in each cell (n,)."""
    upper: Array = getattr(m, f"{column}_upper")
    return np.asarray((upper - getattr(m, f"{column}_lower")) / 2)


def _quantile(x: Array, weights: Array) -> float:
    """Quantile `_SHARE_OF_CELLS` of ``x`` (n,) with ``weights`` (n,)."""
    order = np.argsort(x)
    cumulative = np.cumsum(weights[order])
    if cumulative[-1] <= 0.0:
        return 0.0
    return float(x[order][np.searchsorted(cumulative, _SHARE_OF_CELLS * cumulative[-1])])


def _value_gap(name: str, a: Value, b: Value) -> _ValueGap:
    gap, half_width = np.array([b.value - a.value]), Z95 * math.hypot(a.sigma, b.sigma)
    in_bands = float(_in_bands(gap, np.array([half_width]))[0])
    return _ValueGap(name, a.value, b.value, in_bands)


def _in_bands(gap: Array, half_widths: Array) -> Array:
    """Magnitudes of gaps over half widths (n,): 0 without a gap, infinite without a band."""
    in_bands = np.where(gap == 0.0, 0.0, math.inf)
    np.divide(np.abs(gap), half_widths, out=in_bands, where=(half_widths > 0.0) & (gap != 0.0))
    return in_bands


def changes(a: Table, b: Table) -> dict[str, tuple[_RecordChange, ...]]:
    """Return the keys in which the records of two tables differ, by section."""
    first, second = _flat(_record(a)), _flat(_record(b))
    changed: dict[str, tuple[_RecordChange, ...]] = {}
    for key in sorted({*first, *second}):
        if first.get(key) != second.get(key):
            section, _, subkey = key.partition(".")
            change = _RecordChange(subkey or section, first.get(key), second.get(key))
            changed[section] = (*changed.get(section, ()), change)
    return changed


def _record(table: Table) -> dict[str, Any]:
    """Return the record without its long lists of numbers: scatter of D, fingerprints of logs."""
    record, _ = table.content()
    record.get("spread", {}).pop("D", None)
    for log in record["provenance"]["logs"]:
        log.pop("fingerprint", None)
    return record


def _flat(value: object, path: str = "") -> dict[str, str]:
    """Return the single values of a JSON value, as JSON by dotted key.

    Items of a list have their position as key, or their names if all have different names.
    """
    if isinstance(value, dict):
        items = {str(key): part for key, part in value.items()}
    elif isinstance(value, list):
        names = [part["name"] for part in value if isinstance(part, dict) and "name" in part]
        have_names = len(set(names)) == len(value)
        keys = names if have_names else [str(i) for i in range(len(value))]
        items = dict(zip(keys, value, strict=True))
    else:
        return {path: json.dumps(value)}
    values: dict[str, str] = {}
    for key, part in items.items():
        values |= _flat(part, f"{path}.{key}" if path else key)
    return values


def inputs_digest(record: dict[str, Any]) -> str:
    """SHA-256 over the inputs of the fit in a record: name, vehicle, logs, settings, program.

    Fingerprints follow from the logs, so their numbers do not count.
    """
    provenance = record["provenance"]
    logs = [{**log, "fingerprint": "fingerprint" in log} for log in provenance["logs"]]
    inputs = {name: record.get(name) for name in ("name", "vehicle")}
    inputs["provenance"] = {**provenance, "logs": logs}
    return sha256(canonical_json(inputs))


def is_same_fit(a: Table, b: Table) -> bool:
    """Whether two tables have equal inputs, and numbers equal within `TOLERANCE`."""
    (record_a, curves_a), (record_b, curves_b) = a.content(), b.content()
    if inputs_digest(record_a) != inputs_digest(record_b):
        return False
    numbers_a = dict(_numbers({name: record_a[name] for name in _RESULTS} | curves_a))
    numbers_b = dict(_numbers({name: record_b[name] for name in _RESULTS} | curves_b))
    if numbers_a.keys() != numbers_b.keys():
        return False
    return all(_is_near(numbers_a[key], numbers_b[key]) for key in numbers_a)


def _numbers(value: Any, path: str = "") -> Iterator[tuple[str, NDArray[Any]]]:
    """Yield numbers, lists and columns with their dotted keys; a fitted value is one list."""
    if isinstance(value, dict) and value.keys() != _VALUE:
        for key, part in value.items():
            yield from _numbers(part, f"{path}.{key}")
    else:
        yield path, np.asarray(list(value.values()) if isinstance(value, dict) else value)


def _is_near(a: NDArray[Any], b: NDArray[Any]) -> bool:
    if a.shape != b.shape or a.dtype.kind not in "fi":
        return bool(np.array_equal(a, b))
    scale = max(np.max(np.abs(x), initial=0.0) for x in (a, b))
    return bool(np.all(np.abs(a - b) <= TOLERANCE * scale))
