"""A sheet in the browser, drawn by Bokeh: panels that zoom together, values under the cursor.

    Sheet --drawn--> Drawn: a place for each panel, and what Bokeh fills it with
    source           Bokeh itself, which stands once in a page and fetches nothing

Panels over one x axis share its ends, and an upright line at the cursor.
"""

import json
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any

import numpy as np

from calib.show.panel import RAW, Field, Line, Mark, Panel
from calib.show.sheet import Sheet
from calib.show.style import LINE_WIDTH, Array, Stroke, envelope, pale

EXTRA = "pages"
"""Extra of the package that brings Bokeh."""
_PARTS = 25_000
"""Parts of an `envelope`: a line of at most 100,000 samples has all of them."""
_HEIGHT = 300
"""Height of a panel [px]."""
_PIXEL = 4.0 / 3.0
"""Pixels to the point."""
_MARKERS = {"o": "circle", ".": "dot", "^": "triangle", "D": "diamond", "|": "cross"}
_SCROLLS = ":host .bk-events { touch-action: pan-y !important; }"
"""A finger on a panel scrolls the page."""
_LEGEND = {
    "click_policy": "hide", "location": "top_left", "border_line_color": None,
    "background_fill_alpha": 0.0, "label_text_font_size": "11px", "glyph_width": 22,
    "glyph_height": 12, "label_height": 12, "spacing": 8, "padding": 0, "margin": 0,
}  # fmt: skip
_TEXT = {"text_font_size": "10px", "x_offset": 5, "y_offset": 5, "text_baseline": "top"}


@dataclass(frozen=True)
class Drawn:
    """A document as JSON ``data``, its models (``roots``), and ``places`` of the panels by name."""

    places: dict[str, str]
    data: str
    roots: dict[str, str]


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
    return Drawn(places, json.dumps(document.to_json(deferred=False)), roots)


class _Making:
    """Figures of a sheet; those with one x share its data, and those with one axis its range."""

    def __init__(self) -> None:
        self.sources: dict[int, Any] = {}
        self.axes: dict[tuple[object, ...], tuple[Any, Any]] = {}

    def figure(self, panel: Panel) -> Any:
        """One panel with its legend, which is above the axes as on paper."""
        from bokeh.models import BoxZoomTool, PanTool, ResetTool, WheelZoomTool
        from bokeh.plotting import figure

        (ends, cursor), zoom = self._axis(panel), BoxZoomTool()
        fig = figure(
            height=_HEIGHT,
            sizing_mode="stretch_width",
            title=_plain(panel.title),
            x_axis_label=_plain(panel.x),
            y_axis_label=_plain(panel.y),
            x_range=ends,
            y_range=_ends(panel.height),
            tools=[zoom, PanTool(), WheelZoomTool(), ResetTool(), cursor],
            stylesheets=[_SCROLLS],
        )
        fig.toolbar.logo, fig.toolbar.active_drag, fig.toolbar.autohide = None, zoom, True
        if panel.field is not None:
            _image(fig, panel, panel.field)
        for mark in panel.marks:
            _mark(fig, mark)
        shown = [self._line(fig, line) for line in panel.lines]
        fig.add_tools(*(_hover(panel, shown) if panel.field is None else ()))
        bands = [one for one in fig.renderers if one.level == "underlay"]  # first line on top
        fig.renderers = [*reversed(bands), *(one for one in fig.renderers if one not in bands)]
        for text, x, y in panel.texts:
            is_right = panel.xlim is not None and x > np.mean(panel.xlim)
            side = {"text_align": "right", "x_offset": -5} if is_right else {}
            fig.text([x], [y], [_plain(text)], **_TEXT | side)
        for axis in fig.axis:
            axis.update(minor_tick_line_color=None, axis_label_text_font_style="normal")
        for axis, words in ((fig.xaxis, panel.xticks), (fig.yaxis, panel.yticks)):
            if words:
                axis.ticker = list(range(len(words)))
                axis.major_label_overrides = dict(enumerate(map(_plain, words)))
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

    def _columns(self, line: Line, values: Sequence[Array]) -> tuple[Any, list[str]]:
        """The source of a line, and the names of its ``values`` there."""
        from bokeh.models import ColumnDataSource

        points = envelope(line.shown, _PARTS)
        key = id(line.x) if points.size == len(line.x) else id(line)
        if key not in self.sources:
            self.sources[key] = ColumnDataSource({"x": np.asarray(line.x, float)[points]})
        source, names = self.sources[key], []
        for one in values:
            names.append(f"y{len(source.data)}")
            source.data[names[-1]] = one[points].astype(np.float32)
        return source, names

    def _line(self, fig: Any, line: Line) -> tuple[Any, list[str], str, str]:
        """Draw a line with its band, or its mean over measured values.

        Returns its glyph, columns, name, and text under the cursor.
        """
        values, tooltip = [line.shown], "{}"
        if line.mean:
            values, tooltip = [np.asarray(line.y, float), line.shown], "{} (mean {})"
        if line.band is not None:
            low, high = (np.asarray(end, float) for end in line.band)
            values, tooltip = [low, high, line.shown], "{2} ({0} to {1})"
        source, names = self._columns(line, values)
        look, xy = _look(line.look), {"x": "x", "source": source}
        if line.band is not None:
            fig.varea(
                **xy, y1=names[0], y2=names[1], fill_color=pale(look["color"]), level="underlay"
            )
        elif line.mean:
            fig.line(**xy, y=names[0], color=look["color"], line_alpha=RAW)
        name, glyph = _plain(line.label), None
        look |= {"y": names[-1]} | ({"legend_label": name} if name else {})
        if line.look.get("linestyle", "-"):
            glyph = fig.line(**xy, **look)
        if "marker" in line.look:
            glyph = fig.scatter(
                **xy,
                **look,
                marker=_MARKERS[line.look["marker"]],
                size=_PIXEL * line.look.get("ms", 6.0),
                fill_color=line.look.get("mfc", line.look["color"]),
            )
        return glyph, names, name, tooltip.format(*(f"@{x}{{%.4g}}" for x in names))


