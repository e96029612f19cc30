"""A table on a page: Figs. 2, 3 and 6, and D(eta).

With the ramps it was made of, their measured points are drawn too, and Fig. 5.
"""

import numpy as np

from calib.base.plain import plus_minus
from calib.show import ramp as ramp_figures
from calib.show.ramp import MeasuredRamp, points
from calib.show.sheet import Panel, Sheet
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
    Axes,
    Stroke,
    band,
    beside,
    zero,
)
from calib.show.vehicle import P, distribution
from calib.table.table import BY_HAND, EXTRAPOLATED, INTERPOLATED, MEASURED, Table

_Ramps = tuple[MeasuredRamp, ...]

_FLAGS = {
    MEASURED: ("in the table", "-", 1.6),
    INTERPOLATED: ("interpolated", DASHED, 1.1),
    EXTRAPOLATED: ("extrapolated", DOTTED, 1.1),
    BY_HAND: ("set by hand", "-", 3.0),
}
"""Word, line style and width of each flag of a cell."""

_FIG_2 = "Brake torque distribution (Fig. 2)"
ETA = r"$\eta - 1$ [%]"
_FREED = "drag taken out"
"""What was done to the measured points beside a curve over eta; the note says it in full."""
_MARKED = 0.1
"""Step between the decelerations that are marked on an axis over eta [g]."""


def sheet(table: Table, name: str, ramps: _Ramps = ()) -> Sheet:
    """Return the sheet of one table. ``name`` is its id; ``ramps`` measured points of its logs."""
    of_ramps = ramp_figures.panels(ramps)
    both = (table, ramps)
    return Sheet(
        kind="table",
        name=name,
        title=f"Table {name}",
        note=_note(table, ramps),
        result=_result(table),
        panels=(
            Panel("torque-distribution", _FIG_2, distribution, (table,), 2),
            Panel("tyre", "Common tyre curve (Fig. 3)", tyre, both, 2),
            Panel("f1-f2", "Normalised force curves (Fig. 6)", f1_f2, both, 2),
            Panel("difference", r"Difference $D = F_f - F_r$", difference, both, 2),
            *of_ramps,
        ),
        rows=(
            ("torque-distribution", "tyre"),
            ("f1-f2", "difference"),
            *((panel.name,) * 2 for panel in of_ramps),
        ),
        heights=(1.25, 1.0, *(0.95 for _ in of_ramps)),
    )


def _result(table: Table) -> str:
    """Pads and usable range in words."""
    pads = (table.calibration.pad_friction_f, table.calibration.pad_friction_r)
    front, rear = (plus_minus(pad.value, pad.ci95[1] - pad.value) for pad in pads)
    last = table.paper.usable[1]
    return f"Pad friction front {front}, rear {rear} (95 %); usable up to {last:.2f}\u00a0g"


def _note(table: Table, ramps: _Ramps) -> str:
    origin = table.provenance
    of = ", ".join([p.id for p in origin.parents] or [log.name for log in origin.logs])
    note = f"Digest {table.digest[:16]}, made of {of} with {table.provenance.program}. "
    note += "Bands are 95 %."
    if ramps:
        note += (
            " Rings and triangles: the ramps, as means over 0.25\u00a0s; dots: blocks of "
            "50\u00a0ms. Over \u03b7 they are without air drag, grade and rolling resistance, as "
            "the table is: the fit takes these out, and the estimator adds them. Grey: beyond the "
            "usable range; \u03b7 hardly rises any more there, or falls, or the points are too few."
        )
    return note


def by_flag(ax: Axes, x: Array, y: Array, flag: Array, stroke: Stroke, label: str) -> None:
    """Draw a curve of a table, each piece with the worse flag of its two ends."""
    worse = np.maximum(flag[:-1], flag[1:])
    for value, (word, style, width) in _FLAGS.items():
        piece = worse == value
        if piece.any():
            ends = np.concatenate([piece, [False]]) | np.concatenate([[False], piece])
            line: Stroke = {"color": stroke["color"], "linestyle": style, "linewidth": width}
            # NaN separates the pieces of one flag
            ax.plot(x, np.where(ends, y, np.nan), label=f"{label} {word}", **line)


def tyre(ax: Axes, table: Table, ramps: _Ramps = ()) -> None:
    """Fig. 3: normalised force over slip, common to both axles, at the mean wheel load."""
    curve = table.tyre
    percent = 100.0 * curve.slip
    band(ax, percent, curve.lower, curve.upper, IDENTIFIED)
    by_flag(ax, percent, curve.force, curve.flag, IDENTIFIED, "curve")
    for i, ramp in enumerate(ramps):
        for slip, force, stroke, word in (
            (ramp.slip_f, ramp.F_f, FRONT, "front"),
            (ramp.slip_r, ramp.F_r, REAR, "rear"),
        ):
            if slip is not None:
                label = "" if i else f"{word} axle, ramps"
                points(ax, ramp, 100.0 * slip, force, ramp.braked, stroke, label)
    _mark_p(ax, table)
    ax.set(xlabel="slip [%]", ylabel="normalised force [1]")
    ax.set_xlim(-0.02 * percent[-1], 1.05 * percent[-1])
    ax.set_ylim(-0.02 * curve.force[-1], 1.1 * curve.force[-1])


