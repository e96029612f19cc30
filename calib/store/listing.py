"""What tells the versions of a store apart: state, date, car, logs, pads, range, band, verdict."""

from collections.abc import Iterable
from typing import Any

from calib.store.signature import key_ids
from calib.store.snapshot import StoreEntry

Row = dict[str, Any]
"""A version in the document of `tables list`."""


def row_of(entry: StoreEntry) -> Row:
    """The row of a version; what cannot be read is None or empty, as its ``flaw`` says.

    ``date`` when it was stored; ``pads`` front and rear [1];
    ``decelerations`` of its curves and their ``usable`` range [1]; ``verdict`` of the evidence of
    its state; ``warnings`` of its fit; ``keys`` that signed it, unverified.
    """
    state, stored = entry.state, entry.stored
    row: Row = {"id": entry.id, "name": entry.name, "version": entry.version, "digest": None}
    row |= {"state": state.word, "date": state.stored_at, "serial": "", "vin": "", "logs": ()}
    row |= dict.fromkeys(("pads", "decelerations", "usable", "band_width"))
    row |= {"verdict": state.verdict, "warnings": 0, "keys": (), "flaw": "".join(entry.violations)}
    if stored is None:
        return row
    table, pads = stored.table, stored.table.calibration
    return row | {
        "digest": stored.digest,
        "serial": table.provenance.identity.get("serial", ""),
        "vin": table.provenance.identity.get("vin", ""),
        "logs": tuple(log.name for log in table.provenance.logs),
        "pads": (pads.pad_friction_f.value, pads.pad_friction_r.value),
        "decelerations": table.paper.decelerations,
        "usable": table.paper.usable,
        "band_width": table.difference.band_width,
        "warnings": len(table.warnings),
        "keys": key_ids(stored),
    }


def chosen(rows: Iterable[Row], since: str | None, **equal: str | None) -> list[Row]:
    """The rows stored on the day ``since`` (2025-03-31) or later, with ``equal`` texts.

    Upper and lower case are the same; None asks for nothing.
    """
    wanted = {key: value.lower() for key, value in equal.items() if value is not None}
    return [
        row
        for row in rows
        if all(row[key].lower() == value for key, value in wanted.items())
        and (since is None or row["date"][:10] >= since)
    ]
