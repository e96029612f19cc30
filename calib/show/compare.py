"""Two tables side by side: their curves with bands, and their differences.

A colour is a quantity, as on the page of a table; a line style is a table, in the order given.
"""

from collections.abc import Sequence

import numpy as np

from calib.show.sheet import Panel, Sheet
from calib.show.style import BODY, DASHED, FRONT, IDENTIFIED, REAR, Array, Axes, Stroke, band, zero
from calib.show.table import ETA
from calib.table.compare import CurveGap, diff
from calib.table.table import Table

Curve = tuple[Array, Array, Array, Array]
"""Axis [%], value, and the ends of the 95 % band."""
Curves = dict[str, tuple[Curve, Curve]]
"""A curve of both tables, by its name: f1, f2, D or g."""

_STYLES: tuple[Stroke, Stroke] = (
    {"linestyle": "-", "linewidth": 1.1},
    {"linestyle": DASHED, "linewidth": 2.0},
)
_COLOURS = {"f1": FRONT["color"], "f2": REAR["color"], "D": IDENTIFIED["color"], "g": BODY["color"]}
_SYMBOLS = {"f1": "$f_1$", "f2": "$f_2$", "D": "$D$", "g": "force"}
_PANELS = {
    "f1-f2": ("Normalised force curves", ("f1", "f2")),
    "difference": (r"Difference $D = F_f - F_r$", ("D",)),
    "tyre": ("Common tyre curve", ("g",)),
}
"""Title and curves of each row: on the left both tables, on the right the second less the first."""


def sheet(a: Table, b: Table, name_a: str, name_b: str) -> Sheet:
    """Return the sheet of two tables, ``b`` less ``a``."""
    first, second, found = _curves(a), _curves(b), diff(a, b)
    both = {key: (first[key], second[key]) for key in first}
    gaps = {gap.curve: gap for gap in found.curves}
    panels = []
    for name, (title, keys) in _PANELS.items():
        panels.append(Panel(name, title, curves, (both, keys, (name_a, name_b)), 2))
        change = f"{name_b} less {name_a}"
        panels.append(Panel(f"{name}-gap", change, differences, (both, keys, gaps), 1))
    return Sheet(
        kind="comparison",
        name=f"{name_a}_{name_b}",
        title=f"{name_a} and {name_b}",
        note=(
            f"{name_a}: digest {a.digest[:16]}. {name_b}: digest {b.digest[:16]}. Bands are 95 %; "
            "that of a difference takes the errors of the two tables as independent."
        ),
        panels=tuple(panels),
        rows=tuple((name, f"{name}-gap") for name in _PANELS),
        heights=(1.3, 1.0, 1.0),
        result=found.verdict.capitalize(),
    )


def _curves(table: Table) -> dict[str, Curve]:
    d, p, g = table.difference, table.paper, table.tyre
    eta = 100.0 * (p.eta - 1.0)
    return {
        "f1": (eta, p.f1, p.f1_lower, p.f1_upper),
        "f2": (eta, p.f2, p.f2_lower, p.f2_upper),
        "D": (100.0 * (d.eta - 1.0), d.D, d.lower, d.upper),
        "g": (100.0 * g.slip, g.force, g.lower, g.upper),
    }


def curves(ax: Axes, both: Curves, keys: Sequence[str], names: Sequence[str]) -> None:
    """The curves ``keys`` of both tables."""
    for key in keys:
        for (x, y, lower, upper), stroke, name in zip(both[key], _STYLES, names, strict=True):
            line = {"color": _COLOURS[key], **stroke}
            band(ax, x, lower, upper, line)
            ax.plot(x, y, label=f"{_SYMBOLS[key]} {name}", **line)
    zero(ax)
    ax.set(xlabel=_axis(keys), ylabel=f"{', '.join(_SYMBOLS[key] for key in keys)} [1]")


def differences(ax: Axes, both: Curves, keys: Sequence[str], gaps: dict[str, CurveGap]) -> None:
    """Second less first of the curves ``keys``, each with its largest value in the legend."""
    zero(ax)
    ends = [curve[0] for key in keys for curve in both[key]]
    ax.set_xlim(min(x[0] for x in ends), max(x[-1] for x in ends))  # as beside it
    for key in keys:
        x, change, half = gap(*both[key])
        if x.size == 0:
            ax.text(0.5, 0.5, "no common range", transform=ax.transAxes, ha="center")
            continue
        line: Stroke = {"color": _COLOURS[key], "linestyle": "-" if key != "f2" else DASHED}
        found, held = gaps[key], "within" if gaps[key].in_bands <= 1.0 else "outside"
        at = 100.0 * (found.at if key == "g" else found.at - 1.0)
        label = f"{_SYMBOLS[key]}: {found.largest:+.4f} at {at:.2f}\u00a0%, {held} the bands"
        band(ax, x, change - half, change + half, line)
        ax.plot(x, change, label=label, **line)
        ax.plot(at, found.largest, "o", color=_COLOURS[key], mfc="white", ms=4.5, zorder=4)
    symbols = ", ".join(rf"$\Delta$ {_SYMBOLS[key]}" for key in keys)
    ax.set(xlabel=_axis(keys), ylabel=f"{symbols} [1]")


def _axis(keys: Sequence[str]) -> str:
    return "slip [%]" if "g" in keys else ETA


def gap(a: Curve, b: Curve) -> tuple[Array, Array, Array]:
    """Axis, b - a and the half-width of its 95 % band, at the rows of both on their common range.

    Linear between rows, as in a look-up. Empty when the ranges do not overlap.
    """
    x = np.union1d(a[0], b[0])
    x = x[(x >= max(a[0][0], b[0][0])) & (x <= min(a[0][-1], b[0][-1]))]
    values = [np.interp(x, axis, value) for axis, value, _, _ in (a, b)]
    halves = [np.interp(x, axis, 0.5 * (upper - lower)) for axis, _, lower, upper in (a, b)]
    return x, values[1] - values[0], np.hypot(halves[0], halves[1])
