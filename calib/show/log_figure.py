"""A log without table or vehicle.

sheet    speeds, pressure, deceleration, raw eta
figure   all columns over one time axis, with the events marked

The lead-in and the braking are shaded as `calib.run.driving_record` finds them. The reference
speed is drawn over the rolling radius of the lead-in, so that a wheel below it slips.
Columns of one kind and unit share a panel; a long log is drawn by the lowest and the highest value
of each of `BINS` parts, so that no peak is lost.
"""

import numpy as np

from calib.base.names import CHANNELS, WHEELS, G
from calib.car.braking import MOVING
from calib.logs.log import Log
from calib.logs.whole import TIME, WholeColumn, WholeLog
from calib.run.driving_record import (
    BITES,
    BRAKING,
    LEAD_IN,
    NOMINAL_RADIUS,
    STANDSTILL,
    DrivingRecord,
    RunEvent,
    brake_events,
    driving_record,
    rolling_radius,
)
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
    Stroke,
    lines,
    noisy,
    smooth,
    view,
)

DRIVEN = 0.05
"""Acceleration above which the wheels count as driven [g]."""
_WHEEL_PRESSURES = tuple(f"p_{wheel}" for wheel in WHEELS)
_SPINS = tuple(f"omega_{wheel}" for wheel in WHEELS)
SPANS: dict[str, Stroke] = {
    LEAD_IN: {"facecolor": "#EBF6F1"},
    BRAKING: {"facecolor": "#EFEFEF"},
    STANDSTILL: {"facecolor": "#F8E6D8"},
}
"""Colours of the spans, pale behind lines of all colours."""
MARK: Stroke = {"color": "#B3471B", "linewidth": 0.9, "linestyle": (0, (3, 2))}
"""The bite."""

BINS = 2000
"""Parts of a long log; a page has some 1000 pixels."""
PANEL = 0.62
"""Height of a panel of all columns, over that of a usual panel."""
MOST = 40
"""Panels of one picture; more are not readable."""


def sheet(log: Log) -> Sheet:
    """Return the sheet of a log; the note names the channels that are missing and not drawn."""
    panels = _log_panels(log)
    missing = [name for name in ("p_mc", "a_x", *_SPINS, "v") if name not in log]
    step = log.sample_time
    note = f"Digest {log.digest[:16]}, {log.time.size} samples, {1.0 / step:.0f}\u00a0Hz. "
    note += f"Not in this log: {', '.join(missing)}. " if missing else ""
    return Sheet(
        kind="log",
        name=log.name,
        title=f"Log {log.name}",
        note=note + "Nothing is zeroed or corrected. " + _marks(log),
        panels=panels,
        rows=tuple((panel.name,) for panel in panels),
        heights=(0.9,) * len(panels),
    )


def _log_panels(log: Log) -> tuple[Panel, ...]:
    """The panels for which the log has the channels."""
    wheels = any(name in log for name in _SPINS)
    pressures = any(name in log for name in ("p_mc", *_WHEEL_PRESSURES))
    found = (
        (wheels or "v" in log, Panel("speeds", "Speeds", speeds, (log,), 7)),
        (pressures, Panel("pressure", "Brake pressure", pressure, (log,), 5)),
        ("a_x" in log, Panel("deceleration", "Deceleration", deceleration, (log,))),
        (all(name in log for name in _SPINS), Panel("eta", "Speed ratio, raw", eta, (log,))),
    )
    return tuple(panel for there, panel in found if there)


def _motion_of(log: Log) -> DrivingRecord | None:
    """Lead-in and braking of a log; None if it lacks the channels that show them."""
    return driving_record(log) if all(name in log for name in ("a_x", *_SPINS)) else None


def _marks(log: Log) -> str:
    """What the shades mean, for the note."""
    motion = _motion_of(log)
    if motion is None:
        return ""
    count = len(brake_events(motion))
    braked = f"Grey: braking, {count}\u00d7." if count else "There is no braking."
    return f"Green: the lead-in, unbraked. {braked}" if motion.lead_in.any() else braked


def _radius_of(log: Log) -> tuple[float, str]:
    """The radius [m] over which V is drawn, and where it is from."""
    motion = _motion_of(log)
    found = None if motion is None else rolling_radius(log, motion)
    usual = NOMINAL_RADIUS, "of a usual wheel"
    return usual if found is None else (found, "from the unbraked part")


