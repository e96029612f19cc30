"""What tells the versions of a store apart: state, date, car, logs, pads, range, band, verdict."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from calib.store.signature import key_ids
from calib.store.snapshot import StoreEntry
from calib.table.table import Table


@dataclass(frozen=True)
class ListedVersion:
    """One version in a list; what cannot be read is None or empty, as ``flaw`` then says.

    ``date`` when it was stored, "" where no journal knows; ``pads`` front and rear [1];
    ``decelerations`` of its curves and their ``usable`` range [1]; ``verdict`` of the evidence of
    its state; ``warnings`` of its fit; ``keys`` that signed it, unverified.
    """

    id: str
    name: str
    version: int
    digest: str | None
    state: str
    date: str
    serial: str
    vin: str
    logs: tuple[str, ...]
    pads: tuple[float, float] | None
    decelerations: tuple[float, float] | None
    usable: tuple[float, float] | None
    band_width: float | None
    verdict: str
    warnings: int
    keys: tuple[str, ...]
    flaw: str


def band_width(table: Table) -> float | None:
    """Half width of the 95 % band of D(eta) where D is largest, over D [1]; None where D is 0."""
    d = table.difference
    at = int(np.argmax(np.abs(d.D)))
    half = 0.5 * float(d.upper[at] - d.lower[at])
    return half / abs(float(d.D[at])) if d.D[at] else None


def row_of(entry: StoreEntry) -> ListedVersion:
    """The row of one version of a store."""
    state, stored = entry.state, entry.stored
    table = stored.table if stored else None
    identity = table.provenance.identity if table else {}
    pads = table.calibration if table else None
    return ListedVersion(
        id=entry.id,
        name=entry.name,
        version=entry.version,
        digest=stored.digest if stored else None,
        state=state.word,
        date=state.stored_at,
        serial=identity.get("serial", ""),
        vin=identity.get("vin", ""),
        logs=tuple(log.name for log in table.provenance.logs) if table else (),
        pads=(pads.pad_friction_f.value, pads.pad_friction_r.value) if pads else None,
        decelerations=table.paper.decelerations if table else None,
        usable=table.paper.usable if table else None,
        band_width=band_width(table) if table else None,
        verdict=state.verdict,
        warnings=len(table.warnings) if table else 0,
        keys=key_ids(stored) if stored else (),
        flaw=entry.flaw,
    )


def chosen(
    rows: Iterable[ListedVersion],
    state: str | None = None,
    serial: str | None = None,
    vin: str | None = None,
    since: str | None = None,
) -> list[ListedVersion]:
    """The rows of a state, a serial number, a VIN, and those stored on the day ``since`` or later.

    Upper and lower case are the same; ``since`` as 2025-03-31. A version that no journal dates is
    older than any day.
    """
    return [
        row
        for row in rows
        if (state is None or row.state == state)
        and (serial is None or row.serial.lower() == serial.lower())
        and (vin is None or row.vin.lower() == vin.lower())
        and (since is None or row.date[:10] >= since)
    ]
