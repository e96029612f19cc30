"""A table on a page: Figs. 2, 3 and 6, and D(eta).

With the ramps it was made of, their measured points are drawn too, and Fig. 5.
"""

from dataclasses import replace

import numpy as np

from calib.base.intervals import Z95
from calib.base.plain import plus_minus
from calib.show.ramp import MeasuredRamp, panel, points
from calib.show.sheet import Line, Mark, Panel, Sheet
from calib.show.style import (
    BODY,
    DASHED,
    DOTTED,
    FRONT,
    IDENTIFIED,
    LONG,
    NOMINAL,
    REAR,
    SHADE,
    Array,
    Stroke,
)
from calib.show.vehicle import beta_point, brake_torques, nominal_ratio, rear_per_front
from calib.table.table import BY_HAND, EXTRAPOLATED, INTERPOLATED, MEASURED, Table

_Ramps = tuple[MeasuredRamp, ...]

_FLAGS = {
    MEASURED: ("in the table", "-", 1.6),
    INTERPOLATED: ("interpolated", DASHED, 1.1),
    EXTRAPOLATED: ("extrapolated", DOTTED, 1.1),
    BY_HAND: ("set by hand", "-", 3.0),
}
"""Word, line style and width of each flag of a cell."""

ETA = r"$\eta - 1$ [%]"
_FREED = "ramps, drag taken out"
"""What was done to the measured points beside a curve over eta; the note says it in full."""
_MARKED = 0.1
"""Step between the decelerations that are marked on an axis over eta [g]."""


def sheet(table: Table, name: str, ramps: _Ramps = ()) -> Sheet:
    """Return the sheet of one table. ``name`` is its id; ``ramps`` measured points of its logs."""
    numbers = [""] if len(ramps) == 1 else [f"-{i}" for i in range(1, len(ramps) + 1)]
    of_ramps = [panel(one, f"forces{x}") for one, x in zip(ramps, numbers, strict=True)]
    pads = (table.calibration.pad_friction_f, table.calibration.pad_friction_r)
    front, rear = (plus_minus(pad.value, pad.ci95[1] - pad.value) for pad in pads)
    last = table.paper.usable[1]
    return Sheet(
        kind="table",
        name=name,
        panels=(_torques(table), _tyre(table, ramps), *_over_eta(table, ramps), *of_ramps),
        rows=(
            ("torque-distribution", "tyre"),
            ("f1-f2", "difference"),
            *((panel.name,) * 2 for panel in of_ramps),
        ),
        heights=(1.25, 1.0, *(0.95 for _ in of_ramps)),
        title=f"Table {name}",
        note=_note(table, bool(ramps)),
        result=f"Pad friction front {front}, rear {rear} (95 %); usable up to {last:.2f}\u00a0g",
    )


def _note(table: Table, ramps: bool) -> str:
    origin = table.provenance
    cars = origin.parents if table.spread or table.by_hand else ()
    of = ", ".join([p.id for p in cars] or [log.name for log in origin.logs])
    note = f"Digest {table.digest[:16]}, made of {of} with {table.provenance.program}. "
    note += "Bands are 95 %. Grey: beyond the usable range."
    if ramps:
        note += (
            " Rings and triangles: the ramps, as means over 0.25\u00a0s. Over \u03b7 they are "
            "without air drag, grade and rolling resistance, as the table is: the fit takes these "
            "out, and the estimator adds them."
        )
    return note


def _torques(table: Table) -> Panel:
    """Fig. 2 with the identified and the nominal pads, and the end of the usable range."""
    vehicle, pads, end = table.vehicle, table.calibration, table.paper.usable[1]
    found = rear_per_front(vehicle, pads.pad_friction_f.value, pads.pad_friction_r.value)
    betas = {
        r"$\beta$, pads as identified": (found, IDENTIFIED),
        r"$\beta$, nominal pads": (nominal_ratio(vehicle), NOMINAL),
    }
    panel = brake_torques("Brake torque distribution (Fig. 2)", vehicle, betas, 0.8)
    front, rear = (torque / 1e3 for torque in beta_point(vehicle, found, end))
    mark: Stroke = {"color": BODY["color"], "marker": "|", "ms": 12.0, "mew": 1.4, "linestyle": ""}
    ends, half = np.array(panel.xlim), Z95 * pads.pad_log_ratio.sigma
    band = np.exp(-half) * found * ends, np.exp(half) * found * ends
    more = (
        Line(ends, found * ends, IDENTIFIED, band=band),
        Line([front], [rear], mark, f"usable up to {end:.2f} g"),
    )
    return replace(panel, lines=(*panel.lines, *more))


