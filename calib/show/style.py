"""Colours and line styles of all figures, and helpers for drawing: smoothing, ends of axes, names.

Fonts and sizes are in `templates/figures.mplstyle`. Colours are those of Okabe and Ito, which
colour-blind readers can distinguish; line styles differ as well, for prints in grey.
"""

import math
import textwrap
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

# "as" lets the other modules of the room import these types from here
from calib.base.arrays import Array as Array
from calib.base.arrays import Index
from calib.base.arrays import Mask as Mask
from calib.logs.clock import step_of
from calib.run.filters import centred_mean, samples_in

if TYPE_CHECKING:
    from matplotlib.axes import Axes as Axes
    from matplotlib.figure import Figure as Figure
else:
    Axes = Figure = Any  # matplotlib is imported when something is drawn

Stroke = dict[str, Any]
"""Look of a line: colour, width, dashes and marker by their names in matplotlib."""

WIDTH, HEIGHT = 8.27, 11.69
"""Width of a page [in], and its largest height: A4."""
LINE_WIDTH = 1.3
"""Usual width of a line [pt]."""
SHADE = "#E9E9E9"
"""Colour of a marked range of an axis."""
ETA = "\u03b7 - 1 [%]"
"""Label of an axis; eta is the wheel speed of the rear axle over that of the front axle (22)."""
MEAN = 0.1
"""Window of the mean of a noisy line [s]."""

DASHED, DOTTED, DASH_DOT, LONG = (0, (4, 1.6)), (0, (1, 1.4)), (0, (5, 1.5, 1, 1.5)), (0, (8, 2))
"""Dashes: an offset, then the lengths of dash, gap, dash ... in line widths."""

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
    """Return a quarter of a ``colour`` #RRGGBB in white; transparent bands would mix to grey."""
    channels = (int(colour[i : i + 2], 16) for i in (1, 3, 5))  # red, green, blue: 0 to 255
    return "#" + "".join(f"{255 - round(0.25 * (255 - channel)):02X}" for channel in channels)


@contextmanager
def styled(outlines: bool = True) -> Iterator[None]:
    """Apply the style while figures are drawn and saved; letters of an SVG are outlines or text."""
    import matplotlib

    file = Path(__file__).parent / "templates" / "figures.mplstyle"
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(matplotlib.rc_params_from_file(file, use_default_template=False))
        matplotlib.rcParams["lines.linewidth"] = LINE_WIDTH
        matplotlib.rcParams["svg.fonttype"] = "path" if outlines else "none"
        yield


def smooth(time: Array, values: Array, window: float = MEAN) -> Array:
    """Return the centred mean (n,) of finite ``values`` over a ``window`` [s]; NaN stays NaN."""
    width = samples_in(window, step_of(time)) | 1  # odd, so that the mean has a middle sample
    is_finite = np.isfinite(values)
    weight = centred_mean(is_finite.astype(float), width)
    total = centred_mean(np.where(is_finite, values, 0.0), width)
    return np.where(is_finite, total / np.where(is_finite, weight, 1.0), np.nan)


def axis_ends(
    *values: Array, with_zero: bool = False, margin: float = 0.12
) -> tuple[float, float] | None:
    """Return the ends of an axis that shows all finite ``values``; None without a finite value.

    ``margin`` is the share of the range that is added at both ends [1]. An axis ``with_zero`` shows
    0, too, and has no margin below 0.
    """
    finite = np.concatenate([np.empty(0), *(v[np.isfinite(v)] for v in values)])
    if finite.size == 0:
        return None
    low, high = float(finite.min()), float(finite.max())
    if with_zero:
        low, high = min(low, 0.0), max(high, 0.0)
    room = margin * (high - low)
    if room == 0.0:  # all values are equal
        room = 0.1 * abs(high) if high else 1.0
    start = low if with_zero and low == 0.0 else low - room
    return start, high + room


def envelope(y: Array, parts: int) -> Index:
    """Return the indices of the points that make a drawn line look like ``y`` (n,).

    ``y`` is cut into ``parts`` of equal length; each gives its lowest and its highest point. A
    line of at most 4 * ``parts`` points keeps all of them.
    """
    if y.size <= 4 * parts:
        return np.arange(y.size)
    width = math.ceil(y.size / parts)
    padded = np.full(parts * width, np.nan)
    padded[: y.size] = y
    rows = padded.reshape(parts, width)
    lowest = np.argmin(np.where(np.isnan(rows), np.inf, rows), axis=1)
    highest = np.argmax(np.where(np.isnan(rows), -np.inf, rows), axis=1)
    points = np.sort([lowest, highest], axis=0) + width * np.arange(parts)  # (2, parts)
    return np.minimum(points.T.ravel(), y.size - 1)  # a part that is all padding has the last point


def names_below(names: Sequence[str]) -> list[str]:
    """Return names in short lines, to stand below the axis of a small panel; [] if too many."""
    if not 0 < len(names) <= 8:
        return []
    letters = 56 // len(names) - 1  # 56 letters fit below an axis, with a space after each name
    return [textwrap.fill(as_text(name), letters) for name in names]


def as_text(name: str) -> str:
    """Return a name in ASCII, with question marks for other letters."""
    plain = "".join(c if c.isascii() and c.isprintable() else "?" for c in name)
    return f" {plain}" if plain.startswith("_") else plain  # matplotlib hides a label like _name
