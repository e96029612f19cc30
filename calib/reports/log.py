"""The page of a log: one HTML file with its columns, its events and their picture."""

from collections.abc import Iterable

from calib.checks.events import BITE, RunEvent
from calib.logs.whole import Inventory, WholeLog
from calib.reports.html import page, picture

HEADS = ("column", "unit", "lowest", "highest", "rate [Hz]", "values", "gaps")


def log_html(
    log: WholeLog, columns: Iterable[Inventory], events: Iterable[RunEvent], drawn: bytes
) -> str:
    """Return the page; ``drawn`` the picture as PNG."""
    time = log.time
    return page(
        "log",
        title=f"Log {log.name}",
        facts=[
            ("file", log.source),
            ("SHA-256", log.digest),
            ("time", f"{time[0]:g} to {time[-1]:g} s, {time.size} rows"),
        ],
        picture=picture(drawn, "png", "zoom-channels"),
        events=[event_cells(event) for event in events],
        heads=HEADS,
        columns=[cells(column) for column in columns],
        notes=log.notes,
    )


def cells(column: Inventory) -> tuple[str, ...]:
    """A column as text, in the order of `HEADS`."""
    return (
        column.name,
        column.unit or "none",
        "none" if column.low is None else f"{column.low:.6g}",
        "none" if column.high is None else f"{column.high:.6g}",
        "none" if column.rate is None else f"{column.rate:.4g}",
        str(column.samples),
        _gaps(column),
    )


def event_cells(event: RunEvent) -> tuple[str, str, str]:
    """Name, place and length of an event as text."""
    if event.kind == BITE:
        return event.kind, f"{event.start:.2f} s", ""
    return event.kind, f"{event.start:.2f} to {event.end:.2f} s", f"{event.end - event.start:.2f} s"


def _gaps(column: Inventory) -> str:
    if not column.gaps:
        return "none"
    start, length = max(column.gaps, key=lambda gap: gap[1])
    return f"{len(column.gaps)}, longest {length:.3f} s at {start:.2f} s"
