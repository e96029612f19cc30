"""A log without table or vehicle: what is in it, its sheet, and all its columns in one picture.

Lead-in and braking are shaded as `calib.run.driving_record` finds them. Columns of one kind and
unit share a panel; a long log is drawn by the lowest and the highest value of each of `BINS` parts,
so that no peak is lost.
"""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from calib.base.names import CHANNELS, WHEELS, G
from calib.car.braking import MOVING
from calib.logs.log import Log
from calib.logs.whole import TIME, Inventory, WholeColumn, WholeLog
from calib.run.driving_record import (
    BITES,
    BRAKING,
    LEAD_IN,
    NOMINAL_RADIUS,
    STANDSTILL,
    RunEvent,
    driving_record,
    run_events,
)
from calib.run.wheels import rolling_radius
from calib.show.facts import Facts, Picture, Table
from calib.show.sheet import Panel, Sheet
from calib.show.style import (
    BAR,
    BODY,
    FRONT,
    IDENTIFIED,
    REAR,
    WHEEL_STROKES,
    Array,
    Axes,
    Figure,
    Mask,
    Stroke,
    lines,
    smooth,
)

_RAW = "Every column of the log, with its events. Nothing is filtered, zeroed or corrected."
_NO_EVENTS = "No events: they need a_x and the four wheel speeds, with a value in every row."
_DRIVEN = 0.05
"""Acceleration above which the wheels count as driven [g]."""
_SPINS = tuple(f"omega_{wheel}" for wheel in WHEELS)
_SPANS: dict[str, Stroke] = {
    LEAD_IN: {"facecolor": "#EBF6F1"},
    BRAKING: {"facecolor": "#EFEFEF"},
    STANDSTILL: {"facecolor": "#F8E6D8"},
}
"""Colours of the spans, pale behind lines of all colours."""
_MARK: Stroke = {"color": "#B3471B", "linewidth": 0.9, "linestyle": (0, (3, 2))}
"""The bite."""

BINS = 2000
"""Parts of a long log; a page has some 1000 pixels."""
_PANEL = 0.62
"""Height of a panel of all columns, over that of a usual panel."""
_PRESSURE = "pressure [bar]"
MOST = 40
"""Panels of one picture; more are not readable."""
Row = tuple[Array, Stroke, str]
"""Values, stroke and label of a line."""


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
            Table(heads, [_cells(column) for column in columns], "What is in each column."),
            Table(("event", "time", "length"), rows, "Events in order of time."),
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


def _event_cells(event: RunEvent) -> tuple[str, str, str]:
    if event.kind == BITES:
        return event.kind, f"{event.start:.2f} s", ""
    return event.kind, f"{event.start:.2f} to {event.end:.2f} s", f"{event.end - event.start:.2f} s"


def sheet(log: Log) -> Sheet:
    """Return the sheet of a log; the note names the channels that are missing and not drawn."""
    events, everywhere = run_events(log), np.ones(log.time.size, bool)
    shown = everywhere
    if "a_x" in log:  # driven wheels would set a range in which the braking is too small to read
        shown = smooth(log.time, -log["a_x"] / G) > -_DRIVEN
    panels: list[Panel] = []
    for name, title, unit, rows, where in (
        ("speeds", "Speeds", "wheel speed [rad/s]", _speeds(log), everywhere),
        ("pressure", "Brake pressure", _PRESSURE, _pressures(log), everywhere),
        ("deceleration", "Deceleration", "deceleration [g]", _deceleration(log), everywhere),
        ("eta", "Speed ratio, raw", r"$\eta - 1$ [%]", _eta(log), shown),
    ):
        if rows:
            data = (log.time, rows, where, events, not panels)
            panels.append(Panel(name, title, _measured, (*data, unit), 8))
    missing = [name for name in ("p_mc", "a_x", *_SPINS, "v") if name not in log]
    note = (
        f"Digest {log.digest[:16]}, {log.time.size} samples, {1.0 / log.sample_time:.0f}\u00a0Hz. "
    )
    note += f"Not in this log: {', '.join(missing)}. " if missing else ""
    return Sheet(
        kind="log",
        name=log.name,
        title=f"Log {log.name}",
        note=f"{note}Nothing is zeroed or corrected.",
        panels=tuple(panels),
        rows=tuple((panel.name,) for panel in panels),
        heights=(0.9,) * len(panels),
    )


