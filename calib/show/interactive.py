"""A sheet in the browser, drawn by Bokeh: panels that zoom together, values at the pointer.

    Sheet --script_of--> a call of `live` in templates/live.js, which draws the panels

Panels with the same x axis share its ends, its line at the pointer, and two cursors set by taps.
"""

import json
import math
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from typing import Any

import numpy as np

from calib.show.panel import RAW, Field, Line, Mark, Panel
from calib.show.sheet import Sheet
from calib.show.style import LINE_WIDTH, Array, Stroke, envelope, pale

EXTRA = "pages"
"""Extra of the package that brings Bokeh."""
_PIXEL = 4.0 / 3.0
"""Pixels to the point."""
_MARKERS = {
    "o": "circle", ".": "dot", "^": "triangle", "v": "inverted_triangle", "D": "diamond",
    "s": "square", "P": "plus", "X": "x",
}  # fmt: skip
"""Names of markers in Bokeh, by those in matplotlib."""
_LEGEND = {
    "click_policy": "hide", "location": "top_left", "border_line_color": None,
    "background_fill_alpha": 0.0, "label_text_font_size": "11px", "glyph_width": 22,
    "glyph_height": 12, "label_height": 12, "spacing": 8, "padding": 2, "margin": 0,
}  # fmt: skip
_ID = re.compile(r'(?<="id": ")p\d+(?=")|(?<=[{ ]")p\d+(?=": "sheet-)')
"""Id of a model of Bokeh, in a document and where it names the place of a panel."""
_TEXT = {"text_font_size": "10px", "x_offset": 5, "y_offset": 5, "text_baseline": "top"}


def installed() -> bool:
    """Return whether Bokeh is installed."""
    return find_spec("bokeh") is not None


def source() -> str:
    """Return the JavaScript of Bokeh, which a page holds once."""
    from bokeh.resources import Resources

    return "\n".join(Resources("inline", components=["bokeh"], minified=True).js_raw)


def script_of(sheet: Sheet, places: Mapping[str, str]) -> str:
    """Return the script that draws panels, escaped for HTML.

    ``places`` are the ids of the elements of the page to fill, by the names of the panels.
    """
    from bokeh.document import Document

    drawing, roots, document = _Drawing(), {}, Document()
    for name, place in places.items():
        figure = drawing.figure(sheet.by_name[name])
        document.add_root(figure)
        roots[figure.id] = place
    call = f"live({json.dumps(document.to_json(deferred=False))}, {json.dumps(roots)});"
    # Bokeh numbers all models of the process; numbered by their order here, equal pages are equal
    ids = {id_: f"p{number}" for number, id_ in enumerate(dict.fromkeys(_ID.findall(call)))}
    return _ID.sub(lambda id_: ids[id_[0]], call).replace("<", "\\u003c")


