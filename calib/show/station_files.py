"""Every file of a run at the station, made in one folder before any is published."""

import hashlib
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from calib.base.write import write_whole
from calib.estimation.results import SUMMARY, fill
from calib.estimation.validate import to_dict as validation_dict
from calib.exports.export import export
from calib.line.station.files import (
    DOCUMENT,
    JUNIT,
    REPORT,
    export_name,
    junit_xml,
    to_dict,
    to_text,
)
from calib.line.station.station import StationOutcome
from calib.show.html import page_of
from calib.show.station_page import report
from calib.store.evidence import read_quality
from calib.store.store import Store
from calib.store.version import Stored


def store_and_write(
    found: StationOutcome, store: Store, forms: Sequence[str], date: str, work: Path
) -> tuple[Stored, dict[str, Any]]:
    """Write everything into ``work``, then store the table; return it and the document.

    ``date`` is that of a cdfx; empty for the day on which the version is stored.

    The version is entered with its state in one step, so none is without a verdict. Where another
    run has taken the version number meanwhile, the files are written again. Raises OSError,
    ExchangeError, StoreError.
    """
    while True:
        expected = store.foreseen(found.table, found.decision("to be written"))
        document = write_all(found, expected, forms, date or _day(expected), work)
        digest = hashlib.sha256((work / DOCUMENT).read_bytes()).hexdigest()
        stored = store.save(found.table, found.decision(digest))
        if (stored.id, stored.state.word) == (expected.id, expected.state.word):
            return stored, document


def _day(stored: Stored) -> str:
    """The day on which a version was stored [UTC]; today for a new one.

    So the same run gives the same bytes on a later day, too.
    """
    return stored.state.stored_at[:10] or datetime.now(UTC).date().isoformat()


def write_all(
    found: StationOutcome, stored: Stored, forms: Sequence[str], date: str, work: Path
) -> dict[str, Any]:
    """Write everything into ``work`` and return the document of `station.json`.

    Only a released table is exported, so that no other reaches an ECU. ``date`` is that of a cdfx
    and of the report.
    Raises OSError, ExchangeError.
    """
    results = list(found.results)
    fill(results, validation_dict(stored, results), work)
    if stored.state.released:
        _write_exports(stored, forms, date, work)
    write_whole(work / JUNIT, junit_xml(found, stored))
    write_whole(work / REPORT, page_of(report(found, stored, date)).encode())
    document = to_dict(found, stored, sorted(p.name for p in work.iterdir() if p.name != DOCUMENT))
    write_whole(work / DOCUMENT, to_text(document).encode())
    return document


def _write_exports(stored: Stored, forms: Sequence[str], date: str, work: Path) -> None:
    quality = read_quality(work / SUMMARY, stored)
    for form in dict.fromkeys(forms):
        export(stored, work / export_name(form), form, quality=quality, date=date)