def by_flag(
    x: Array, y: Array, flag: Array, stroke: Stroke, label: str, band: tuple[Array, Array]
) -> list[Line]:
    """A curve of a table (n,), each piece with the worse flag of its two ends."""
    worse = np.maximum(flag[:-1], flag[1:])
    lines = [Line(x, np.full(x.size, np.nan), stroke, band=band)]
    for value, (word, style, width) in _FLAGS.items():
        piece = worse == value
        if piece.any():
            ends = np.concatenate([piece, [False]]) | np.concatenate([[False], piece])
            look: Stroke = {"color": stroke["color"], "linestyle": style, "linewidth": width}
            # NaN separates the pieces of one flag
            lines.append(Line(x, np.where(ends, y, np.nan), look, f"{label} {word}"))
    return lines


def _tyre(table: Table, ramps: _Ramps) -> Panel:
    """Fig. 3: normalised force over slip, common to both axles, at the mean wheel load."""
    curve = table.tyre
    x, band = 100.0 * curve.slip, (curve.lower, curve.upper)
    lines = by_flag(x, curve.force, curve.flag, IDENTIFIED, "curve", band)
    for i, ramp in enumerate(ramps):
        for slip, force, stroke, word in (
            (ramp.slip_f, ramp.F_f, FRONT, "front"),
            (ramp.slip_r, ramp.F_r, REAR, "rear"),
        ):
            if slip is not None:
                label = "" if i else f"{word} axle, ramps"
                lines.append(points(ramp, 100.0 * slip, force, stroke, label))
    return Panel(
        "tyre",
        "Common tyre curve (Fig. 3)",
        "slip [%]",
        "normalised force [1]",
        lines,
        xlim=(-0.02 * x[-1], 1.05 * x[-1]),
        ylim=(-0.02 * curve.force[-1], 1.1 * curve.force[-1]),
        columns=2,
    )


def _over_eta(table: Table, ramps: _Ramps) -> tuple[Panel, Panel]:
    """Fig. 6 and D; the end of the usable range and the decelerations up to it are marked."""
    p, d = table.paper, table.difference
    x, x_d = 100.0 * (p.eta - 1.0), 100.0 * (d.eta - 1.0)
    f = [
        *by_flag(x, p.f1, p.flag, FRONT, "$f_1$", (p.f1_lower, p.f1_upper)),
        *by_flag(x, p.f2, p.flag, REAR, "$f_2$", (p.f2_lower, p.f2_upper)),
    ]
    D = by_flag(x_d, d.D, d.flag, IDENTIFIED, "$D$", (d.lower, d.upper))
    for i, ramp in enumerate(one for one in ramps if one.both):
        at, freed = 100.0 * (ramp.eta - 1.0), "" if i else _FREED
        f += [points(ramp, at, ramp.f1, FRONT, freed), points(ramp, at, ramp.f2, REAR)]
        D.append(points(ramp, at, ramp.D, IDENTIFIED, freed))
    reach = x[0] - 0.02 * (x[-1] - x[0]), x[-1] + 0.08 * (x[-1] - x[0])
    (low, high), end = p.usable, 100.0 * (p.usable_eta[1] - 1.0)
    line: Stroke = {"color": BODY["color"], "linewidth": 0.9, "linestyle": LONG}
    marks = (
        Mark(end, end, line, f"usable to {end:.2f} %, {high:.2f} g"),
        Mark(end, reach[1], {"color": SHADE}),
    )
    order = np.argsort(p.z)
    decelerations = [z for z in np.arange(_MARKED, high, _MARKED) if z >= low]
    places = np.interp(decelerations, p.z[order], x[order])
    ticks: Stroke = {"color": BODY["color"], "marker": "|", "ms": 6.0, "linestyle": ""}
    zero = [
        Line(reach, (0.0, 0.0), {"color": BODY["color"], "linewidth": 0.6}),
        Line(places, np.zeros(places.size), ticks),
    ]
    below = [(f"{z:.1f} g", at, 0.0) for z, at in zip(decelerations, places, strict=True)]
    above = [(text, at, 0.12 * float(np.max(d.upper))) for text, at, _ in below]
    return (
        Panel("f1-f2", "Normalised force curves (Fig. 6)", ETA, "$f_1$, $f_2$ [1]",
              [*zero, *f], marks, below, reach, columns=2),
        Panel("difference", r"Difference $D = F_f - F_r$", ETA, "$D$ [1]",
              [*zero, *D], marks, above, reach, columns=2),
    )  # fmt: skip
