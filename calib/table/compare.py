"""The differences of two tables, and whether they are one fit, computed on two kinds of computer.

Sums of floating-point numbers are rounded in another order on another processor, so the numbers of
one fit differ from the seventh digit on. Two tables are the same where they were made by one
program from the same logs, vehicle and settings, and no number differs by more than `TOLERANCE`.
"""

import hashlib
import json
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from calib.base.digest import canonical_json
from calib.base.intervals import Z95
from calib.table.table import Array, Table, Value

TOLERANCE = 1e-5
"""Largest difference of two numbers over the largest of their list or column [1].

A value is compared over itself or its sigma, whichever is larger.
"""

_VALUE = {"value", "sigma"}
"""Keys of a fitted value in a record."""

_RESULTS = ("calibration", "effects", "noise", "posterior", "quality")
"""Sections of the record that hold numbers of the fit; its words follow from them."""

EQUAL, WITHIN, DIFFERENT = "equal", "equal within bands", "different"
"""Verdicts on two tables; the second where nothing differs by more than the 95 % bands of both."""


@dataclass(frozen=True)
class CurveGap:
    """Distance of one curve of ``b`` from the same of ``a`` where both are defined.

    ``curve`` D, f1, f2 or g; ``start``, ``end`` of the common axis, eta or slip [1]; ``largest``
    the b - a of largest magnitude [1], at the axis value ``at``; ``rms`` over the common axis [1];
    ``in_bands`` largest magnitude of b - a over the combined 95 % half-width [1], infinite where
    neither has a band.
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
class ValueGap:
    """A fitted value of ``a`` and ``b`` [1].

    ``in_bands`` their distance over the combined 95 % half-width [1]; infinite for two that
    differ and have no band.
    """

    name: str
    a: float
    b: float
    in_bands: float


@dataclass(frozen=True)
class Difference:
    """``curves`` one gap per curve with a common axis; ``apart`` the curves without one.

    ``values`` the pads of both; ``changes`` by section of the record: vehicle, calibration,
    quality, provenance and so on; without the sections that are equal.
    """

    curves: tuple[CurveGap, ...]
    apart: tuple[str, ...]
    values: tuple[ValueGap, ...]
    changes: dict[str, tuple[_RecordChange, ...]]

    @property
    def identical(self) -> bool:
        """Whether neither curves nor records differ."""
        return not self.changes and not self.apart and all(g.largest == 0.0 for g in self.curves)

    @property
    def beyond(self) -> tuple[CurveGap | ValueGap, ...]:
        """Curves and values that differ by more than the 95 % bands of both, the worst first."""
        every: list[CurveGap | ValueGap] = [*self.curves, *self.values]
        return tuple(
            sorted((gap for gap in every if gap.in_bands > 1.0), key=lambda g: -g.in_bands)
        )

    @property
    def verdict(self) -> str:
        """`equal`, `equal within bands` or `different`."""
        if self.identical:
            return EQUAL
        return DIFFERENT if self.beyond or self.apart else WITHIN


def diff(a: Table, b: Table) -> Difference:
    """Compare two tables: curves on their common axis, linearly between rows; records by key."""
    theirs = _axes(b)
    gaps = {name: _gap(name, first, theirs[name]) for name, first in _axes(a).items()}
    pads = vars(b.calibration)
    return Difference(
        curves=tuple(gap for gap in gaps.values() if gap is not None),
        apart=tuple(name for name, gap in gaps.items() if gap is None),
        values=tuple(_value_gap(name, x, pads[name]) for name, x in vars(a.calibration).items()),
        changes=changes(a, b),
    )


def _value_gap(name: str, a: Value, b: Value) -> ValueGap:
    band = np.asarray(Z95 * math.hypot(a.sigma, b.sigma))
    return ValueGap(name, a.value, b.value, _in_bands(np.asarray(b.value - a.value), band))


def _in_bands(gap: Array, band: Array) -> float:
    """Largest gap over its band; at eta = 1 both are zero, and so is their ratio."""
    over = np.full_like(gap, math.inf)
    np.divide(np.abs(gap), band, out=over, where=band > 0.0)
    return float(np.max(over, initial=0.0, where=gap != 0.0))


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
) -> CurveGap | None:
    start, end = max(a[0][0], b[0][0]), min(a[0][-1], b[0][-1])
    if not start < end:
        return None
    # Both curves are linear between these points, so the largest gap is at one of them.
    x = np.union1d(a[0], b[0])
    x = np.union1d(x[(x >= start) & (x <= end)], [start, end])
    gap = np.interp(x, b[0], b[1]) - np.interp(x, a[0], a[1])
    band = np.hypot(np.interp(x, a[0], a[2]), np.interp(x, b[0], b[2]))
    worst = int(np.argmax(np.abs(gap)))
    square = (gap[:-1] ** 2 + gap[:-1] * gap[1:] + gap[1:] ** 2) / 3.0
    return CurveGap(
        curve=name,
        start=float(start),
        end=float(end),
        largest=float(gap[worst]),
        at=float(x[worst]),
        rms=float(np.sqrt(np.sum(square * np.diff(x)) / (x[-1] - x[0]))),
        in_bands=_in_bands(gap, band),
    )


def changes(a: Table, b: Table) -> dict[str, tuple[_RecordChange, ...]]:
    """The keys of two records that differ, by section."""
    first, second = _flat(_record(a)), _flat(_record(b))
    found: dict[str, tuple[_RecordChange, ...]] = {}
    for key in sorted({*first, *second}):
        if first.get(key) != second.get(key):
            section, _, rest = key.partition(".")
            one = _RecordChange(rest or section, first.get(key), second.get(key))
            found[section] = (*found.get(section, ()), one)
    return found


def _record(table: Table) -> dict[str, Any]:
    """The record without what has one number for each row: the spread of D, fingerprints of logs.

    A log is told from another one by its digest.
    """
    record, _ = table.content()
    if "spread" in record:
        del record["spread"]["D"]
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
    """SHA-256 over everything in a record that was given to the fit, and over the program."""
    given = {name: record.get(name) for name in ("name", "vehicle", "by_hand")}
    origin = record["provenance"]
    given["provenance"] = {**origin, "logs": [_given(log) for log in origin["logs"]]}
    return hashlib.sha256(canonical_json(given)).hexdigest()


def _given(log: dict[str, Any]) -> dict[str, Any]:
    """A log of a record without the numbers of its fingerprint, which follow from the log."""
    return {**log, "fingerprint": "fingerprint" in log}


def same(a: Table, b: Table) -> bool:
    """Whether two tables have equal inputs, and numbers equal within `TOLERANCE`."""
    (first, ours), (second, theirs) = a.content(), b.content()
    return inputs(first) == inputs(second) and _close(
        [{name: first[name] for name in _RESULTS}, ours],
        [{name: second[name] for name in _RESULTS}, theirs],
    )


def _close(a: Any, b: Any) -> bool:
    """Compare dicts, lists and arrays part by part, and lists of numbers by their largest."""
    if isinstance(a, dict) and isinstance(b, dict) and a.keys() == b.keys() == _VALUE:
        return _close([*a.values()], [*b.values()])
    if isinstance(a, dict):
        return isinstance(b, dict) and a.keys() == b.keys() and all(_close(a[k], b[k]) for k in a)
    first, second = _numbers(a), _numbers(b)
    if first is not None and second is not None:
        if first.shape != second.shape:
            return False
        scale = max(np.max(np.abs(x), initial=0.0) for x in (first, second))
        return bool(np.all(np.abs(first - second) <= TOLERANCE * scale))
    if isinstance(a, list):
        return isinstance(b, list) and len(a) == len(b) and all(map(_close, a, b))
    return bool(a == b)


def _numbers(value: Any) -> Array | None:
    """A number, or lists of numbers of one shape, as an array; None for anything else."""
    if isinstance(value, str | dict | bool) or value is None:
        return None
    try:
        return np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        return None
