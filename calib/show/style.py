"""The style of all figures: fonts, colours and line styles.

Colours are those of Okabe and Ito, which colour-blind readers can distinguish; every line style
differs as well, for prints in grey.
"""

import textwrap
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np

from calib.base.arrays import Array as Array
from calib.base.arrays import Index as Index
from calib.base.arrays import Mask as Mask
from calib.logs.clock import step_of
from calib.run.filters import centred_mean, samples_in

if TYPE_CHECKING:
    from matplotlib.axes import Axes as Axes
    from matplotlib.figure import Figure as Figure
else:
    Axes = Figure = "of matplotlib, which is imported when something is drawn"

Stroke = dict[str, Any]

WIDTH, HEIGHT = 8.27, 11.69
"""Width of a page [in], and its largest height: A4."""

DASHED, DOTTED, DASH_DOT, LONG = (0, (4, 1.6)), (0, (1, 1.4)), (0, (5, 1.5, 1, 1.5)), (0, (8, 2))

FRONT: Stroke = {"color": "#0072B2", "linestyle": "-"}
REAR: Stroke = {"color": "#D55E00", "linestyle": DASHED}
BODY: Stroke = {"color": "#222222", "linestyle": "-"}
TRUTH: Stroke = {"color": "#000000", "linestyle": DOTTED, "linewidth": 1.7}
NOMINAL: Stroke = {"color": "#7A7A7A", "linestyle": DASH_DOT}
IDENTIFIED: Stroke = {"color": "#009E73", "linestyle": "-"}
WHEEL_STROKES: dict[str, Stroke] = {
    "fl": FRONT,
    "fr": {"color": "#56B4E9", "linestyle": DASH_DOT},
    "rl": REAR,
    "rr": {"color": "#E69F00", "linestyle": DOTTED},
}


def dots(stroke: Stroke, size: float, marker: str = "o", **more: Any) -> Stroke:
    """Points in the colour of a line, of a ``size`` [pt], without the line."""
    return {"color": stroke["color"], "marker": marker, "linestyle": "", "ms": size, **more}


def pale(colour: str) -> str:
    """The colour of a 95 % band; opaque, so that two bands mix to no grey."""
    parts = (int(colour[i : i + 2], 16) for i in (1, 3, 5))
    return "#" + "".join(f"{255 - round(_BAND * (255 - part)):02X}" for part in parts)


_BAND = 0.25
"""Share of the colour of its line in a band, the rest is white."""
SHADE = "#E9E9E9"
ETA = "\u03b7 - 1 [%]"
"""Name of an axis: rear wheel speed over front one."""
LINE_WIDTH = 1.3
"""Width of a line whose look has none [pt]."""
MEAN = 0.1
"""Width of the mean that is drawn over a noisy line [s]."""

_RC: dict[str, Any] = {
    "font.family": "DejaVu Sans",  # part of matplotlib: the same on every machine
    "font.size": 8.0,
    "axes.titlesize": 8.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.titley": 1.0,  # else each drawing looks for ticks that a title would cover
    "axes.labelsize": 8.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.formatter.useoffset": False,
    "axes.xmargin": 0.01,
    "grid.color": "#DDDDDD",
    "grid.linewidth": 0.5,
    "lines.linewidth": LINE_WIDTH,
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
    "text.parse_math": False,  # a name may hold dollars
    "pdf.fonttype": 42,  # text in a PDF can be searched and copied
    "svg.hashsalt": "brake-cal",  # the same ids in every file
}


@contextmanager
def styled(outlines: bool = True) -> Iterator[None]:
    """Context in which to draw and save; the user's settings for other figures are not changed.

    Letters of an SVG are ``outlines``, the same on every machine, or text.
    """
    import matplotlib

    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        for name, value in (_RC | {"svg.fonttype": "path" if outlines else "none"}).items():
            matplotlib.rcParams[name] = value  # type: ignore[index]
        yield


def smooth(time: Array, values: Array, window: float = MEAN) -> Array:
    """Centred mean over ``window`` [s], shape (n,); NaN stays NaN and spreads to no neighbour."""
    width = samples_in(window, step_of(time)) | 1
    is_finite = np.isfinite(values)
    weight = centred_mean(is_finite.astype(float), width)
    total = centred_mean(np.where(is_finite, values, 0.0), width)
    return np.where(is_finite, total / np.where(is_finite, weight, 1.0), np.nan)


def reach(*values: Array, zero: bool = False, margin: float = 0.12) -> tuple[float, float] | None:
    """Ends of an axis that shows all finite ``values``, and 0 with ``zero``; None without any."""
    numbers = np.concatenate([v[np.isfinite(v)] for v in values] or [np.empty(0)])
    if numbers.size == 0:
        return None
    low, high = float(numbers.min()), float(numbers.max())
    if zero:
        low, high = min(low, 0.0), max(high, 0.0)
    room = margin * (high - low) or 0.1 * abs(high) or 1.0
    return (low if zero and low == 0.0 else low - room), high + room


def envelope(y: Array, parts: int) -> Index:
    """Indices of the points of ``y`` (n,) to draw: extremes of each part, or all if few."""
    if y.size <= 4 * parts:
        return np.arange(y.size)
    width = -(-y.size // parts)
    padded = np.full(parts * width, np.nan)
    padded[: y.size] = y
    low, high = (np.where(np.isnan(padded), end, padded) for end in (np.inf, -np.inf))
    lowest = np.argmin(low.reshape(parts, width), axis=1)
    highest = np.argmax(high.reshape(parts, width), axis=1)
    points = np.sort([lowest, highest], axis=0) + width * np.arange(parts)
    return np.minimum(points.T.ravel(), y.size - 1)


def names_below(names: Sequence[str]) -> list[str]:
    """Names as they fit below the axis of a small panel, in short lines; none if they are many."""
    if len(names) > _NAMED:
        return []
    letters = _LETTERS // len(names) - 1 if names else 0
    return [textwrap.fill(as_text(name), letters) for name in names]


_NAMED, _LETTERS = 8, 56
"""Most names below an axis, and letters of all of them side by side."""


def as_text(name: str) -> str:
    """A name in letters of the font; matplotlib hides a label that begins with an underscore."""
    plain = "".join(c if c.isascii() and c.isprintable() else "?" for c in name)
    return " " * plain.startswith("_") + plain