def speeds(ax: Axes, log: Log) -> None:
    """Wheel speeds on the left, the reference speed on the right where there is one."""
    radius, source = _radius_of(log)
    if "v" in log:  # first, so that it is drawn below the wheels
        label = rf"$V/R$, $R$ = {radius:.4g} m {source}"
        ax.plot(log.time, log["v"] / radius, label=label, linewidth=0.8, **BODY)
    for wheel in (wheel for wheel in WHEELS if f"omega_{wheel}" in log):
        ax.plot(log.time, log[f"omega_{wheel}"], label=wheel, linewidth=1.0, **WHEEL_STROKES[wheel])
    _frame(ax, log, "wheel speed [rad/s]", named=True)
    if "v" in log:
        kmh = 3.6 * radius
        both = (lambda omega: np.asarray(omega) * kmh, lambda speed: np.asarray(speed) / kmh)
        ax.secondary_yaxis("right", functions=both).set_ylabel("$V$ [km/h]")


def pressure(ax: Axes, log: Log) -> None:
    """Master-cylinder pressure, and the wheel pressures where logged."""
    shown = [np.array([0.0, 1.0])]  # 1 bar at least: noise stays small
    for name, stroke in {"mc": {**BODY, "linewidth": 1.3}, **WHEEL_STROKES}.items():
        if f"p_{name}" in log:
            bar, word = log[f"p_{name}"] / BAR, "master cylinder" if name == "mc" else name
            noisy(ax, log.time, bar, {"linewidth": 1.0, **stroke}, word)
            shown.append(smooth(log.time, bar))
    view(ax, *shown)
    _frame(ax, log, "pressure [bar]")


def deceleration(ax: Axes, log: Log) -> None:
    """z = -a_x/g."""
    lines(ax, log.time, [(-log["a_x"] / G, BODY, "$-a_x/g$")])
    _frame(ax, log, "deceleration [g]")


def eta(ax: Axes, log: Log) -> None:
    """Eta of the axle means (22), not zeroed, where the wheel speeds are high enough."""
    percent = raw_eta(log)
    noisy(ax, log.time, percent, IDENTIFIED, r"$\omega_r/\omega_f - 1$")
    shown = smooth(log.time, percent)
    if "a_x" in log:  # driven wheels would set a range in which the braking is too small to read
        shown = shown[smooth(log.time, -log["a_x"] / G) > -DRIVEN]
    view(ax, shown, zero=True)  # what is not zero on the lead-in is read as such
    _frame(ax, log, r"$\eta - 1$ [%]")


def raw_eta(log: Log) -> Array:
    """100 (eta - 1) [%], (n,); NaN where an axle is below 3 m/s at a nominal radius."""
    front = 0.5 * (log["omega_fl"] + log["omega_fr"])
    rear = 0.5 * (log["omega_rl"] + log["omega_rr"])
    turning = np.minimum(front, rear) > MOVING / NOMINAL_RADIUS
    return np.where(turning, 100.0 * (rear / np.where(turning, front, 1.0) - 1.0), np.nan)


def _frame(ax: Axes, log: Log, ylabel: str, named: bool = False) -> None:
    """Label an axis over time, and shade lead-in and braking, ``named`` in its legend."""
    ax.set(xlabel="time [s]", ylabel=ylabel)
    ax.set_xlim(log.time[0], log.time[-1])
    motion = _motion_of(log)
    if motion is None:
        return
    first = log.time[motion.lead_in]
    if first.size:
        label = "lead-in" if named else None
        ax.axvspan(first[0], first[-1], lw=0.0, zorder=0, label=label, **SPANS[LEAD_IN])
    for i, event in enumerate(brake_events(motion)):
        label = "braking" if named and not i else None
        ax.axvspan(event.start, event.end, lw=0.0, zorder=0, label=label, **SPANS[BRAKING])


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
    return Sheet("log", whole.name, title, "", panels, rows, (PANEL,) * len(panels)).overview()


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
    told: set[str] = set()
    for event in events:
        label = event.kind if named and event.kind not in told else None
        told.add(event.kind)
        if event.kind == BITES:
            ax.axvline(event.start, label=label, **MARK)
        else:
            span = SPANS[event.kind]
            ax.axvspan(event.start, event.end, zorder=0, lw=0.0, label=label, **span)
    ax.set(xlabel="time [s]", xlim=(time[0], time[-1]))


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
