"""A log without table or vehicle: speeds, pressure, deceleration, raw eta."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from calib.logs.log import Log
from calib.names import WHEELS, G
from calib.physics.braking import MOVING
from calib.plots.sheet import Panel, Sheet
from calib.plots.stop import WHEEL_STROKES
from calib.plots.style import BODY, IDENTIFIED, noisy, smooth, view
from calib.signals.driving_record import NOMINAL_RADIUS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]

BAR = 1e5
DRIVEN = 0.05
"""Acceleration above which the wheels count as driven [g]."""
WHEEL_PRESSURES = tuple(f"p_{wheel}" for wheel in WHEELS)
SPINS = tuple(f"omega_{wheel}" for wheel in WHEELS)


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
        note=note + "Nothing is zeroed or corrected.",
        panels=panels,
        rows=tuple((panel.name,) for panel in panels),
        heights=(0.9,) * len(panels),
    )


def log_panels(log: Log) -> tuple[Panel, ...]:
    """The panels for which the log has the channels."""
    wheels = any(name in log for name in SPINS)
    pressures = any(name in log for name in ("p_mc", *WHEEL_PRESSURES))
    found = (
        (wheels or "v" in log, Panel("speeds", "Speeds", lambda ax: speeds(ax, log), 5)),
        (pressures, Panel("pressure", "Brake pressure", lambda ax: pressure(ax, log), 5)),
        ("a_x" in log, Panel("deceleration", "Deceleration", lambda ax: deceleration(ax, log))),
        (
            all(name in log for name in SPINS),
            Panel("eta", "Speed ratio, raw", lambda ax: eta(ax, log)),
        ),
    )
    return tuple(panel for there, panel in found if there)


def speeds(ax: "Axes", log: Log) -> None:
    """Wheel speeds on the left, the reference speed on the right where there is one."""
    wheels = [wheel for wheel in WHEELS if f"omega_{wheel}" in log]
    for wheel in wheels:
        ax.plot(log.time, log[f"omega_{wheel}"], label=wheel, linewidth=1.0, **WHEEL_STROKES[wheel])
    if "v" not in log:
        _frame(ax, log, "wheel speed [rad/s]")
        return
    # at a nominal radius: the car of a log is not known
    scaled = log["v"] / NOMINAL_RADIUS
    ax.plot(log.time, scaled, label=f"$V$ / {NOMINAL_RADIUS:g} m", linewidth=0.8, **BODY)
    _frame(ax, log, "wheel speed [rad/s]")
    right = ax.secondary_yaxis("right", functions=(_to_kmh, _from_kmh))
    right.set_ylabel("$V$ [km/h]")


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
    noisy(ax, log.time, -log["a_x"] / G, BODY, "$-a_x/g$")
    _frame(ax, log, "deceleration [g]")


def eta(ax: "Axes", log: Log) -> None:
    """Eta of the axle means (22), not zeroed, where the wheel speeds are high enough."""
    percent = raw_eta(log)
    noisy(ax, log.time, percent, IDENTIFIED, r"$\omega_r/\omega_f - 1$")
    shown = smooth(log.time, percent)
    if "a_x" in log:  # driven wheels would set a range in which the braking is too small to read
        shown = shown[smooth(log.time, -log["a_x"] / G) > -DRIVEN]
    view(ax, shown)
    _frame(ax, log, r"$\eta - 1$ [%]")


def raw_eta(log: Log) -> Array:
    """100 (eta - 1) [%], (n,); NaN where an axle is below 3 m/s at a nominal radius."""
    front = 0.5 * (log["omega_fl"] + log["omega_fr"])
    rear = 0.5 * (log["omega_rl"] + log["omega_rr"])
    turning = np.minimum(front, rear) > MOVING / NOMINAL_RADIUS
    return np.where(turning, 100.0 * (rear / np.where(turning, front, 1.0) - 1.0), np.nan)


def _to_kmh(omega: Any) -> Any:
    return np.asarray(omega) * NOMINAL_RADIUS * 3.6


def _from_kmh(speed: Any) -> Any:
    return np.asarray(speed) / 3.6 / NOMINAL_RADIUS


def _frame(ax: "Axes", log: Log, ylabel: str) -> None:
    ax.set(xlabel="time [s]", ylabel=ylabel)
    ax.set_xlim(log.time[0], log.time[-1])
