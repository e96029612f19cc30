"""A log without table or vehicle: what is in it, and all its columns in one picture.

Events are marked as `calib.run.driving_record` finds them. Columns of one kind and unit share a
panel; a long log is drawn by the lowest and the highest value of each of `BINS` parts, so that no
peak is lost.
"""

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from calib.base.names import CHANNELS, WHEELS
from calib.base.units import from_si
from calib.car.braking import MOVING
from calib.logs.log import Log
from calib.logs.whole import TIME, Inventory, WholeColumn, WholeLog, channels_log
from calib.run.driving_record import (
    BITES,
    BRAKING,
    LEAD_IN,
    NOMINAL_RADIUS,
    STANDSTILL,
    RunEvent,
)
from calib.show.facts import Facts, Picture, Table
from calib.show.sheet import Line, Mark, Panel, Sheet
from calib.show.style import BODY, FRONT, IDENTIFIED, REAR, WHEEL_STROKES, Array, Stroke, as_text

_RAW = "Every column of the log, with its events. Nothing is filtered, zeroed or corrected."
_NO_EVENTS = "No events: they need a_x and the four wheel speeds, with a value in every row."
_EVENTS: dict[str, Stroke] = {
    LEAD_IN: {"facecolor": "#EBF6F1"},
    BRAKING: {"facecolor": "#EFEFEF"},
    STANDSTILL: {"facecolor": "#F8E6D8"},
    BITES: {"color": "#B3471B", "linewidth": 0.9, "linestyle": (0, (3, 2))},
}
"""Spans are pale behind lines of all colours."""
_SPINS = tuple(f"omega_{wheel}" for wheel in WHEELS)

BINS = 2000
"""Parts of a long log; a page has some 1000 pixels."""
_PANEL = 0.62
"""Height of a panel, over that of a usual one."""
MOST = 40
"""Panels of one picture; more are not readable."""


def facts(
    log: WholeLog, columns: Iterable[Inventory], events: Iterable[RunEvent], drawn: bytes = b""
) -> Facts:
    """What is in a log; ``drawn`` its picture as PNG, for a page."""
    time = log.time
    rows = [(one.kind, f"{one.start:.2f} s", f"{one.end - one.start:.2f} s") for one in events]
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
        notes=[*log.notes, *([] if rows else [_NO_EVENTS])],
        pictures=[Picture(_RAW, drawn)] if drawn else [],
    )


def _cells(column: Inventory) -> tuple[str, ...]:
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


def sheet(log: WholeLog, events: Iterable[RunEvent] = ()) -> Sheet:
    """Every column of a log over time, and eta. Raises ValueError for none, or over `MOST`."""
    time, groups = log.time, panels_of(log)
    if not 0 < len(groups) <= MOST:
        raise ValueError(f"{len(groups)} panels, at most {MOST} can be drawn")
    marks, ends = list(events), (time[0], time[-1])
    panels: list[Panel] = []
    for title, columns in groups.items():
        lines = [
            Line(*envelope(time, one.values), _look(one.name, columns), as_text(one.name))
            for one in columns
        ]
        kind = _kind(columns[0].name)
        name = title if any(panel.name == kind for panel in panels) else kind
        panels.append(Panel(name, as_text(title), "time [s]", as_text(title), lines, columns=6))
    channels = channels_log(log)
    if all(name in channels for name in _SPINS):
        look: Stroke = {**IDENTIFIED, "linewidth": 0.8}
        line = Line(*envelope(time, raw_eta(channels)), look, r"$\omega_r/\omega_f - 1$")
        panels.append(Panel("eta", "Speed ratio, raw", "time [s]", r"$\eta - 1$ [%]", [line]))
    panels = [
        replace(panel, marks=_marked(marks, named=not i), xlim=ends)
        for i, panel in enumerate(panels)
    ]
    return Sheet(
        kind="log",
        name=log.name,
        panels=tuple(panels),
        heights=(_PANEL,),
        title=f"Log {log.name}",
        note=f"Digest {log.digest[:16]}, {time.size} samples. Nothing is filtered or zeroed.",
    )


def whole_of(log: Log) -> WholeLog:
    """The channels of a log in the units in which they are written."""
    columns = [
        WholeColumn(name, of.unit, from_si(log[name], of.unit, of.si))
        for name, of in CHANNELS.items()
        if name in log
    ]
    return WholeLog(log.name, log.source, log.digest, tuple(columns), log.notes)


def raw_eta(log: Log) -> Array:
    """100 (eta - 1) of the axle means (22) [%], (n,); NaN where an axle is below 3 m/s."""
    front = 0.5 * (log["omega_fl"] + log["omega_fr"])
    rear = 0.5 * (log["omega_rl"] + log["omega_rr"])
    turning = np.minimum(front, rear) > MOVING / NOMINAL_RADIUS
    return np.where(turning, 100.0 * (rear / np.where(turning, front, 1.0) - 1.0), np.nan)


def _marked(events: Iterable[RunEvent], named: bool) -> list[Mark]:
    """The events, each kind ``named`` once in the legend."""
    names = {event.kind for event in events} if named else set()
    marks = []
    for event in events:
        label = event.kind if event.kind in names else ""
        names.discard(event.kind)
        marks.append(Mark(event.start, event.end, _EVENTS[event.kind], label))
    return marks


def panels_of(whole: WholeLog) -> dict[str, tuple[WholeColumn, ...]]:
    """The columns by panel, in the order of the log; the clock has none."""
    found: dict[str, tuple[WholeColumn, ...]] = {}
    for column in whole.columns:
        if column.name != TIME:
            key = f"{_kind(column.name)} [{column.unit or '?'}]"
            found[key] = (*found.get(key, ()), column)
    return found


def _kind(name: str) -> str:
    """``omega`` of omega_fl, ``T_disc`` of T_disc_f; a foreign name is its own kind."""
    stem, _, last = name.rpartition("_")
    shared = last in (*WHEELS, "f", "r") and (name in CHANNELS or name.startswith("true_"))
    return stem if shared else name


def _look(name: str, columns: tuple[WholeColumn, ...]) -> Stroke:
    known = {**WHEEL_STROKES, "f": FRONT, "r": REAR} if len(columns) > 1 else {}
    return {**known.get(name.rpartition("_")[2], BODY), "linewidth": 0.8}


def envelope(time: Array, values: Array) -> tuple[Array, Array]:
    """Times and values to draw: all, or lowest and highest of each of `BINS` parts."""
    if values.size <= 4 * BINS:
        return time, values
    edges = np.linspace(0, values.size, BINS + 1).astype(np.intp)
    at = np.repeat(time[edges[:-1]], 2)
    none = np.isnan(values)
    low, high = np.where(none, np.inf, values), np.where(none, -np.inf, values)
    ends = [np.minimum.reduceat(low, edges[:-1]), np.maximum.reduceat(high, edges[:-1])]
    drawn = np.ravel(ends, order="F")
    return at, np.where(np.isfinite(drawn), drawn, np.nan)


def written(log: WholeLog, out: Path) -> dict[str, Any]:
    """What the JSON document says of a log that was written to ``out``."""
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
    """What the JSON document says of a log and its columns."""
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


def simulated(log: Log, speed: Array, out: Path, model: Path | None) -> dict[str, Any]:
    """The JSON document of a simulation that was driven with ``speed`` [m/s] (n,)."""
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
