"""JSON: all exported data with bands, counts and flags, and the record of the table."""

import json
from dataclasses import asdict
from typing import Any

from calib.exports.dataset import Axis, Curve, Dataset
from calib.store.version import Stored

SCHEMA = 1


def write_json(data: Dataset, stored: Stored) -> bytes:
    """JSON file of ``data``; numbers read back to the last bit."""
    record, _ = stored.table.content()
    document = {
        "schema": SCHEMA,
        **data.facts(),
        "version": data.version,
        "axes": [_axis(axis) for axis in data.axes],
        "curves": [_curve(curve) for curve in data.curves],
        "scalars": [asdict(scalar) for scalar in data.scalars],
        "record": record,
    }
    return (json.dumps(document, indent=1, allow_nan=False) + "\n").encode()


def _axis(axis: Axis) -> dict[str, Any]:
    return {**asdict(axis), "values": axis.values.tolist()}


def _curve(curve: Curve) -> dict[str, Any]:
    arrays = ("values", "lower", "upper", "count", "flag")
    return {**asdict(curve), **{name: getattr(curve, name).tolist() for name in arrays}}
