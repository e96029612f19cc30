"""A log without table or vehicle: its content as facts, and all its columns as one picture.

A panel has the columns of one kind, such as all wheel speeds, in one unit. The events of
`calib.run.events` are marks.
"""

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from calib.base.names import CHANNELS, TRUTH, WHEEL_SPEEDS, WHEELS
from calib.base.units import from_si
from calib.car.braking import MOVING
from calib.logs.log import Log
from calib.logs.whole import TIME, Inventory, WholeColumn, WholeLog, channels_log
from calib.run.driving_record import NOMINAL_RADIUS
from calib.run.events import BITES, BRAKING, LEAD_IN, STANDSTILL, RunEvent
from calib.show import style
from calib.show.facts import Facts, Picture, Table
from calib.show.panel import Line, Mark, Panel
from calib.show.sheet import Sheet, rows_of
from calib.show.style import Array, Stroke

_CAPTION = "Every column of the log, with its events. Nothing is filtered, zeroed or corrected."
_NO_EVENTS = "No events: they need a_x and the four wheel speeds, with a value in every row."
_EVENTS: dict[str, Stroke] = {
    LEAD_IN: {"color": "#EBF6F1"},
    BRAKING: {"color": "#EFEFEF"},
    STANDSTILL: {"color": "#F8E6D8"},
    BITES: {"color": "#B3471B", "linewidth": 0.9, "linestyle": (0, (3, 2))},
}
"""Looks of events: the first three are spans, pale below the lines; the last is a moment."""
_STROKES = {**style.WHEEL_STROKES, "f": style.FRONT, "r": style.REAR}
_TIME = "time [s]"
_ONE_COLUMN, MAX_PANELS = 8, 24
"""Largest number of panels in a single column, and in a picture."""
_TITLES = {
    "p_mc": "Pressure of the master cylinder",
    "a_x": "Acceleration",
    "omega": "Wheel speeds",
    "v": "Speed over ground",
    "p": "Pressure at the wheels",
    "T_disc": "Temperature of the discs",
    "steering": "Steering wheel",
    "T_drive": "Torque of engine or motor",
    "abs_active": "ABS or ESC",
}
"""Titles of panels by kind of column; the title of a foreign column is its name."""


def log_facts(log: WholeLog, columns: Iterable[Inventory], events: Iterable[RunEvent]) -> Facts:
    """Return the facts of a log: its columns and its events."""
    time = log.time
    rows = [(e.kind, f"{e.start:.2f} s", f"{e.end - e.start:.2f} s") for e in events]
    heads = ("column", "unit", "lowest", "highest", "rate [Hz]", "values", "gaps")
    return Facts(
        title=f"Log {log.name}",
        rows=[
            ("file", log.source),
            ("SHA-256", log.digest),
            ("time", f"{time[0]:g} to {time[-1]:g} s, {time.size} rows"),
        ],
        tables=[
            Table(heads, [_cells(column) for column in columns], "What is in each column."),
            Table(("event", "from", "for"), rows, "Events in order of time."),
        ],
        pictures=[Picture(_CAPTION, lambda: log_sheet(log, events))],
        notes=[*log.notes, *([] if rows else [_NO_EVENTS])],
    )


def _cells(column: Inventory) -> tuple[str, ...]:
    low, high = ("none" if end is None else f"{end:.6g}" for end in (column.low, column.high))
    rate, gaps = "none" if column.rate is None else f"{column.rate:.4g}", "none"
    if column.gaps:
        start, length = max(column.gaps, key=lambda gap: gap[1])
        gaps = f"{len(column.gaps)}, longest {length:.3f} s at {start:.2f} s"
    return column.name, column.unit or "none", low, high, rate, str(column.samples), gaps


