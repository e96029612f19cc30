"""A sheet in the browser, drawn by Bokeh: panels that zoom together, values under the cursor.

    Sheet --drawn--> Drawn: a place for each panel, and what Bokeh fills it with
    source           Bokeh itself, which stands once in a page and fetches nothing

Panels over one x axis share its ends, and an upright line at the cursor. Where lines know their
deceleration, a slider marks it on each of them.
"""

import json
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any

import numpy as np

from calib.show.panel import BAND, RAW, Line, Mark, Panel
from calib.show.sheet import Sheet
from calib.show.style import LINE_WIDTH, Array, Stroke, envelope

EXTRA = "pages"
"""Extra of the package that brings Bokeh."""
_PARTS = 25_000
"""Parts of a long line; one of at most 100,000 samples has all of them."""
_HEIGHT = 300
"""Height of a panel [px]."""
_PIXEL = 4.0 / 3.0
"""Pixels to the point."""
_STEP = 0.01
"""Step of the slider [g]."""
_MARKERS = {"o": "circle", ".": "circle", "^": "triangle", "v": "inverted_triangle",
            "D": "diamond", "s": "square", "x": "x", "+": "cross", "|": "dash"}  # fmt: skip
_SCROLLS = ":host .bk-events { touch-action: pan-y !important; }"
"""A finger on a panel scrolls the page."""
_LEGEND = {
    "click_policy": "hide", "location": "top_left", "border_line_color": None,
    "background_fill_alpha": 0.0, "label_text_font_size": "11px", "glyph_width": 22,
    "glyph_height": 12, "label_height": 12, "spacing": 8, "padding": 0, "margin": 0,
}  # fmt: skip


@dataclass(frozen=True)
class Drawn:
    """``places`` of the panels by name, in which Bokeh puts the models of a document.

    ``data`` is the document as JSON; ``roots`` its models and their places. ``steps`` (k,) of the
    slider [g], none without it, with ``tracks``: of each line the model of its dot, and where it is
    at each step, (2, k).
    """

    places: dict[str, str]
    data: str
    roots: dict[str, str]
    steps: list[float]
    tracks: list[tuple[str, list[list[float]]]]


def installed() -> bool:
    """Whether Bokeh is there; it comes with the `EXTRA`."""
    return find_spec("bokeh") is not None


def source() -> str:
    """The JavaScript of Bokeh."""
    from bokeh.resources import Resources

    return "\n".join(Resources("inline", components=["bokeh"], minified=True).js_raw)


def drawn(sheet: Sheet, names: Sequence[str], prefix: str) -> Drawn:
    """The panels ``names`` of a sheet, in places whose names begin with ``prefix``."""
    from bokeh.document import Document

    panels, making = {panel.name: panel for panel in sheet.panels}, _Making()
    places = {name: f"{prefix}-{i}" for i, name in enumerate(names)}
    roots, document = {}, Document()
    for name, place in places.items():
        document.add_root(figure := making.figure(panels[name]))
        roots[figure.id] = place
    return Drawn(places, json.dumps(document.to_json(deferred=False)), roots, *making.steps())


