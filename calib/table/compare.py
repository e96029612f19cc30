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

TOLERANCE = 1e-5  # of a difference, over the largest number of the list or column [1]
_VALUE = {"value", "sigma"}  # keys of a fitted value in a record: both count as one list
_RESULTS = ("calibration", "effects", "noise", "quality")  # sections with numbers of the fit
_SHARE_OF_CELLS = 0.95  # that must be within the 95 % bands, as bands promise no more [1]


@dataclass(frozen=True)
class _Curve(Map):
    """A curve as a map over one axis: ``z`` is here eta or slip."""

    value: Array
    value_lower: Array
    value_upper: Array


@dataclass(frozen=True)
class _CurveGap:
    """Difference b - a of a ``curve`` or a column of a map, where the axes overlap [1]."""

    curve: str
    start: float  # of the overlap: on the axis eta, slip or, for a map, z
    end: float
    largest: float  # difference of the largest magnitude
    at: float  # place of `largest` on that axis
    in_bands: float
    """95 % quantile of |b - a| over the combined half width of both bands, in all cells; those of a
    pad map count by their share of the stops."""


@dataclass(frozen=True)
class _RecordChange:
    """A key of the records that differs: JSON of its value in each table, None if it is missing."""

    key: str
    a: str | None
    b: str | None


@dataclass(frozen=True)
class _ValueGap:
    """A fitted value of both tables [1]."""

    name: str
    a: float
    b: float
    in_bands: float  # magnitude of the difference over the combined half width


@dataclass(frozen=True)
class Difference:
    """Differences of two tables."""

    curves: tuple[_CurveGap, ...]  # of curves, and of columns of maps
    apart: tuple[str, ...]  # names of the curves and columns whose axes do not overlap
    values: tuple[_ValueGap, ...]  # of pads and tyres
    changes: dict[str, tuple[_RecordChange, ...]]  # by section, such as vehicle or quality
    identical: bool  # whether nothing differs, not even the draws

    @property
    def verdict(self) -> str:
        """`equal`, `equal within bands` (no difference exceeds the 95 % bands) or `different`."""
        if self.identical:
            return "equal"
        gaps = [gap.in_bands for gap in self.curves] + [gap.in_bands for gap in self.values]
        is_outside = max(gaps, default=0.0) > 1.0
        return "different" if self.apart or is_outside else "equal within bands"


def diff(a: Table, b: Table) -> Difference:
    """Compare two tables: curves, maps, fitted pads and tyres, and the keys of the records."""
    curves_b, values_b = _curves(b), vars(b.calibration)
    gaps = {
        name: _gap(name, column, curve, curves_b[name][0])
        for name, (curve, column) in _curves(a).items()
    }
    return Difference(
        curves=tuple(gap for gap in gaps.values() if gap is not None),
        apart=tuple(name for name, gap in gaps.items() if gap is None),
        values=tuple(_value_gap(n, x, values_b[n]) for n, x in vars(a.calibration).items()),
        changes=changes(a, b),
        identical=a.digest == b.digest,
    )


def _curves(table: Table) -> dict[str, tuple[Map, str]]:
    """Curves and bounded columns of maps, each as a map and a column, by names like "map ratio"."""
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
    """Return the gap of a column; None if the axes of ``a`` and ``b`` do not overlap."""
    axes = []
    for x, y in zip(a.axes.values(), b.axes.values(), strict=True):
        # both maps are linear between these points, so the gap is largest at one of them
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
    """Quantile `_SHARE_OF_CELLS` of ``x`` (n,) with ``weights`` (n,); 0 without weights."""
    order = np.argsort(x)
    cumulative = np.cumsum(weights[order])
    if cumulative[-1] <= 0.0:
        return 0.0
    return float(x[order][np.searchsorted(cumulative, _SHARE_OF_CELLS * cumulative[-1])])


def _value_gap(name: str, a: Value, b: Value) -> _ValueGap:
    half_width = np.array(Z95 * math.hypot(a.sigma, b.sigma))
    in_bands = _in_bands(np.array(b.value - a.value), half_width)
    return _ValueGap(name, a.value, b.value, float(in_bands))


def _in_bands(gap: Array, half_width: Array) -> Array:
    """Magnitudes of gaps over half widths: 0 without a gap, infinite without a band."""
    in_bands = np.where(gap == 0.0, 0.0, math.inf)
    np.divide(np.abs(gap), half_width, out=in_bands, where=(half_width > 0.0) & (gap != 0.0))
    return in_bands


def changes(a: Table, b: Table) -> dict[str, tuple[_RecordChange, ...]]:
    """Return the keys in which the records of two tables differ, by section."""
    first, second = _flat(_record(a)), _flat(_record(b))
    changed: dict[str, tuple[_RecordChange, ...]] = {}
    for key in sorted({*first, *second}):
        if first.get(key) != second.get(key):
            section, _, subkey = key.partition(".")  # no subkey in a section of one value
            change = _RecordChange(subkey or section, first.get(key), second.get(key))
            changed[section] = (*changed.get(section, ()), change)
    return changed


def _record(table: Table) -> dict[str, Any]:
    """Return the record without long lists of numbers: scatter of D, fingerprints of logs."""
    record, _ = table.content()
    record.get("spread", {}).pop("D", None)
    for log in record["provenance"]["logs"]:
        log.pop("fingerprint", None)
    return record


def _flat(value: object, path: str = "") -> dict[str, str]:
    """Return the numbers and texts in a JSON value, as JSON by dotted key.

    The key of an item of a list is its name if all items have different names, else its position.
    """
    if isinstance(value, dict):
        items = value
    elif isinstance(value, list):
        names = [part["name"] for part in value if isinstance(part, dict) and "name" in part]
        have_names = len(set(names)) == len(value)
        keys = names if have_names else range(len(value))
        items = dict(zip(keys, value, strict=True))
    else:
        return {path: json.dumps(value)}
    values: dict[str, str] = {}
    for key, part in items.items():
        values |= _flat(part, f"{path}.{key}" if path else str(key))
    return values


def inputs_digest(record: dict[str, Any]) -> str:
    """SHA-256 of the inputs of the fit in a record: name, vehicle, logs, settings, program."""
    provenance = record["provenance"]
    # the numbers of a fingerprint follow from the log: only whether there is one counts
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
    if not isinstance(value, dict):
        yield path, np.asarray(value)
    elif value.keys() == _VALUE:
        yield path, np.array(list(value.values()))
    else:
        for key, part in value.items():
            yield from _numbers(part, f"{path}.{key}")


def _is_near(a: NDArray[Any], b: NDArray[Any]) -> bool:
    if a.shape != b.shape or a.dtype.kind not in "fi":
        return bool(np.array_equal(a, b))
    scale = max(np.max(np.abs(x), initial=0.0) for x in (a, b))
    return bool(np.all(np.abs(a - b) <= TOLERANCE * scale))
