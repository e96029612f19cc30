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
"""Axis, value, and the ends of the 95 % band."""
Curves = dict[str, tuple[Curve, Curve]]
"""A curve of both tables, by its name: f1, f2, D or g."""
Keys = tuple[str, ...]

FIRST: Stroke = {"linestyle": "-", "linewidth": 1.1}
SECOND: Stroke = {"linestyle": DASHED, "linewidth": 2.0}

COLOURS = {
    "f1": FRONT["color"],
    "f2": REAR["color"],
    "D": IDENTIFIED["color"],
    "g": BODY["color"],
}
SYMBOLS = {"f1": "$f_1$", "f2": "$f_2$", "D": "$D$", "g": "force"}


def sheet(a: Table, b: Table, name_a: str, name_b: str) -> Sheet:
    """Return the sheet of two tables, ``b`` less ``a``."""
    pair = (name_a, name_b)
    first, second = _curves(a), _curves(b)
    both = {key: (first[key], second[key]) for key in first}
    found = diff(a, b)
    gaps = {gap.curve: gap for gap in found.curves}
    change = f"{name_b} less {name_a}"

    def sides(name: str, title: str, keys: Keys) -> tuple[Panel, Panel]:
        return (
            Panel(name, title, curves, (both, keys, pair), 2),
            Panel(f"{name}-gap", change, differences, (both, keys, gaps), 1),
        )

    rows = (
        sides("f1-f2", "Normalised force curves", ("f1", "f2")),
        sides("difference", r"Difference $D = F_f - F_r$", ("D",)),
        sides("tyre", "Common tyre curve", ("g",)),
    )
    return Sheet(
        kind="comparison",
        name=f"{name_a}_{name_b}",
        title=f"{name_a} and {name_b}",
        note=(
            f"{name_a}: digest {a.digest[:16]}. {name_b}: digest {b.digest[:16]}. Bands are 95 %; "
            "that of a difference takes the errors of the two tables as independent."
        ),
        panels=tuple(panel for row in rows for panel in row),
        rows=tuple((left.name, right.name) for left, right in rows),
        heights=(1.3, 1.0, 1.0),
        result=found.verdict.capitalize(),
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


def curves(ax: Axes, both: Curves, keys: Keys, names: Sequence[str]) -> None:
    """The curves ``keys`` of both tables."""
    for key in keys:
        for curve, stroke, name in zip(both[key], (FIRST, SECOND), names, strict=True):
            x, y, lower, upper = curve
            line = {"color": COLOURS[key], **stroke}
            band(ax, x, lower, upper, line)
            ax.plot(x, y, label=f"{SYMBOLS[key]} {name}", **line)
    zero(ax)
    ax.set(xlabel=_axis(keys), ylabel=f"{', '.join(SYMBOLS[key] for key in keys)} [1]")


def differences(ax: Axes, both: Curves, keys: Keys, gaps: dict[str, CurveGap]) -> None:
    """Second less first of the curves ``keys``, each with its largest value in the legend."""
    zero(ax)
    ends = [curve for key in keys for curve in both[key]]
    ax.set_xlim(min(c[0][0] for c in ends), max(c[0][-1] for c in ends))  # as beside it
    for key in keys:
        x, change, half = gap(*both[key])
        if x.size == 0:
            ax.text(0.5, 0.5, "no common range", transform=ax.transAxes, ha="center")
            continue
        line: Stroke = {"color": COLOURS[key], "linestyle": "-" if key != "f2" else DASHED}
        band(ax, x, change - half, change + half, line)
        ax.plot(x, change, label=_largest(key, gaps[key], both[key][0]), **line)
        at = 100.0 * _less(key, gaps[key].at)
        ax.plot(at, gaps[key].largest, "o", color=COLOURS[key], mfc="white", ms=4.5, zorder=4)
    symbols = ", ".join(rf"$\Delta$ {SYMBOLS[key]}" for key in keys)
    ax.set(xlabel=_axis(keys), ylabel=f"{symbols} [1]")


def _largest(key: str, found: CurveGap, first: Curve) -> str:
    """`f1: at most -0.0012 (-3.4 %) at 0.54 %, within the bands`."""
    at = 100.0 * _less(key, found.at)
    of = float(np.interp(at, first[0], first[1]))
    relative = f" ({100.0 * found.largest / of:+.1f}\u00a0%)" if of else ""
    where = f"{at:.2f}\u00a0% {'slip' if key == 'g' else ''}".rstrip()
    held = "within" if found.in_bands <= 1.0 else "outside"
    return f"{SYMBOLS[key]}: {found.largest:+.4f}{relative} at {where}, {held} the bands"


def _less(key: str, at: float) -> float:
    """eta - 1 of a curve over eta; slip as it is."""
    return at if key == "g" else at - 1.0


def _axis(keys: Keys) -> str:
    return "slip [%]" if "g" in keys else ETA


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
