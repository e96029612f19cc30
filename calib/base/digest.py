"""SHA-256 of content: equal for equal content, whatever the file format or its compression."""

import hashlib
import json
from pathlib import Path
from typing import Any

import numpy as np

from calib.base.arrays import Array


def content_digest(record: dict[str, Any], curves: dict[str, dict[str, Array]]) -> str:
    """SHA-256 [hex] of a record as canonical JSON and of the columns of curves as float64."""
    digest = hashlib.sha256(canonical_json(record))
    for curve in sorted(curves):
        for column in sorted(curves[curve]):
            digest.update(f"\n{curve}.{column}\n".encode())
            digest.update(np.ascontiguousarray(curves[curve][column], dtype="<f8").tobytes())
    return digest.hexdigest()


def canonical_json(record: dict[str, Any]) -> bytes:
    """JSON with sorted keys and no spaces. Raises ValueError for a number that is not finite."""
    return json.dumps(record, sort_keys=True, separators=(",", ":"), allow_nan=False).encode()


def sha256(data: bytes) -> str:
    """SHA-256 of bytes [hex]."""
    return hashlib.sha256(data).hexdigest()


def file_digest(path: Path) -> str:
    """SHA-256 of a file's bytes [hex]. Raises OSError."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
