"""A log without table or vehicle: speeds, pressure, deceleration, raw eta.

The lead-in and the braking are shaded as `calib.signals.driving_record` finds them. The reference
speed is drawn over the rolling radius of the lead-in, so that a wheel below it slips.
"""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from calib.logs.log import Log
from calib.names import WHEELS, G
from calib.physics.braking import MOVING
from calib.plots.sheet import Panel, Sheet
from calib.plots.stop import WHEEL_STROKES
from calib.plots.style import BODY, IDENTIFIED, noisy, smooth, view
from calib.signals.driving_record import (
    NOMINAL_RADIUS,
    DrivingRecord,
    brake_events,
    driving_record,
)
from calib.signals.rolling_radius import rolling_radius

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]

BAR = 1e5
DRIVEN = 0.05
"""Acceleration above which the wheels count as driven [g]."""
WHEEL_PRESSURES = tuple(f"p_{wheel}" for wheel in WHEELS)
SPINS = tuple(f"omega_{wheel}" for wheel in WHEELS)
LEAD_IN, BRAKING = "#EBF6F1", "#EFEFEF"
"""Colours of the lead-in and of the braking, pale behind lines of all colours."""


def sheet(log: Log) -> Sheet:
    """Return the sheet of a log; the note names the channels that are missing and not drawn."""
    panels = log_panels(log)
    missing = [name for name in ("p_mc", "a_x", *SPINS, "v") if name not in log]
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


def log_panels(log: Log) -> tuple[Panel, ...]:
    """The panels for which the log has the channels."""
    wheels = any(name in log for name in SPINS)
    pressures = any(name in log for name in ("p_mc", *WHEEL_PRESSURES))
    found = (
        (wheels or "v" in log, Panel("speeds", "Speeds", lambda ax: speeds(ax, log), 7)),
        (pressures, Panel("pressure", "Brake pressure", lambda ax: pressure(ax, log), 5)),
        ("a_x" in log, Panel("deceleration", "Deceleration", lambda ax: deceleration(ax, log))),
        (
            all(name in log for name in SPINS),
            Panel("eta", "Speed ratio, raw", lambda ax: eta(ax, log)),
        ),
    )
    return tuple(panel for there, panel in found if there)


def motion_of(log: Log) -> DrivingRecord | None:
    """Lead-in and braking of a log; None if it lacks the channels that show them."""
    return driving_record(log) if all(name in log for name in ("a_x", *SPINS)) else None


def _marks(log: Log) -> str:
    """What the shades mean, for the note."""
    motion = motion_of(log)
    if motion is None:
        return ""
    count = len(brake_events(motion))
    braked = f"Grey: braking, {count}\u00d7." if count else "There is no braking."
    return f"Green: the lead-in, unbraked. {braked}" if motion.lead_in.any() else braked


def radius_of(log: Log) -> tuple[float, str]:
    """The radius [m] over which V is drawn, and where it is from."""
    motion = motion_of(log)
    found = None if motion is None else rolling_radius(log, motion)
    if found is None:
        return NOMINAL_RADIUS, "of a usual wheel"
    return found, "from the unbraked part"


def speeds(ax: "Axes", log: Log) -> None:
    """Wheel speeds on the left, the reference speed on the right where there is one."""
    radius, source = radius_of(log)
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


def pressure(ax: "Axes", log: Log) -> None:
    """Master-cylinder pressure, and the wheel pressures where logged."""
    labels = {"p_mc": ("master cylinder", BODY)}
    labels |= {
        f"p_{wheel}": (wheel, {**WHEEL_STROKES[wheel], "linewidth": 1.0}) for wheel in WHEELS
    }
    shown = []
    for name, (label, stroke) in labels.items():
        if name in log:
            noisy(ax, log.time, log[name] / BAR, stroke, label)
            shown.append(smooth(log.time, log[name] / BAR))
    view(ax, *shown, np.array([0.0, 1.0]))  # 1 bar at least: noise stays small
    _frame(ax, log, "pressure [bar]")


def deceleration(ax: "Axes", log: Log) -> None:
    """z = -a_x/g."""
    z = -log["a_x"] / G
    noisy(ax, log.time, z, BODY, "$-a_x/g$")
    view(ax, smooth(log.time, z), zero=True)
    _frame(ax, log, "deceleration [g]")


def eta(ax: "Axes", log: Log) -> None:
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


def _frame(ax: "Axes", log: Log, ylabel: str, named: bool = False) -> None:
    """Label an axis over time, and shade lead-in and braking, ``named`` in its legend."""
    ax.set(xlabel="time [s]", ylabel=ylabel)
    ax.set_xlim(log.time[0], log.time[-1])
    motion = motion_of(log)
    if motion is None:
        return
    first = log.time[motion.lead_in]
    if first.size:
        _span(ax, (first[0], first[-1]), LEAD_IN, "lead-in" if named else "")
    for i, event in enumerate(brake_events(motion)):
        label = "braking" if named and not i else ""
        _span(ax, (event.start, event.end), BRAKING, label)


def _span(ax: "Axes", ends: tuple[float, float], colour: str, label: str) -> None:
    ax.axvspan(*ends, color=colour, linewidth=0.0, zorder=0, label=label or None)