def log_sheet(log: WholeLog, events: Iterable[RunEvent] = ()) -> Sheet:
    """Return the sheet of a log. Raises ValueError for no panel, or more than `MAX_PANELS`."""
    time, groups = log.time, panels_of(log)
    if not 0 < len(groups) <= MAX_PANELS:
        raise ValueError(f"{len(groups)} panels, at most {MAX_PANELS} can be drawn")
    all_events, channels, panels = list(events), channels_log(log), list[Panel]()
    for label, columns in groups.items():
        kind = _kind(columns[0].name)
        # a kind in two units has two panels; the second one has the label with the unit as its name
        name = label if kind in {panel.name for panel in panels} else kind
        lines = []
        for column in columns:
            place = column.name.rpartition("_")[2] if len(columns) > 1 else ""  # fl, f ...
            look = {**_STROKES.get(place, style.BODY), "linewidth": 0.8}
            lines.append(Line(time, column.values, look, place))
        title = _TITLES.get(kind, style.as_text(kind))
        panels.append(Panel(name, title, _TIME, style.as_text(label), lines, columns=4))
    if all(name in channels for name in WHEEL_SPEEDS):
        line = Line(time, _eta(channels), {**style.IDENTIFIED, "linewidth": 0.8})
        title = "Wheel speed rear over front, less 1"
        panels.append(Panel("eta", title, _TIME, style.ETA, [line]))
    marked = [
        replace(panel, marks=_marks(all_events, named=i == 0), xlim=(time[0], time[-1]))
        for i, panel in enumerate(panels)
    ]
    names = [panel.name for panel in panels]
    return Sheet(
        kind="log",
        name=log.name,
        panels=tuple(marked),
        rows=rows_of(names, 2 if len(names) > _ONE_COLUMN else 1),
        heights=(0.72,),
        title=f"Log {log.name}",
        note=f"Digest {log.digest[:16]}, {time.size} samples. Nothing is filtered.",
    )


def whole_of(log: Log) -> WholeLog:
    """Return the channels of a log in the units of `CHANNELS`, such as bar."""
    columns = [
        WholeColumn(name, channel.unit, from_si(log[name], channel.unit, channel.si))
        for name, channel in CHANNELS.items()
        if name in log
    ]
    return WholeLog(log.name, log.source, log.digest, tuple(columns), log.notes)


def _eta(log: Log) -> Array:
    """Return eta - 1 of the axles' mean wheel speeds (22) [%], (n,); NaN below `MOVING`."""
    front = 0.5 * (log["omega_fl"] + log["omega_fr"])
    rear = 0.5 * (log["omega_rl"] + log["omega_rr"])
    is_turning = np.minimum(front, rear) > MOVING / NOMINAL_RADIUS
    eta = rear / np.where(is_turning, front, 1.0)
    return np.where(is_turning, 100.0 * (eta - 1.0), np.nan)


def _marks(events: Iterable[RunEvent], named: bool) -> list[Mark]:
    """Return the events as marks; if ``named``, the legend has each kind once."""
    marks, unlabelled = list[Mark](), set(_EVENTS if named else ())
    for event in events:
        label = event.kind if event.kind in unlabelled else ""
        unlabelled.discard(event.kind)
        marks.append(Mark(event.start, event.end, _EVENTS[event.kind], label))
    return marks


def panels_of(log: WholeLog) -> dict[str, list[WholeColumn]]:
    """Return all columns but the clock, by the label of their panel, in the order of the log."""
    groups: dict[str, list[WholeColumn]] = {}
    for column in log.columns:
        if column.name != TIME:
            label = f"{_kind(column.name)} [{column.unit or '?'}]"
            groups.setdefault(label, []).append(column)
    return groups


def _kind(name: str) -> str:
    """Return `omega` of omega_fl, `T_disc` of T_disc_f; a foreign name is its own kind."""
    stem, _, place = name.rpartition("_")
    is_ours = name in CHANNELS or name.startswith(TRUTH)
    return stem if is_ours and place in (*WHEELS, "f", "r") else name


def written_document(log: WholeLog, out: Path) -> dict[str, Any]:
    """Return the JSON document of a log that was written to ``out``."""
    return {
        "log": log.source,
        "out": out,
        "rows": int(log.columns[0].values.size),
        "columns": [{"name": column.name, "unit": column.unit} for column in log.columns],
        "notes": log.notes,
    }


def document(
    log: WholeLog, columns: Iterable[Inventory], events: Iterable[RunEvent]
) -> dict[str, object]:
    """Return the JSON document of a log, its columns and its events."""
    return {
        "log": log.name,
        "source": log.source,
        "digest": log.digest,
        "rows": log.time.size,
        "start": log.time[0],
        "end": log.time[-1],
        "columns": columns,
        "events": events,
        "notes": log.notes,
    }


def simulated_document(log: Log, speed: Array, out: Path, model: Path | None) -> dict[str, Any]:
    """Return the JSON document of a simulation with the simulated ``speed`` [m/s] (n,)."""
    return {
        "out": out,
        "name": log.name,
        "source": log.source,
        "model": model,
        "samples": log.time.size,
        "duration": log.time[-1] - log.time[0],
        "first_speed": speed[0],
        "last_speed": speed[-1],
        "channels": [*log.channels, *log.truth],
        "digest": log.digest,
        "notes": log.notes,
    }
