"""Two tables side by side: their curves with bands, and their differences."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from calib.plots.sheet import Panel, Sheet
from calib.plots.style import BODY, DASH_DOT, FRONT, REAR, Stroke, band
from calib.plots.table import ETA
from calib.table.table import Table

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]
Curve = tuple[Array, Array, Array, Array]
"""Axis, value, and the ends of the 95 % band."""

FIRST: Stroke = {"color": "#0072B2", "linestyle": "-"}
SECOND: Stroke = {"color": "#D55E00", "linestyle": DASH_DOT}


def sheet(a: Table, b: Table, name_a: str, name_b: str) -> Sheet:
    """Return the sheet of two tables, ``b`` against ``a``."""
    pair = (name_a, name_b)
    curves = [_curves(table) for table in (a, b)]
    both = {key: (curves[0][key], curves[1][key]) for key in curves[0]}
    return Sheet(
        kind="comparison",
        name=f"{name_a}_{name_b}",
        title=f"{name_b} against {name_a}",
        note=(
            f"{name_a}: digest {a.digest[:16]}. {name_b}: digest {b.digest[:16]}. Bands are 95 %; "
            "that of a difference takes the errors of the two tables as independent."
        ),
        panels=(
            Panel("f1-f2", "Normalised force curves", lambda ax: forces(ax, both, pair), 2),
            Panel("f1-f2-gap", "Change of $f_1$ and $f_2$", lambda ax: force_gaps(ax, both)),
            Panel("difference", r"Difference $D = F_f - F_r$", lambda ax: one(ax, both["D"], pair)),
            Panel("difference-gap", "Change of $D$", lambda ax: one_gap(ax, both["D"])),
            Panel("tyre", "Common tyre curve", lambda ax: tyres(ax, both["g"], pair)),
            Panel("tyre-gap", "Change of the tyre curve", lambda ax: tyre_gap(ax, both["g"])),
        ),
        rows=(("f1-f2", "f1-f2-gap"), ("difference", "difference-gap"), ("tyre", "tyre-gap")),
        heights=(1.3, 1.0, 1.0),
    )


def _curves(table: Table) -> dict[str, Curve]:
    d, p, g = table.difference, table.paper, table.tyre
    eta, slip = 100.0 * (p.eta - 1.0), 100.0 * g.slip
    return {
        "f1": (eta, p.f1, p.f1_lower, p.f1_upper),
        "f2": (eta, p.f2, p.f2_lower, p.f2_upper),
        "D": (100.0 * (d.eta - 1.0), d.D, d.lower, d.upper),
        "g": (slip, g.force, g.lower, g.upper),
    }


def forces(ax: "Axes", both: dict[str, tuple[Curve, Curve]], names: Sequence[str]) -> None:
    """f1 above and f2 below the zero line, for both tables."""
    ax.axhline(0.0, color=BODY["color"], linewidth=0.6)
    for key in ("f1", "f2"):
        _draw_both(ax, both[key], [f"${key[0]}_{key[1]}$ {name}" for name in names])
    ax.set(xlabel=ETA, ylabel="$f_1$, $f_2$ [1]")


def force_gaps(ax: "Axes", both: dict[str, tuple[Curve, Curve]]) -> None:
    """Second less first, of f1 and f2."""
    _draw_gap(ax, both["f1"], FRONT, r"$\Delta f_1$")
    _draw_gap(ax, both["f2"], REAR, r"$\Delta f_2$")
    ax.set(xlabel=ETA, ylabel=r"$\Delta f_1$, $\Delta f_2$ [1]")


def one(ax: "Axes", both: tuple[Curve, Curve], names: Sequence[str]) -> None:
    """D of both tables."""
    _draw_both(ax, both, names)
    ax.set(xlabel=ETA, ylabel="$D$ [1]")


def one_gap(ax: "Axes", both: tuple[Curve, Curve]) -> None:
    """Second less first, of D."""
    _draw_gap(ax, both, BODY, r"$\Delta D$")
    ax.set(xlabel=ETA, ylabel=r"$\Delta D$ [1]")


def tyres(ax: "Axes", both: tuple[Curve, Curve], names: Sequence[str]) -> None:
    """g(slip) of both tables."""
    _draw_both(ax, both, names)
    ax.set(xlabel="slip [%]", ylabel="normalised force [1]")


def tyre_gap(ax: "Axes", both: tuple[Curve, Curve]) -> None:
    """Second less first, of g(slip)."""
    _draw_gap(ax, both, BODY, r"$\Delta g$")
    ax.set(xlabel="slip [%]", ylabel=r"$\Delta g$ [1]")


def _draw_both(ax: "Axes", both: tuple[Curve, Curve], labels: Sequence[str]) -> None:
    for (x, y, lower, upper), stroke, label in zip(both, (FIRST, SECOND), labels, strict=True):
        band(ax, x, lower, upper, stroke)
        ax.plot(x, y, label=label, **stroke)


def _draw_gap(ax: "Axes", both: tuple[Curve, Curve], stroke: Stroke, label: str) -> None:
    ax.axhline(0.0, color=BODY["color"], linewidth=0.6)
    x, difference, half = gap(*both)
    ax.set_xlim(min(c[0][0] for c in both), max(c[0][-1] for c in both))  # as the curves beside it
    if x.size == 0:
        ax.text(0.5, 0.5, "no common range", transform=ax.transAxes, ha="center")
        return
    band(ax, x, difference - half, difference + half, stroke)
    ax.plot(x, difference, label=label, **stroke)


def gap(a: Curve, b: Curve) -> tuple[Array, Array, Array]:
    """Axis, b - a and the half-width of its 95 % band, at the rows of both on their common range.

    Linear between rows, as in a look-up. Empty when the ranges do not overlap.
    """
    start, end = max(a[0][0], b[0][0]), min(a[0][-1], b[0][-1])
    x = np.union1d(a[0], b[0])
    x = x[(x >= start) & (x <= end)]
    values, halves = [], []
    for axis, value, lower, upper in (a, b):
        values.append(np.interp(x, axis, value))
        halves.append(np.interp(x, axis, 0.5 * (upper - lower)))
    return x, values[1] - values[0], np.hypot(halves[0], halves[1])