class _Making:
    """What the figures of a sheet share: sources by their x, axes by their names and ends.

    ``tracks``: of each line with decelerations its dot, and the line, (3, n) with them.
    """

    def __init__(self) -> None:
        self.sources: dict[int, Any] = {}
        self.axes: dict[tuple[object, ...], tuple[Any, Any]] = {}
        self.tracks: list[tuple[Any, Array]] = []

    def figure(self, panel: Panel) -> Any:
        """One panel with its legend, which is above the axes as on paper."""
        from bokeh.models import BoxZoomTool, PanTool, ResetTool, WheelZoomTool
        from bokeh.plotting import figure

        (ends, cursor), zoom = self._axis(panel), BoxZoomTool()
        fig = figure(
            height=_HEIGHT,
            sizing_mode="stretch_width",
            title=unformatted(panel.title),
            x_axis_label=unformatted(panel.x),
            y_axis_label=unformatted(panel.y),
            x_range=ends,
            y_range=_ends(panel.height),
            tools=[zoom, PanTool(), WheelZoomTool(), ResetTool(), cursor],
            stylesheets=[_SCROLLS],
        )
        fig.toolbar.logo, fig.toolbar.active_drag, fig.toolbar.autohide = None, zoom, True
        for mark in panel.marks:
            _mark(fig, mark)
        shown = [self._line(fig, line) for line in panel.lines]
        fig.add_tools(*_hover(panel, shown))
        for text, *at in panel.texts:
            look = {"text_font_size": "10px", "x_offset": 5, "y_offset": 5, "text_baseline": "top"}
            fig.text(*([value] for value in at), [unformatted(text)], **look)
        for axis in fig.axis:
            axis.update(minor_tick_line_color=None, axis_label_text_font_style="normal")
        if panel.xticks:
            fig.xaxis.ticker = list(range(len(panel.xticks)))
            fig.xaxis.major_label_overrides = dict(enumerate(map(unformatted, panel.xticks)))
        for legend in fig.legend:
            legend.update(**_LEGEND, ncols=panel.columns)
            fig.add_layout(legend, "above")
        return fig

    def _axis(self, panel: Panel) -> tuple[Any, Any]:
        """Ends and cursor of the x axis."""
        from bokeh.models import CrosshairTool, Span

        key = panel.x, panel.xlim, tuple(panel.xticks)
        if key not in self.axes:
            upright = Span(dimension="height", line_color="#555555")
            self.axes[key] = _ends(panel.xlim), CrosshairTool(overlay=upright)
        return self.axes[key]

    def _line(self, fig: Any, line: Line) -> "_Shown":
        """Draw a line with its band, and its mean over what was measured."""
        from bokeh.models import ColumnDataSource

        at = envelope(line.shown, _PARTS)
        key = id(line.x) if at.size == len(line.x) else id(line)
        if key not in self.sources:
            self.sources[key] = ColumnDataSource({"x": np.asarray(line.x, float)[at]})
        of = self.sources[key]

        def column(values: Array) -> str:
            name = f"y{len(of.data)}"
            of.data[name] = values[at].astype(np.float32)
            return name

        values, text = [np.asarray(line.y, float)], "{}"
        if line.band is not None:
            values += [np.asarray(end, float) for end in line.band]
            text = "{} ({} to {})"
        if line.mean:
            values.append(line.shown)
            text = "{} (mean {})"
        names = [column(one) for one in values]
        look, xy = _look(line.look), {"x": "x", "source": of}
        if line.band is not None:
            fig.varea(**xy, y1=names[1], y2=names[2], fill_color=look["color"], fill_alpha=BAND)
        if line.mean:
            fig.line(**xy, y=names[0], color=look["color"], line_alpha=RAW)
        marker, style = line.look.get("marker"), line.look.get("linestyle", "-")
        look |= {"y": names[-1] if line.mean else names[0]}
        if line.label:
            look["legend_label"] = unformatted(line.label)
        glyph = None
        if style:
            glyph = (fig.step if "drawstyle" in line.look else fig.line)(**xy, **look)
        if marker:
            glyph = fig.scatter(**xy, **look | _marker(line.look))
        if line.by is not None:
            dot = ColumnDataSource({"x": [], "y": [], "text": []})
            fig.scatter("x", "y", source=dot, size=9, color=look["color"], line_color="white")
            fig.text("x", "y", "text", source=dot, text_font_size="11px", x_offset=8, y_offset=-5,
                     background_fill_color="white", background_fill_alpha=0.85)  # fmt: skip
            self.tracks.append((dot, np.array([line.by, line.x, line.shown], float)))
        told = text.format(*(f"@{name}{{%.4g}}" for name in names))
        return _Shown(glyph, names, unformatted(line.label), told)

    def steps(self) -> tuple[list[float], list[tuple[str, list[list[float]]]]]:
        """Steps and tracks of the slider, over all decelerations of any line."""
        if not self.tracks:
            return [], []
        every = np.concatenate([line[0] for _, line in self.tracks])
        first, last = np.nanmin(every), np.nanmax(every)
        steps = np.arange(np.ceil(first / _STEP), np.floor(last / _STEP) + 1.0) * _STEP
        tracks = []
        for dot, line in self.tracks:
            at, *xy = line[:, np.argsort(line[0])]
            places = np.array([np.interp(steps, at, ends, np.nan, np.nan) for ends in xy])
            tracks.append((dot.id, places.round(6).tolist()))
        return steps.round(6).tolist(), tracks