def _mark_p(ax: Axes, table: Table) -> None:
    """Mark the axles on the curve at 0.3 g, if the table reaches there."""
    low, high = table.paper.decelerations
    if not low <= P <= high + 1e-9:  # a table may end there, with a rounding error
        return
    order = np.argsort(table.paper.z)
    for f, word in ((table.paper.f1, "front"), (table.paper.f2, "rear")):
        force = P + float(np.interp(P, table.paper.z[order], f[order]))
        slip = 100.0 * float(np.interp(force, table.tyre.force, table.tyre.slip))
        ax.plot(slip, force, "s", color=BODY["color"], ms=4.0, zorder=4)
        beside(ax, f"{word} at {P:g} g", (slip, force), (9.0, -13.0))


def f1_f2(ax: Axes, table: Table, ramps: _Ramps = ()) -> None:
    """Fig. 6: f1 and f2 over eta with their bands."""
    curve = table.paper
    x = 100.0 * (curve.eta - 1.0)
    zero(ax)
    for f, lower, upper, stroke, label in (
        (curve.f1, curve.f1_lower, curve.f1_upper, FRONT, "$f_1$"),
        (curve.f2, curve.f2_lower, curve.f2_upper, REAR, "$f_2$"),
    ):
        band(ax, x, lower, upper, stroke)
        by_flag(ax, x, f, curve.flag, stroke, label)
    for i, ramp in enumerate(_over_both(ramps)):
        _over_eta(ax, table, ramp, ramp.f1, FRONT, "" if i else f"$f_1$, ramps, {_FREED}")
        _over_eta(ax, table, ramp, ramp.f2, REAR, "" if i else f"$f_2$, ramps, {_FREED}")
    _usable(ax, table, below=True)
    ax.set(xlabel=ETA, ylabel="$f_1$, $f_2$ [1]")


def difference(ax: Axes, table: Table, ramps: _Ramps = ()) -> None:
    """D(eta) with its band."""
    curve = table.difference
    x = 100.0 * (curve.eta - 1.0)
    band(ax, x, curve.lower, curve.upper, IDENTIFIED)
    by_flag(ax, x, curve.D, curve.flag, IDENTIFIED, "$D$")
    for i, ramp in enumerate(_over_both(ramps)):
        _over_eta(ax, table, ramp, ramp.D, IDENTIFIED, "" if i else f"ramps, {_FREED}")
    _usable(ax, table)
    ax.set(xlabel=ETA, ylabel="$D$ [1]")


def _over_both(ramps: _Ramps) -> _Ramps:
    """The ramps that the curves over eta are of: with both axles."""
    return tuple(ramp for ramp in ramps if ramp.both)


def _over_eta(
    ax: Axes, table: Table, ramp: MeasuredRamp, y: Array, stroke: Stroke, label: str
) -> None:
    """Measured points; grey above the last deceleration that is usable.

    Their entry in the legend is that of the first curve with such points.
    """
    x = 100.0 * (ramp.eta - 1.0)
    last = table.paper.usable[1]
    beyond = ramp.z_free > last
    points(ax, ramp, x, y, ramp.braked & ~beyond, stroke, label)
    grey = f"above {last:.2f} g: not usable"
    told = grey in ax.get_legend_handles_labels()[1] or not label
    points(ax, ramp, x, y, ramp.braked & beyond, NOMINAL, "" if told else grey)


def _usable(ax: Axes, table: Table, below: bool = False) -> None:
    """Mark the end of the usable range, and on the line of zero the decelerations up to it."""
    x, z = 100.0 * (table.paper.eta - 1.0), table.paper.z
    (low, high), end = table.paper.usable, 100.0 * (table.paper.usable_eta[1] - 1.0)
    label = f"usable to {end:.2f} %, {high:.2f} g"
    ax.axvline(end, label=label, color=BODY["color"], linewidth=0.9, linestyle=LONG)
    _reach(ax, x)
    ax.axvspan(end, ax.get_xlim()[1], color=SHADE, linewidth=0.0, zorder=0)
    order = np.argsort(z)
    for mark in np.arange(_MARKED, high, _MARKED):
        if mark < low:
            continue
        at = float(np.interp(mark, z[order], x[order]))
        ax.plot(at, 0.0, "|", color=BODY["color"], ms=6.0, zorder=4)
        off = (0.0, -9.5 if below else 5.0)
        beside(ax, f"{mark:.1f} g", (at, 0.0), off, ha="center", fontsize=6.5)


def _reach(ax: Axes, x: Array) -> None:
    """Set the common range of all panels over eta."""
    ax.set_xlim(x[0] - 0.02 * (x[-1] - x[0]), x[-1] + 0.08 * (x[-1] - x[0]))
