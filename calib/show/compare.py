"""Two tables in one picture: their pads, f1 and f2, and what their maps tell.

A colour is a quantity, as on the page of a table; a line style is a table, in the order given.
"""

from calib.show.panel import Line, Panel
from calib.show.sheet import Sheet
from calib.show.style import DASHED, ETA, FRONT, IDENTIFIED, REAR, Stroke, dots
from calib.show.table import map_panel, read_at
from calib.table.compare import Difference, diff
from calib.table.table import Table

_STYLES: tuple[Stroke, Stroke] = (
    {"linestyle": "-", "linewidth": 1.1},
    {"linestyle": DASHED, "linewidth": 2.0},
)
_MARKERS: tuple[Stroke, Stroke] = ({"marker": "o", "mfc": "white"}, {"marker": "s"})
_ASIDE = (-0.1, 0.1)
"""Place of each table beside that of the axle."""
_COLOURS = {"f1": FRONT["color"], "f2": REAR["color"]}
_MAPPED = 0.2
"""Deceleration at which the maps are compared [g]."""


def sheet(a: Table, b: Table, name_a: str, name_b: str) -> Sheet:
    """Return the sheet of two tables."""
    tables = {name_a: a, name_b: b}
    maps = [
        read_at(table.map, _MAPPED, {**IDENTIFIED, **style}, name)
        for (name, table), style in zip(tables.items(), _STYLES, strict=True)
    ]
    of_maps = map_panel(f"Maps at {_MAPPED:g} g: pads over those of the ramp", maps)
    return Sheet(
        kind="comparison",
        name=f"{name_a}_{name_b}",
        panels=(_pads(tables), of_maps, _curves(tables)),
        rows=(("pads", "map"), ("f1-f2", "f1-f2")),
        heights=(1.1,),
        title=f"{name_a} and {name_b}",
        note=f"{name_a}: digest {a.digest[:16]}. {name_b}: digest {b.digest[:16]}. Bands are 95 %.",
        result=_in_words(diff(a, b)),
    )


def _in_words(found: Difference) -> str:
    """The verdict, and the curves and maps that differ by more than the bands of both."""
    beyond = [*found.apart, *(g.curve for g in found.curves if g.in_bands > 1.0)]
    told = ", ".join({"g": "tyre"}.get(name, name) for name in beyond)
    return found.verdict.capitalize() + f" in {told}" * bool(told)


def _pads(tables: dict[str, Table]) -> Panel:
    """Pad friction of the axles on the ramps of the tables, with 95 % intervals."""
    lines = []
    for (name, table), look, aside in zip(tables.items(), _MARKERS, _ASIDE, strict=True):
        pads = (table.calibration.pad_friction_f, table.calibration.pad_friction_r)
        for i, (axle, stroke) in enumerate((("front", FRONT), ("rear", REAR))):
            point = dots(stroke, 6.0, **look)
            lines.append(Line([i + aside] * 2, pads[i].ci95, {"color": stroke["color"]}))
            lines.append(Line([i + aside], [pads[i].value], point, f"{axle}, {name}"))
    return Panel(
        "pads",
        "Pad friction on the ramps",
        "axle",
        "pad friction [1]",
        lines,
        xlim=(-0.5, 1.5),
        xticks=("front", "rear"),
        columns=2,
    )


def _curves(tables: dict[str, Table]) -> Panel:
    lines = []
    for key, colour in _COLOURS.items():
        for (name, table), style in zip(tables.items(), _STYLES, strict=True):
            p = table.paper
            y, lower, upper = (getattr(p, f"{key}{end}") for end in ("", "_lower", "_upper"))
            look = {"color": colour, **style}
            lines.append(Line(100.0 * (p.eta - 1.0), y, look, f"{key}, {name}", (lower, upper)))
    title = "Force over load, less deceleration over g"
    return Panel("f1-f2", title, ETA, "f1, f2 [1]", lines, columns=2)