class _Drawing:
    """Figures of a sheet."""

    def __init__(self) -> None:
        # data that lines with the same x share, by Python's `id` of x
        self.sources: dict[int, Any] = {}
        # what panels with the same x axis share, by its label, ends and ticks
        self.axes: dict[tuple[object, ...], tuple[Any, ...]] = {}

    def figure(self, panel: Panel) -> Any:
        """Return the figure of a panel, with its legend above the axes as on paper."""
        from bokeh.models import BoxZoomTool, PanTool, ResetTool, WheelZoomTool
        from bokeh.plotting import figure

        ends, crosshair, *cursors = self._axis(panel)
        zoom = BoxZoomTool()
        labels = {line.label for line in panel.lines} | {mark.label for mark in panel.marks}
        legend_rows = math.ceil(len(labels - {""}) / panel.columns)
        fig = figure(
            height=250 + 20 * legend_rows,  # [px]
            sizing_mode="stretch_width",
            title=_plain(panel.title),
            x_axis_label=_plain(panel.x),
            y_axis_label=_plain(panel.y),
            x_range=ends,
            y_range=_ends(panel.y_ends),
            tools=[zoom, PanTool(), WheelZoomTool(), ResetTool(), crosshair],
            # a finger that moves on a panel scrolls the page
            stylesheets=[":host .bk-events { touch-action: pan-y !important; }"],
        )
        fig.toolbar.logo, fig.toolbar.active_drag, fig.toolbar.autohide = None, zoom, True
        lines = [self._line(fig, line) for line in panel.lines]
        for mark in panel.marks:
            _mark(fig, mark)
        if panel.field is not None:
            _image(fig, panel, panel.field)
        elif hover := _hover(panel, lines):
            fig.add_tools(hover)
            for cursor in cursors:
                fig.add_layout(cursor)
        bands = [glyph for glyph in fig.renderers if glyph.level == "underlay"]
        others = [glyph for glyph in fig.renderers if glyph not in bands]
        fig.renderers = [*reversed(bands), *others]  # the band of the first line is on top
        for text, x, y in panel.texts:
            side = {"text_align": "right", "x_offset": -5} if panel.is_in_right_half(x) else {}
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

    def _axis(self, panel: Panel) -> tuple[Any, ...]:
        """Return the ends of the x axis, its crosshair and its two cursors."""
        from bokeh.models import CrosshairTool, Span

        key = panel.x, panel.xlim, tuple(panel.xticks)
        if key not in self.axes:
            upright = Span(dimension="height", line_color="#555555")
            look: dict[str, Any] = {"dimension": "height", "line_dash": "dashed", "visible": False}
            cursors = (Span(**look, tags=["cursor"]) for _ in range(2))
            self.axes[key] = _ends(panel.xlim), CrosshairTool(overlay=upright), *cursors
        return self.axes[key]

    def _columns(self, line: Line, values: Sequence[Array]) -> tuple[Any, list[str]]:
        """Put ``values``, (n,) each, into the data source of a line; return it and their names."""
        from bokeh.models import ColumnDataSource

        points = envelope(line.line_values, 25_000)  # up to 100,000 samples are drawn as they are
        is_complete = points.size == len(line.x)  # else another line has other points of this x
        key = id(line.x) if is_complete else id(line)
        if key not in self.sources:
            self.sources[key] = ColumnDataSource({"x": np.asarray(line.x, float)[points]})
        source, names = self.sources[key], []
        for column in values:
            names.append(f"y{len(source.data)}")
            source.data[names[-1]] = _rounded(column[points])
        return source, names

    def _line(self, fig: Any, line: Line) -> tuple[Any, list[str]]:
        """Draw a line, its band and the values behind a mean, as one entry of the legend.

        Return the glyph of the line, or of its points, and a list of its name and the names of
        its columns: values, lower bounds, upper bounds.
        """
        band = [np.asarray(end, float) for end in line.band or ()]
        raw = [np.asarray(line.y, float)] if line.mean else []
        source, columns = self._columns(line, [line.line_values, *band, *raw])
        look, name = _look_in_bokeh(line.look), _plain(line.label)
        common: dict[str, Any] = {"source": source}
        if name:
            common["legend_label"] = name
        if band:
            fill = {"fill_color": pale(look["color"]), "level": "underlay"}
            fig.varea("x", *columns[1:3], **fill, **common)
        if raw:
            fig.line("x", columns.pop(), color=look["color"], line_alpha=RAW, **common)
        glyph = None
        common["name"] = name  # live.js tells the values of glyphs with a name
        if line.look.get("linestyle", "-"):
            glyph = fig.line("x", columns[0], **look, **common)
        if "marker" in line.look:
            marker: dict[str, Any] = {"marker": _MARKERS[line.look["marker"]]}
            marker["size"] = _PIXEL * line.look.get("ms", 6.0)
            marker["fill_color"] = line.look.get("mfc", line.look["color"])
            glyph = fig.scatter("x", columns[0], **look, **common, **marker)
        return glyph, [name, *columns]