def _hover(panel: Panel, shown: Sequence[tuple[Any, list[str], str, str]]) -> list[Any]:
    """Tool that shows values under the cursor, of the lines over the commonest x."""
    from bokeh.models import HoverTool

    named = [one for one in shown if one[0] is not None and (one[2] or len(shown) == 1)]
    if not named:
        return []
    shared = Counter(id(glyph.data_source) for glyph, *_ in named).most_common(1)[0][0]
    hovered = [one for one in named if id(one[0].data_source) == shared]
    columns = ["x", *(column for _, columns, *_ in hovered for column in columns)]
    rows = [(name or _plain(panel.y), text) for *_, name, text in hovered]
    return [
        HoverTool(
            renderers=[hovered[0][0]],
            mode="vline",
            tooltips=[(_plain(panel.x), "@x{%.6g}"), *rows],
            formatters={f"@{name}": "printf" for name in columns},
            point_policy="follow_mouse",
        )
    ]


def _image(fig: Any, panel: Panel, field: Field) -> None:
    """Draw a field with its scale, and its values under the cursor."""
    from bokeh.models import HoverTool, LinearColorMapper
    from matplotlib import colormaps
    from matplotlib.colors import to_hex

    (left, right, bottom, top), (cmap, low, high) = field.ends, field.scale
    colours = [to_hex(colour) for colour in colormaps[cmap](np.linspace(0.0, 1.0, 256))]
    colour = LinearColorMapper(colours, low=low, high=high, nan_color="#ffffff")
    place = {"x": left, "y": bottom, "dw": right - left, "dh": top - bottom, "level": "image"}
    image = fig.image(image=[field.values.astype(np.float32)], color_mapper=colour, **place)
    fig.add_layout(image.construct_color_bar(width=12), "right")
    names = (panel.x, "$x"), (panel.y, "$y"), ("value", "@image{0.000}")
    fig.add_tools(HoverTool(renderers=[image], tooltips=[*names]))


def _mark(fig: Any, mark: Mark) -> None:
    more = {"legend_label": _plain(mark.label)} if mark.label else {}
    if mark.start == mark.end:
        fig.vspan([mark.start], **_look(mark.look), **more)
    else:
        colour = mark.look["color"]
        fig.vstrip([mark.start], [mark.end], fill_color=colour, line_color=None, **more)


def _look(stroke: Stroke) -> dict[str, Any]:
    """Colour, width and dashes of a line as Bokeh names them."""
    points = stroke.get("linewidth", LINE_WIDTH)
    look = {"color": stroke["color"], "line_width": _PIXEL * points}
    style = stroke.get("linestyle", "-")
    if isinstance(style, tuple):
        dashes = (max(1, round(_PIXEL * points * part)) for part in style[1])
        look["line_dash"] = " ".join(map(str, dashes))
    return look


def _ends(ends: tuple[float, float] | None) -> Any:
    from bokeh.models import DataRange1d, Range1d

    return DataRange1d() if ends is None else Range1d(*map(float, ends))


def _plain(text: str) -> str:
    """A text in which MathJax sees no formula: a word joiner follows each of its signs."""
    return re.sub(r"([$\\])", "\\1\u2060", text)
