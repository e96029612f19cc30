"""A table as a picture: f1 and f2 (Fig. 6), map of the pads, tyre (Fig. 3), and posterior."""

import numpy as np

from calib.show import style
from calib.show.map import map_panels
from calib.show.panel import Line, Mark, Panel
from calib.show.posterior import forest, pairs
from calib.show.ramp import MeasuredRamp, points
from calib.show.sheet import Sheet
from calib.show.style import Array, Stroke
from calib.show.torque import UNIT, per_bar
from calib.table.budget import ramp_pads
from calib.table.curves import MEASURED
from calib.table.table import Table

_Ramps = tuple[MeasuredRamp, ...]
_MEASURED_POINTS = "ramps, drag taken out"


def table_sheet(table: Table, name: str, ramps: _Ramps = ()) -> Sheet:
    """Return the sheet of a table with the id ``name``, and the measured points of ``ramps``."""
    (front, rear), pads = per_bar(table), " and ".join(ramp_pads(table))
    torques = f"Brake torque front {front}, rear {rear} {UNIT} per bar"
    panels = (_curves(table, ramps), _tyre(table), *map_panels(table), forest(table), pairs(table))
    return Sheet(
        kind="table",
        name=name,
        panels=panels,
        rows=(("f1-f2", "f1-f2"), ("map", "map-band"), ("tyre", "posterior")),
        heights=(1.4, 1.4, 1.2),
        title=f"Table {name}",
        note=_note(table, bool(ramps)),
        result=f"{torques}, pads {pads} (95 %); curves valid up to {table.paper.usable[1]:.2f} g",
    )


def _note(table: Table, has_points: bool) -> str:
    origin = table.provenance
    names = [log.name for log in origin.logs]
    if table.spread:  # a mean of several cars
        names = [parent.id for parent in origin.parents]
    made_of = f"made of {', '.join(names)} with {origin.program}"
    note = f"Digest {table.digest[:16]}, {made_of}. Bands are 95 %. "
    note += "Dashed: no ramp measured it. Grey: beyond the usable range."
    if has_points:
        note += " Rings and triangles: the ramps without drag, as the table is; means over 0.25 s."
    return note


def _curve(
    x: Array, y: Array, flag: Array, stroke: Stroke, label: str, band: tuple[Array, Array]
) -> list[Line]:
    """Return a curve of a table (n,) with its band; dashed where its ``flag`` is not `MEASURED`."""
    thin: Stroke = {**stroke, "linestyle": style.DASHED, "linewidth": 0.9}
    measured = np.where(flag == MEASURED, y, np.nan)
    thick: Stroke = {**stroke, "linestyle": "-", "linewidth": 1.6}
    return [Line(x, y, thin, band=band), Line(x, measured, thick, label)]


def _tyre(table: Table) -> Panel:
    """Return the panel of Fig. 3: force over load over slip, of both axles, at the mean load."""
    curve = table.tyre
    x, band = 100.0 * curve.slip, (curve.lower, curve.upper)
    return Panel(
        "tyre",
        "Tyre of both axles (Fig. 3)",
        "slip [%]",
        "force over load [1]",
        _curve(x, curve.force, curve.flag, style.IDENTIFIED, "with 95 % band", band),
        xlim=(-0.02 * x[-1], 1.05 * x[-1]),
        ylim=(-0.02 * curve.force[-1], 1.1 * curve.force[-1]),
    )


def _curves(table: Table, ramps: _Ramps) -> Panel:
    """Return the panel of Fig. 6, with the points of ramps on which both axles brake."""
    p, two_axles = table.paper, [ramp for ramp in ramps if ramp.is_two_axles]
    x = 100.0 * (p.eta - 1.0)  # [%]
    lines = [
        *_curve(x, p.f1, p.flag, style.FRONT, "f1, front", (p.f1_lower, p.f1_upper)),
        *_curve(x, p.f2, p.flag, style.REAR, "f2, rear", (p.f2_lower, p.f2_upper)),
    ]
    for i, ramp in enumerate(two_axles):
        eta_percent = 100.0 * (ramp.eta - 1.0)
        lines.append(points(ramp, eta_percent, ramp.f1, style.FRONT, "" if i else _MEASURED_POINTS))
        lines.append(points(ramp, eta_percent, ramp.f2, style.REAR))
    xlim = x[0] - 0.02 * (x[-1] - x[0]), x[-1] + 0.08 * (x[-1] - x[0])
    usable = 100.0 * (p.usable_eta[1] - 1.0)  # highest usable eta - 1 [%]
    upright: Stroke = {"color": style.BODY["color"], "linewidth": 0.9, "linestyle": style.LONG}
    zero = Line(xlim, (0.0, 0.0), {"color": style.BODY["color"], "linewidth": 0.6})
    return Panel(
        "f1-f2",
        "Force over load, less deceleration over g (Fig. 6)",
        style.ETA,
        "f1, f2 [1]",
        [*lines, zero],
        [Mark(usable, usable, upright, f"usable to {usable:.2f} %, {p.usable[1]:.2f} g"),
         Mark(usable, xlim[1], {"color": style.SHADE})],
        xlim=xlim,
        columns=2,
    )  # fmt: skip
