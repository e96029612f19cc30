"""Evidence on a version: the files of a validation, or of a car at the station."""

import json
from pathlib import Path

from calib.base.bounded import VALIDATION, bytes_of
from calib.base.digest import sha256
from calib.base.errors import ExchangeError
from calib.store.state import Evidence
from calib.store.version import Stored

CONSISTENT = "consistent, not proved"  # without truth and v no error of the table would show


def read_evidence(path: Path, stored: Stored) -> tuple[Evidence, str]:
    """The evidence, and its verdict on a version: passed, warning, failed or `CONSISTENT`.

    Raises ExchangeError for a file that is neither a `summary.json` of `validate --out` nor a
    `station.json`, is of another table, or has no hold-out.
    """
    data = bytes_of(path, VALIDATION, ExchangeError, "a summary.json or a station.json")
    verdict = _station_verdict(data, path, stored) or _verdict(data, path, stored)
    return Evidence(path.name, sha256(data)), verdict


def _verdict(data: bytes, path: Path, stored: Stored) -> str:
    from calib.base.record import validated
    from calib.store.record_file import SummaryFile

    try:
        summary = validated(data, SummaryFile, None, ExchangeError)
    except ExchangeError as error:
        do = "take the summary.json of `brake-cal validate --out`"
        raise ExchangeError(f"no summary of a validation: {error}", where=path, do=do) from error
    if (summary.table, summary.digest) != (stored.id, stored.digest):
        raise _other(summary.table, summary.digest, path, stored)
    if all(log.role != "hold-out" for log in summary.logs):
        flaw = "is a validation on logs that the table was fitted on, which proves nothing"
        raise ExchangeError(flaw, where=path, expected="a validation on hold-out logs")
    unproved = summary.verdict == "passed" and summary.proof == "none"
    return CONSISTENT if unproved else summary.verdict


def _station_verdict(data: bytes, path: Path, stored: Stored) -> str | None:
    """The verdict of a `station.json` on this version; None for any other file."""
    try:
        document = json.loads(data)
        verdict, table = document["verdict"], document["table"]
        id_, digest = str(table["id"]), str(table["digest"])
    except (ValueError, TypeError, KeyError, RecursionError):
        return None
    if document.get("schema") != 1 or verdict not in ("passed", "warning", "failed"):
        return None
    if digest != stored.digest:
        raise _other(id_, digest, path, stored)
    return str(verdict)


def _other(id_: str, digest: str, path: Path, stored: Stored) -> ExchangeError:
    flaw = f"is of {id_}, digest {digest[:12]}"
    expected = f"one of {stored.id}, digest {stored.digest[:12]}"
    return ExchangeError(flaw, where=path, expected=expected, do="validate this version")