@dataclass(frozen=True)
class _Shown:
    """A line in a figure: its ``glyph``, columns and name, and as what the cursor tells it."""

    glyph: Any
    columns: list[str]
    name: str
    told: str


def _hover(panel: Panel, shown: Sequence[_Shown]) -> list[Any]:
    """What tells the values under the cursor: of the lines over the x that most lines have."""
    from bokeh.models import HoverTool

    named = [one for one in shown if one.glyph is not None and (one.name or len(shown) == 1)]
    if not named:
        return []
    shared = Counter(id(one.glyph.data_source) for one in named).most_common(1)[0][0]
    told = [one for one in named if id(one.glyph.data_source) == shared]
    columns = ["x", *(column for one in told for column in one.columns)]
    return [
        HoverTool(
            renderers=[told[0].glyph],
            mode="vline",
            tooltips=[
                (unformatted(panel.x), "@x{%.6g}"),
                *((one.name or unformatted(panel.y), one.told) for one in told),
            ],
            formatters={f"@{name}": "printf" for name in columns},
            point_policy="follow_mouse",
        )
    ]


def _mark(fig: Any, mark: Mark) -> None:
    look = mark.look
    more = {"legend_label": unformatted(mark.label)} if mark.label else {}
    if mark.start == mark.end:
        fig.vspan([mark.start], **_look(look), **more)
    else:
        color = look.get("facecolor", look.get("color"))
        fig.vstrip([mark.start], [mark.end], fill_color=color, line_color=None, **more)


def _look(stroke: Stroke) -> dict[str, Any]:
    """Colour, width and dashes of a line as Bokeh names them."""
    points = stroke.get("linewidth", LINE_WIDTH)
    look = {"color": stroke["color"], "line_width": _PIXEL * points}
    style = stroke.get("linestyle", "-")
    if isinstance(style, tuple):
        dashes = (max(1, round(_PIXEL * points * part)) for part in style[1])
        look["line_dash"] = " ".join(map(str, dashes))
    return look


def _marker(stroke: Stroke) -> dict[str, Any]:
    """Form, size and filling of a marker as Bokeh names them."""
    kind = stroke["marker"]
    return {
        "marker": _MARKERS[kind],
        "size": _PIXEL * stroke.get("ms", 6.0) * (0.5 if kind == "." else 1.0),
        "fill_color": stroke.get("mfc", stroke["color"]),
        "line_width": _PIXEL * stroke.get("mew", 1.0),
        "angle": 0.5 * np.pi if kind == "|" else 0.0,
    }


def _ends(ends: tuple[float, float] | None) -> Any:
    from bokeh.models import DataRange1d, Range1d

    return DataRange1d() if ends is None else Range1d(*map(float, ends))


_SIGNS = {r"\eta": "η", r"\mu": "μ", r"\beta": "β", r"\omega": "ω", "_1": "₁", "_2": "₂",
          "^2": "²", "{": "", "}": ""}  # fmt: skip
_FORMULA = re.compile(r"(?<!\\)\$(.*?)(?<!\\)\$")


def unformatted(text: str) -> str:
    r"""A text of a sheet without formulas, those that a browser would look for among them.

    >>> unformatted(r"slip, $\eta - 1$ [%]"), unformatted(r"$a_x$ [m/s$^2$]")
    ('slip, η - 1 [%]', 'a_x [m/s²]')
    """

    def plain(found: re.Match[str]) -> str:
        words = found[1]
        for sign, letter in _SIGNS.items():
            words = words.replace(sign, letter)
        return words

    told = _FORMULA.sub(plain, text).replace(r"\$", "$")
    return re.sub(r"([$\\])", "\\1\u2060", told)  # no two signs that begin a formula are together
