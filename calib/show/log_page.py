"""The page of a log: one HTML file with its columns, its events and their picture."""

from collections.abc import Iterable, Sequence

from calib.logs.whole import Inventory, WholeLog
from calib.run.events import BITE, RunEvent
from calib.show.facts import Facts, Table
from calib.show.html import Report, picture

HEADS = ("column", "unit", "lowest", "highest", "rate [Hz]", "values", "gaps")


Looked = tuple[WholeLog, tuple[Inventory, ...], tuple[RunEvent, ...]]
"""A log, what is in its columns, and the events of its run."""


def facts(logs: Sequence[Looked]) -> Facts:
    """Every column of logs, and the events of each run."""
    parts = []
    for log, columns, events in logs:
        span = f"{log.time.size} rows, {log.time[0]:g} to {log.time[-1]:g} s"
        rows = [(kind, when) for kind, when, _ in map(event_cells, events)]
        table = Table(HEADS, [cells(column) for column in columns])
        parts.append(Facts(f"{log.source}: {span}", tables=[table], rows=rows, notes=log.notes))
    return Facts(parts=parts)


def log_html(
    log: WholeLog, columns: Iterable[Inventory], events: Iterable[RunEvent], drawn: bytes
) -> str:
    """Return the page; ``drawn`` the picture as PNG."""
    time = log.time
    page = Report(f"Log {log.name}", f"Log {log.name}")
    span = f"{time[0]:g} to {time[-1]:g} s, {time.size} rows"
    page.terms({"file": log.source, "SHA-256": log.digest, "time": span})
    page.section("Columns over time")
    raw = "Every column of the log, with its events. Nothing is filtered, zeroed or corrected."
    page.figure(picture(drawn, "png", "zoom-channels"), raw)
    page.section("Events")
    times = [event_cells(event) for event in events]
    page.table("Events in order of time.", ("event", "time", "length"), times)
    if not times:
        page.text("None: they need a_x and the four wheel speeds, with a value in every row.")
    page.section("Columns")
    page.table("What is in each column.", HEADS, map(cells, columns))
    if log.notes:
        page.add("heading", "What was changed or left out")
    page.listing(log.notes)
    return page.html()


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
