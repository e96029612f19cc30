"""The ramp of a calibration: pressure (Fig. 4), forces (Fig. 5), and points for Figs. 3 and 6."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from calib.plots.measured import MeasuredRamp, grouped
from calib.plots.sheet import Panel
from calib.plots.style import BODY, FRONT, NOMINAL, REAR, Stroke, noisy

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

BAR = 1e5


def panels(ramp: MeasuredRamp, suffix: str = "") -> tuple[Panel, ...]:
    """Pressure and forces over time; ``suffix`` distinguishes the ramps of a table."""
    return (
        Panel(
            f"pressure{suffix}", f"Pressure of {ramp.name} (Fig. 4)", lambda ax: pressure(ax, ramp)
        ),
        Panel(f"forces{suffix}", f"Forces of {ramp.name} (Fig. 5)", lambda ax: forces(ax, ramp), 2),
    )


def pressure(ax: "Axes", ramp: MeasuredRamp) -> None:
    """Pressure over time, Fig. 4."""
    ax.plot(ramp.time, ramp.pressure / BAR, label="greater of the axles' pressures", **BODY)
    ax.set(xlabel="time [s]", ylabel="brake pressure [bar]")


def forces(ax: "Axes", ramp: MeasuredRamp) -> None:
    """Fig. 5, as driven: what the tyres carry of z is between the normalised forces."""
    noisy(ax, ramp.time, ramp.F_f, FRONT, "front $F_f$")
    noisy(ax, ramp.time, ramp.z, NOMINAL, "$z$ as measured")
    noisy(ax, ramp.time, ramp.F_r, REAR, "rear $F_r$")
    noisy(ax, ramp.time, ramp.carried, BODY, "$z$ less air drag")
    ax.set(xlabel="time [s]", ylabel="normalised force, $z$ [1]")


def points(
    ax: "Axes", ramp: MeasuredRamp, x: Array, y: Array, mask: Mask, stroke: Stroke, label: str = ""
) -> None:
    """Blocks as dots, and their means over 0.25 s as rings, those of the rear as triangles."""
    ax.plot(x[mask], y[mask], ".", color=stroke["color"], ms=2.0, alpha=0.35, mew=0.0)
    ring: Stroke = {"color": stroke["color"], "mfc": "white", "ms": 3.4, "mew": 0.8}
    shown = label or "_points"  # labels that begin with an underscore are not in the legend
    marker = "^" if stroke is REAR else "o"
    means = grouped(x, mask), grouped(y, mask)
    ax.plot(*means, marker, linestyle="", label=shown, zorder=3, **ring)
