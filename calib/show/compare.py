"""Two tables side by side: their curves with bands, and their differences.

A colour is a quantity, as on the page of a table; a line style is a table, in the order given.
"""

import numpy as np

from calib.show.sheet import Line, Panel, Sheet
from calib.show.style import BODY, DASHED, FRONT, IDENTIFIED, REAR, Array, Stroke
from calib.show.table import ETA
from calib.table.compare import diff
from calib.table.table import Table

_Curve = tuple[Array, Array, Array, Array]
"""Axis [%], value, and the ends of the 95 % band."""

_STYLES: tuple[Stroke, Stroke] = (
    {"linestyle": "-", "linewidth": 1.1},
    {"linestyle": DASHED, "linewidth": 2.0},
)
_CURVES = {
    "f1": ("$f_1$", FRONT["color"]),
    "f2": ("$f_2$", REAR["color"]),
    "D": ("$D$", IDENTIFIED["color"]),
    "g": ("force", BODY["color"]),
}
_PANELS = (
    ("f1-f2", "Normalised force curves", ("f1", "f2"), ETA),
    ("difference", r"Difference $D = F_f - F_r$", ("D",), ETA),
    ("tyre", "Common tyre curve", ("g",), "slip [%]"),
)
"""The curves of each row: on the left both tables, on the right the second less the first."""


def sheet(a: Table, b: Table, name_a: str, name_b: str) -> Sheet:
    """Return the sheet of two tables, ``b`` less ``a``."""
    first, second = _curves(a), _curves(b)
    panels = []
    for name, title, keys, axis in _PANELS:
        both, gaps = [], []
        for key in keys:
            symbol, colour = _CURVES[key]
            for (x, y, *band), table, style in zip(
                (first[key], second[key]), (name_a, name_b), _STYLES, strict=True
            ):
                look = {"color": colour, **style}
                both.append(Line(x, y, look, f"{symbol} {table}", (band[0], band[1])))
            x, change, half = gap(first[key], second[key])
            if x.size:
                ends = change - half, change + half
                gaps.append(Line(x, change, {"color": colour}, rf"$\Delta$ {symbol}", ends))
        symbols = ", ".join(_CURVES[key][0] for key in keys)
        xs = np.concatenate([line.x for line in both])
        reach = float(xs.min()), float(xs.max())
        panels.append(Panel(name, title, axis, f"{symbols} [1]", both, xlim=reach, columns=2))
        less, change_of = f"{name_b} less {name_a}", rf"$\Delta$ {symbols} [1]"
        panels.append(Panel(f"{name}-gap", less, axis, change_of, gaps, xlim=reach))
    return Sheet(
        kind="comparison",
        name=f"{name_a}_{name_b}",
        panels=tuple(panels),
        rows=tuple((name, f"{name}-gap") for name, *_ in _PANELS),
        heights=(1.3, 1.0, 1.0),
        title=f"{name_a} and {name_b}",
        note=(
            f"{name_a}: digest {a.digest[:16]}. {name_b}: digest {b.digest[:16]}. Bands are 95 %; "
            "that of a difference takes the errors of the two tables as independent."
        ),
        result=diff(a, b).verdict.capitalize(),
    )


def _curves(table: Table) -> dict[str, _Curve]:
    d, p, g = table.difference, table.paper, table.tyre
    eta = 100.0 * (p.eta - 1.0)
    return {
        "f1": (eta, p.f1, p.f1_lower, p.f1_upper),
        "f2": (eta, p.f2, p.f2_lower, p.f2_upper),
        "D": (100.0 * (d.eta - 1.0), d.D, d.lower, d.upper),
        "g": (100.0 * g.slip, g.force, g.lower, g.upper),
    }


def gap(a: _Curve, b: _Curve) -> tuple[Array, Array, Array]:
    """Axis, b - a and the half-width of its 95 % band, at the rows of both on their common range.

    Linear between rows, as in a look-up. Empty when the ranges do not overlap.
    """
    x = np.union1d(a[0], b[0])
    x = x[(x >= max(a[0][0], b[0][0])) & (x <= min(a[0][-1], b[0][-1]))]
    values = [np.interp(x, axis, value) for axis, value, _, _ in (a, b)]
    halves = [np.interp(x, axis, 0.5 * (upper - lower)) for axis, _, lower, upper in (a, b)]
    return x, values[1] - values[0], np.hypot(halves[0], halves[1])
