"""Whether two tables are the same fit, computed on two kinds of computer.

Sums of floating-point numbers are rounded in another order on another processor, so the numbers of
one fit differ from the seventh digit on. Two tables are the same where they were made by one
program from the same logs, vehicle and settings, and no number differs by more than `TOLERANCE`.
"""

import hashlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calib.base.digest import canonical_json
from calib.table.table import Table

TOLERANCE = 1e-5
"""Largest difference of two numbers over the largest of their list or column [1].

A value is compared over itself or its sigma, whichever is larger.
"""

VALUE = {"value", "sigma"}
"""Keys of a fitted value in a record."""

RESULTS = ("calibration", "effects", "noise", "posterior", "quality")
"""Sections of the record that hold numbers of the fit; its words follow from them."""


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
        [{name: first[name] for name in RESULTS}, ours],
        [{name: second[name] for name in RESULTS}, theirs],
    )


def _close(a: Any, b: Any) -> bool:
    """Compare dicts, lists and arrays part by part, and lists of numbers by their largest."""
    if isinstance(a, dict) and isinstance(b, dict) and a.keys() == b.keys() == VALUE:
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


def _numbers(value: Any) -> NDArray[np.float64] | None:
    """A number, or lists of numbers of one shape, as an array; None for anything else."""
    if isinstance(value, str | dict | bool) or value is None:
        return None
    try:
        return np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        return None
