"""Read evidence on a version: the summary of a validation, or the result of a station."""

import json
from pathlib import Path

from calib.base.bounded import VALIDATION, bytes_of
from calib.base.digest import sha256
from calib.base.errors import ExchangeError
from calib.store.state import Evidence
from calib.store.version import Stored

CONSISTENT = "consistent, not proved"  # verdict: passed on logs without true torques and without v


def read_evidence(path: Path, stored: Stored) -> tuple[Evidence, str]:
    """Return the evidence, and its verdict: "passed", "warning", "failed" or `CONSISTENT`.

    Raises ExchangeError for a file that is neither a `summary.json` of `validate --out` nor a
    `station.json`, for another version than ``stored``, and for a summary without a hold-out.
    """
    data = bytes_of(path, VALIDATION, ExchangeError, "a summary.json or a station.json")
    verdict = _station_verdict(data, path, stored)
    if verdict is None:
        verdict = _validation_verdict(data, path, stored)
    return Evidence(path.name, sha256(data)), verdict


def _validation_verdict(data: bytes, path: Path, stored: Stored) -> str:
    """Return the verdict of a `summary.json`. Raises ExchangeError."""
    from calib.base.record import validated
    from calib.store.record_file import SummaryFile

    try:
        summary = validated(data, SummaryFile, None, ExchangeError)
    except ExchangeError as error:
        do = "take the summary.json of `brake-cal validate --out`"
        raise ExchangeError(f"no summary of a validation: {error}", where=path, do=do) from error
    if (summary.table, summary.digest) != (stored.id, stored.digest):
        raise _other_version(summary.table, summary.digest, path, stored)
    if all(log.role != "hold-out" for log in summary.logs):
        flaw = "is a validation on logs that the table was fitted on, which proves nothing"
        raise ExchangeError(flaw, where=path, expected="a validation on hold-out logs")
    unproved = summary.verdict == "passed" and summary.proof == "none"
    return CONSISTENT if unproved else summary.verdict


def _station_verdict(data: bytes, path: Path, stored: Stored) -> str | None:
    """Return the verdict of a `station.json`, None for any other file. Raises ExchangeError."""
    try:
        document = json.loads(data)
        verdict, table = document["verdict"], document["table"]
        id_, digest = str(table["id"]), str(table["digest"])
    except (ValueError, TypeError, KeyError, RecursionError):
        return None
    if document.get("schema") != 1 or verdict not in ("passed", "warning", "failed"):
        return None
    if digest != stored.digest:
        raise _other_version(id_, digest, path, stored)
    return str(verdict)


def _other_version(id_: str, digest: str, path: Path, stored: Stored) -> ExchangeError:
    flaw = f"is evidence on {id_}, digest {digest[:12]}"
    expected = f"evidence on {stored.id}, digest {stored.digest[:12]}"
    return ExchangeError(flaw, where=path, expected=expected, do="validate this version")