def _hover(panel: Panel, lines: Sequence[tuple[Any, list[str]]]) -> Any:
    """Return the tool that tells values at the pointer; None for a panel without a named line.

    ``lines`` are the results of `_Drawing._line`. The tool tells the lines that share the data
    source of most lines, and so one x. live.js writes the text from the ``tags``, one for x and one
    for each line: a name, and the names of its columns.
    """
    from bokeh.models import HoverTool

    named = [
        (glyph, [name or _plain(panel.y), *columns])
        for glyph, (name, *columns) in lines
        if glyph and (name or len(lines) == 1)
    ]
    if not named:
        return None
    commonest, _ = Counter(id(glyph.data_source) for glyph, _ in named).most_common(1)[0]
    hovered = [(glyph, tag) for glyph, tag in named if id(glyph.data_source) == commonest]
    tags = [[_plain(panel.x), "x"], *(tag for _, tag in hovered)]
    look = {"mode": "vline", "point_policy": "follow_mouse"}
    return HoverTool(renderers=[hovered[0][0]], tags=tags, **look)


def _image(fig: Any, panel: Panel, field: Field) -> None:
    """Draw a field with its scale, the slices of its slider, and a tool that tells its values."""
    from bokeh.models import ColumnDataSource, HoverTool, LinearColorMapper
    from matplotlib import colormaps
    from matplotlib.colors import to_hex

    (left, right, bottom, top), (cmap, low, high) = field.ends, field.scale
    colours = [to_hex(colour) for colour in colormaps[cmap](np.linspace(0.0, 1.0, 64))]
    mapper = LinearColorMapper(colours, low=low, high=high, nan_color="#ffffff")
    place = {"x": left, "y": bottom, "dw": right - left, "dh": top - bottom, "level": "image"}
    source = ColumnDataSource({"image": [_rounded(field.values)]})
    if field.slider:
        # value = first + step * byte; a byte has more steps than there are colours
        first, last = np.nanmin(field.slices), np.nanmax(field.slices)
        step = (last - first) / 255.0
        source.tags = [*field.slider, float(first), float(step)]
        for i, values in enumerate(field.slices):
            source.data[f"slice{i}"] = [np.nan_to_num((values - first) / step).astype("u1")]
    image = fig.image("image", source=source, color_mapper=mapper, **place)
    fig.add_layout(image.construct_color_bar(width=12), "right")
    tags = [_plain(panel.x), _plain(panel.y), *field.torques]
    fig.add_tools(HoverTool(renderers=[image], tags=tags))


def _rounded(values: Array) -> Array:
    """Return values (n,) rounded to 1 part in 4,000, so that they can be packed well."""
    bits = values.astype(np.float32).view(np.uint32)  # the last 12 bits of each become 0
    return ((bits + 0x800) & np.uint32(0xFFFFF000)).view(np.float32)


def _mark(fig: Any, mark: Mark) -> None:
    common = {"level": "image"}
    if mark.label:
        common["legend_label"] = _plain(mark.label)
    if mark.start == mark.end:
        fig.vspan([mark.start], **_look_in_bokeh(mark.look), **common)
    else:
        colour = mark.look["color"]
        fig.vstrip([mark.start], [mark.end], fill_color=colour, line_color=None, **common)


def _look_in_bokeh(stroke: Stroke) -> dict[str, Any]:
    points = stroke.get("linewidth", LINE_WIDTH)
    look = {"color": stroke["color"], "line_width": _PIXEL * points}
    style = stroke.get("linestyle", "-")
    if isinstance(style, tuple):
        dashes = (max(1, round(_PIXEL * points * length)) for length in style[1])
        look["line_dash"] = " ".join(map(str, dashes))
    return look


def _ends(ends: tuple[float, float] | None) -> Any:
    """Return the range of an axis; for None, the range of all that is drawn."""
    from bokeh.models import DataRange1d, Range1d

    return DataRange1d() if ends is None else Range1d(*map(float, ends))


def _plain(text: str) -> str:
    r"""Return a text in which MathJax sees no formula: a word joiner goes after each $ and \."""
    return re.sub(r"([$\\])", "\\1\u2060", text)
