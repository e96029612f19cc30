"""The style of all figures: fonts, colours and line styles.

Colours are those of Okabe and Ito, which colour-blind readers can distinguish; every line style
differs as well, for prints in grey. Measured values are drawn twice: thin without smoothing, thick
as their mean over 0.1 s.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np

from calib.base.arrays import Array as Array
from calib.base.arrays import Mask as Mask
from calib.logs.clock import step_of
from calib.run.filters import centred_mean

if TYPE_CHECKING:
    from matplotlib.axes import Axes as Axes
    from matplotlib.figure import Figure as Figure
else:
    Axes = Figure = "of matplotlib, which is imported when something is drawn"

Stroke = dict[str, Any]

WIDTH = 8.27
"""Width of a page [in]: A4."""

BAR = 1e5
"""Pressures are drawn in bar [Pa]."""

DASHED, DOTTED, DASH_DOT, LONG = (0, (4, 1.6)), (0, (1, 1.4)), (0, (5, 1.5, 1, 1.5)), (0, (8, 2))

FRONT: Stroke = {"color": "#0072B2", "linestyle": "-"}
REAR: Stroke = {"color": "#D55E00", "linestyle": DASHED}
BODY: Stroke = {"color": "#222222", "linestyle": "-"}
TRUTH: Stroke = {"color": "#000000", "linestyle": DOTTED, "linewidth": 1.7}
NOMINAL: Stroke = {"color": "#7A7A7A", "linestyle": DASH_DOT}
LAW: Stroke = {"color": "#CC79A7", "linestyle": LONG}
LEVEL: Stroke = {"color": "#009E73", "linestyle": DASHED}
IDENTIFIED: Stroke = {"color": "#009E73", "linestyle": "-"}
WHEEL_STROKES: dict[str, Stroke] = {
    "fl": FRONT,
    "fr": {"color": "#56B4E9", "linestyle": DASH_DOT},
    "rl": REAR,
    "rr": {"color": "#E69F00", "linestyle": DOTTED},
}

SHADE = "#E9E9E9"
_STRIPE = "#B0B0B0"
_RAW = 0.3
"""Opacity of a line without smoothing."""
_BAND = 0.18
"""Opacity of a 95 % band."""
_MEAN = 0.1
"""Width of the mean that is drawn over a noisy line [s]."""

_RC: dict[str, Any] = {
    "font.family": "DejaVu Sans",  # part of matplotlib: the same on every machine
    "font.size": 8.0,
    "axes.titlesize": 8.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.labelsize": 8.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.formatter.useoffset": False,
    "axes.xmargin": 0.01,
    "grid.color": "#DDDDDD",
    "grid.linewidth": 0.5,
    "lines.linewidth": 1.3,
    "legend.fontsize": 7.0,
    "legend.frameon": False,
    "legend.handlelength": 2.3,
    "legend.columnspacing": 1.0,
    "legend.borderaxespad": 0.15,
    "legend.borderpad": 0.1,
    "xtick.labelsize": 7.5,
    "ytick.labelsize": 7.5,
    "figure.titlesize": 11.0,
    "figure.titleweight": "bold",
    "figure.constrained_layout.h_pad": 0.09,
    "figure.constrained_layout.w_pad": 0.07,
    "savefig.dpi": 160,
    "pdf.fonttype": 42,  # text in a PDF can be searched and copied
    "svg.hashsalt": "brake-cal",  # the same ids in every file
}


@contextmanager
def styled() -> Iterator[None]:
    """Context in which to draw and save; the user's settings for other figures are not changed."""
    import matplotlib

    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        for name, value in _RC.items():
            matplotlib.rcParams[name] = value  # type: ignore[index]
        yield


def noisy(
    ax: Axes, time: Array, values: Array, stroke: Stroke, label: str, window: float = _MEAN
) -> None:
    """Draw a measured line: thin without smoothing, thick as centred mean over ``window`` [s]."""
    ax.plot(time, values, color=stroke["color"], linewidth=0.5, alpha=_RAW)
    ax.plot(time, smooth(time, values, window), label=label, **stroke)


def smooth(time: Array, values: Array, window: float = _MEAN) -> Array:
    """Centred mean over ``window`` [s], shape (n,); NaN stays NaN and spreads to no neighbour."""
    width = max(1, round(window / step_of(time))) | 1
    known = np.isfinite(values)
    weight = centred_mean(known.astype(float), width)
    total = centred_mean(np.where(known, values, 0.0), width)
    return np.where(known, total / np.where(known, weight, 1.0), np.nan)


def lines(
    ax: Axes,
    time: Array,
    rows: Sequence[tuple[Array | None, Stroke, str]],
    window: float = _MEAN,
    where: Mask | None = None,
) -> None:
    """Draw measured lines, and set the y range to their means and zero, ``where`` it is true.

    A row is values, stroke and label; one without values is not drawn.
    """
    shown = []
    for values, stroke, label in rows:
        if values is not None:
            noisy(ax, time, values, stroke, label, window)
            mean = smooth(time, values, window)
            shown.append(mean if where is None else mean[where])
    view(ax, *shown, zero=True)


def band(ax: Axes, x: Array, lower: Array, upper: Array, stroke: Stroke) -> None:
    """Draw a 95 % band behind its line."""
    ax.fill_between(x, lower, upper, color=stroke["color"], alpha=_BAND, linewidth=0.0, zorder=1)


def shade(ax: Axes, x: Array, where: Mask) -> None:
    """Shade the whole height of ``ax`` where the mask is true."""
    across = ax.get_xaxis_transform()
    ax.fill_between(x, 0.0, 1.0, where=where, transform=across, color=SHADE, lw=0.0, zorder=0)


def stripe(ax: Axes, start: float, end: float) -> None:
    """Hatch the whole height of ``ax`` between two places."""
    ax.axvspan(start, end, facecolor="none", edgecolor=_STRIPE, hatch="////", lw=0.0)


def beside(
    ax: Axes, text: str, at: tuple[float, float], off: tuple[float, float], **look: Any
) -> None:
    """Write ``text`` beside the point ``at``, ``off`` by so many points."""
    look = {"fontsize": 7.0, **look}
    ax.annotate(text, at, xytext=off, textcoords="offset points", **look)


def zero(ax: Axes) -> None:
    """Draw the line of zero."""
    ax.axhline(0.0, color=BODY["color"], linewidth=0.6)


def view(ax: Axes, *values: Array, zero: bool = False, margin: float = 0.12) -> None:
    """Set the y range to all finite ``values``; other lines of the axis do not change it.

    ``zero`` includes zero. Without a finite value the axis stays unchanged.
    """
    known = np.concatenate([np.ravel(v)[np.isfinite(np.ravel(v))] for v in values] or [np.empty(0)])
    if known.size == 0:
        return
    low, high = float(known.min()), float(known.max())
    if zero:
        low, high = min(low, 0.0), max(high, 0.0)
    room = margin * (high - low) or 0.1 * abs(high) or 1.0
    ax.set_ylim(low if zero and low == 0.0 else low - room, high + room)
