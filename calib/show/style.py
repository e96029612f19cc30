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
"""Look of a line: colour, width, dashes and marker by their names in matplotlib."""

WIDTH, HEIGHT = 8.27, 11.69
"""Width of a page [in], and its largest height: A4."""

DASHED, DOTTED, DASH_DOT, LONG = (0, (4, 1.6)), (0, (1, 1.4)), (0, (5, 1.5, 1, 1.5)), (0, (8, 2))
"""Dashes: the offset of the first one, then lengths of dashes and gaps over the line's width."""

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
    """Return the look of unconnected points of a ``size`` [pt] in the colour of ``stroke``."""
    return {"color": stroke["color"], "marker": marker, "linestyle": "", "ms": size, **more}


def pale(colour: str) -> str:
    """Return the colour #RRGGBB of the band of a line of a ``colour``: mixed with white.

    A band is opaque, since transparent bands that overlap look grey.
    """
    red_green_blue = (int(colour[i : i + 2], 16) for i in (1, 3, 5))
    return "#" + "".join(f"{255 - round(_BAND * (255 - part)):02X}" for part in red_green_blue)


_BAND = 0.25
"""Share of the line's colour in its band [1]."""
SHADE = "#E9E9E9"
"""Colour of a range on an axis."""
ETA = "\u03b7 - 1 [%]"
"""Label of an axis; eta is the wheel speed of the rear axle over that of the front axle (22)."""
LINE_WIDTH = 1.3
"""Usual width of a line [pt]."""
MEAN = 0.1
"""Window of the mean of a noisy line [s]."""

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
    """Apply the style within a context, in which figures are drawn and saved.

    Letters of an SVG are ``outlines``, which look the same on every machine, or else text.
    """
    import matplotlib

    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        for name, value in (_RC | {"svg.fonttype": "path" if outlines else "none"}).items():
            matplotlib.rcParams[name] = value  # type: ignore[index]
        yield


def smooth(time: Array, values: Array, window: float = MEAN) -> Array:
    """Return the centred mean (n,) of finite ``values`` over a ``window`` [s]; NaN stays NaN."""
    width = samples_in(window, step_of(time)) | 1
    is_finite = np.isfinite(values)
    weight = centred_mean(is_finite.astype(float), width)
    total = centred_mean(np.where(is_finite, values, 0.0), width)
    return np.where(is_finite, total / np.where(is_finite, weight, 1.0), np.nan)


def axis_ends(
    *values: Array, with_zero: bool = False, margin: float = 0.12
) -> tuple[float, float] | None:
    """Return the ends of an axis that shows all finite ``values``; None without a finite value.

    ``margin`` at both ends is over the range of the values [1]. An axis ``with_zero`` shows 0, too,
    and has no margin below 0.
    """
    finite = np.concatenate([np.empty(0), *(v[np.isfinite(v)] for v in values)])
    if finite.size == 0:
        return None
    low, high = float(finite.min()), float(finite.max())
    if with_zero:
        low, high = min(low, 0.0), max(high, 0.0)
    room = margin * (high - low) or 0.1 * abs(high) or 1.0
    return (low if with_zero and low == 0.0 else low - room), high + room


def envelope(y: Array, parts: int) -> Index:
    """Return the indices of the lowest and the highest point of ``y`` (n,) in each of ``parts``.

    These points look like the line. A short line keeps all its points.
    """
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
    """Return the names in short lines that fit below the axis of a small panel; [] if many."""
    if not 0 < len(names) <= _NAMED:
        return []
    letters = _LETTERS // len(names) - 1
    return [textwrap.fill(as_text(name), letters) for name in names]


_NAMED, _LETTERS = 8, 56
"""Largest number of names below an axis; letters that fit there side by side."""


def as_text(name: str) -> str:
    """Return a name in ASCII, other letters as question marks.

    A space goes before an underscore, since matplotlib hides a label that begins with one.
    """
    plain = "".join(c if c.isascii() and c.isprintable() else "?" for c in name)
    return f" {plain}" if plain.startswith("_") else plain
