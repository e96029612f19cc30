"""Facts of a log as it was recorded: its columns and its events."""

from collections.abc import Iterable

from calib.logs.whole import Inventory, WholeLog
from calib.run.driving_record import BITES, RunEvent
from calib.show.facts import Facts, Picture, Table

RAW = "Every column of the log, with its events. Nothing is filtered, zeroed or corrected."
_NO_EVENTS = "No events: they need a_x and the four wheel speeds, with a value in every row."


def facts(
    log: WholeLog, columns: Iterable[Inventory], events: Iterable[RunEvent], drawn: bytes = b""
) -> Facts:
    """What is in a log; ``drawn`` its picture as PNG, for a page."""
    time = log.time
    rows = [_event_cells(event) for event in events]
    heads = ("column", "unit", "lowest", "highest", "rate [Hz]", "values", "gaps")
    return Facts(
        title=f"Log {log.name}",
        rows=[
            ("file", log.source),
            ("SHA-256", log.digest),
            ("time", f"{time[0]:g} to {time[-1]:g} s, {time.size} rows"),
        ],
        tables=[
            Table(heads, [cells(column) for column in columns], "What is in each column."),
            Table(("event", "time", "length"), rows, "Events in order of time."),
        ],
        notes=[*log.notes, *([] if rows else [_NO_EVENTS])],
        pictures=[Picture(RAW, drawn)] if drawn else [],
    )


def cells(column: Inventory) -> tuple[str, ...]:
    """A column as text: name, unit, lowest, highest, rate [Hz], number of values, gaps."""
    start, length = max(column.gaps, key=lambda gap: gap[1], default=(0.0, 0.0))
    gaps = f"{len(column.gaps)}, longest {length:.3f} s at {start:.2f} s" if column.gaps else "none"
    return (
        column.name,
        column.unit or "none",
        "none" if column.low is None else f"{column.low:.6g}",
        "none" if column.high is None else f"{column.high:.6g}",
        "none" if column.rate is None else f"{column.rate:.4g}",
        str(column.samples),
        gaps,
    )


def _event_cells(event: RunEvent) -> tuple[str, str, str]:
    """Name, place and length of an event as text."""
    if event.kind == BITES:
        return event.kind, f"{event.start:.2f} s", ""
    return event.kind, f"{event.start:.2f} to {event.end:.2f} s", f"{event.end - event.start:.2f} s"
