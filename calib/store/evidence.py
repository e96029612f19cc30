"""A file on which a person releases or rejects a version: a validation, or a car at the station."""

import hashlib
from pathlib import Path

from calib.base.bounded import VALIDATION, read_bounded
from calib.base.errors import ExchangeError
from calib.store.quality import read_quality
from calib.store.state import Evidence
from calib.store.version import Stored


def read_evidence(path: Path, stored: Stored) -> tuple[Evidence, str]:
    """The evidence, and its verdict on a version: passed, warning or failed.

    The file is a `summary.json` of `validate --out` or a `station.json`. Raises ExchangeError when
    it is neither, is of another table, or has no hold-out.
    """
    try:
        data = read_bounded(path, VALIDATION)
    except OSError as error:
        raise ExchangeError(f"cannot be read ({error.strerror})", where=path) from error
    evidence = Evidence(path.name, hashlib.sha256(data).hexdigest())
    verdict = _station_verdict(data, path, stored)
    if verdict is None:
        verdict = read_quality(path, stored).verdict
    if verdict is None:
        raise ExchangeError(
            "is a validation on logs that the table was fitted on, which proves nothing",
            where=path,
            expected="a validation on hold-out logs",
        )
    return evidence, verdict


def _station_verdict(data: bytes, path: Path, stored: Stored) -> str | None:
    """The verdict of a `station.json` on this version; None where the file is none."""
    from calib.base.record import validated
    from calib.store.evidence_file import StationFile

    try:
        file = validated(data, StationFile, None, ExchangeError)
    except ExchangeError:
        return None
    if file.table.digest != stored.digest:
        raise ExchangeError(
            f"is of {file.table.id}, digest {file.table.digest[:12]}",
            where=path,
            expected=f"one of {stored.id}, digest {stored.digest[:12]}",
        )
    return file.verdict