def _speeds(log: Log) -> list[Row]:
    """Wheel speeds, and the reference speed over a radius, so that a wheel below it slips."""
    rows: list[Row] = []
    if "v" in log:  # first, so that it is drawn below the wheels
        whole = all(name in log for name in ("a_x", *_SPINS))
        found = rolling_radius(log, driving_record(log)) if whole else None
        radius = found or NOMINAL_RADIUS
        source = "from the unbraked part" if found else "of a usual wheel"
        rows.append((log["v"] / radius, BODY, rf"$V/R$, $R$ = {radius:.4g} m {source}"))
    wheels = [wheel for wheel in WHEELS if f"omega_{wheel}" in log]
    return rows + [(log[f"omega_{wheel}"], WHEEL_STROKES[wheel], wheel) for wheel in wheels]


def _pressures(log: Log) -> list[Row]:
    strokes = {"mc": BODY, **WHEEL_STROKES}
    return [(log[f"p_{at}"] / BAR, strokes[at], at) for at in strokes if f"p_{at}" in log]


def _deceleration(log: Log) -> list[Row]:
    return [(-log["a_x"] / G, BODY, "$-a_x/g$")] if "a_x" in log else []


def _eta(log: Log) -> list[Row]:
    """Eta of the axle means (22), not zeroed."""
    if not all(name in log for name in _SPINS):
        return []
    return [(raw_eta(log), IDENTIFIED, r"$\omega_r/\omega_f - 1$")]


def raw_eta(log: Log) -> Array:
    """100 (eta - 1) [%], (n,); NaN where an axle is below 3 m/s at a nominal radius."""
    front = 0.5 * (log["omega_fl"] + log["omega_fr"])
    rear = 0.5 * (log["omega_rl"] + log["omega_rr"])
    turning = np.minimum(front, rear) > MOVING / NOMINAL_RADIUS
    return np.where(turning, 100.0 * (rear / np.where(turning, front, 1.0) - 1.0), np.nan)


def _measured(
    ax: Axes,
    time: Array,
    rows: Sequence[Row],
    where: Mask,
    events: Sequence[RunEvent],
    named: bool,
    unit: str,
) -> None:
    """Lines with their means over time; those ``where`` it is true set the range."""
    lines(ax, time, rows, where=where)
    _marked(ax, time, events, named)
    if unit == _PRESSURE:  # 1 bar at least, so that noise stays small
        ax.set_ylim(top=max(1.0, ax.get_ylim()[1]))
    ax.set(ylabel=unit)


def _marked(ax: Axes, time: Array, events: Sequence[RunEvent], named: bool) -> None:
    """Mark the events, ``named`` in the legend."""
    told: set[str] = set()
    for event in events:
        label = event.kind if named and event.kind not in told else None
        told.add(event.kind)
        if event.kind == BITES:
            ax.axvline(event.start, label=label, **_MARK)
        else:
            span = _SPANS[event.kind]
            ax.axvspan(event.start, event.end, zorder=0, lw=0.0, label=label, **span)
    ax.set(xlabel="time [s]", xlim=(time[0], time[-1]))


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


def figure(whole: WholeLog, events: tuple[RunEvent, ...] = ()) -> Figure:
    """Draw a log. Raises ValueError for one without columns or with more than `MOST` panels."""
    groups = panels_of(whole)
    if not 0 < len(groups) <= MOST:
        raise ValueError(f"{len(groups)} panels, at most {MOST} can be drawn")
    panels = tuple(
        Panel(title, title, _columns, (whole.time, columns, events, not i), 6)
        for i, (title, columns) in enumerate(groups.items())
    )
    title, rows = f"Log {whole.name}", tuple((panel.name,) for panel in panels)
    return Sheet("log", whole.name, title, "", panels, rows, (_PANEL,) * len(panels)).overview()


def _columns(
    ax: Axes,
    time: Array,
    columns: tuple[WholeColumn, ...],
    events: tuple[RunEvent, ...],
    named: bool,
) -> None:
    """Columns of one kind over time, with the events, ``named`` in the legend."""
    for column in columns:
        ax.plot(*envelope(time, column.values), label=column.name, **_stroke(column.name, columns))
    if not any(np.isfinite(column.values).any() for column in columns):
        ax.text(0.5, 0.5, "no value", transform=ax.transAxes, ha="center", va="center")
    _marked(ax, time, events, named)


def _stroke(name: str, columns: tuple[WholeColumn, ...]) -> Stroke:
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
