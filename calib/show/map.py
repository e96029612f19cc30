"""The map of a table over z and eta - 1: the ratio of its pads, and how well that is known.

z |  ...##%%   colour   ratio of front to rear pads over that of the ramp, or its 95 % half width
  | ..##%%     ridge    what the ramp itself had
  |.##%%       points   what stops had, as means over 0.3 s
  +-------- eta - 1
"""

from collections.abc import Mapping, Sequence
from itertools import cycle
from types import MappingProxyType

import numpy as np

from calib.show.panel import Field, Line, Panel
from calib.show.style import BODY, ETA, WHEEL_STROKES, Array, dots
from calib.table.maps import Reader
from calib.table.table import Table

_SEEN = 0.02
"""Least share of the stops at a z for which a place of the map is drawn [1]."""
_STEPS = 56
"""Colours along each axis."""
_AROUND = 1.5
"""Ends of the axes over the largest eta - 1 and z of the ramp and of the stops."""
_POINTS = 400
"""Points of a stop that are drawn, about."""


def map_panels(
    table: Table, stops: Mapping[str, tuple[Array, Array]] = MappingProxyType({})
) -> tuple[Panel, Panel]:
    """Ratio of the pads at the usual slip, and its half width; ``stops`` eta - 1 and z by name."""
    axes = _axes(table, [*stops.values()])
    change, lower, upper = _read(table, axes)
    half = 50.0 * (np.exp(upper) - np.exp(lower))
    thick = {**BODY, "linewidth": 1.8}
    lines = [Line(100.0 * (table.paper.eta - 1.0), table.paper.z, thick, "the ramp")]
    for (name, of_stop), look in zip(stops.items(), cycle(WHEEL_STROKES.values())):
        x, z = (column[:: 1 + column.size // _POINTS] for column in of_stop)
        lines.append(Line(100.0 * x, z, dots(look, 2.0, rasterized=True), name))
    return (
        _panel(
            "map",
            "Map: front over rear pads, over the ramp's [1]",
            axes,
            lines,
            np.exp(change),
            middle=1.0,
        ),
        _panel("map-band", "Half width of its 95 % interval [%]", axes, lines, half),
    )


def _axes(table: Table, others: Sequence[tuple[Array, Array]]) -> tuple[Array, Array]:
    """eta - 1 (1, k) and z (k, 1) around the ramp and the ``others``."""
    drawn = [(table.paper.eta - 1.0, table.paper.z), *others]
    shifts, z = (np.concatenate(one) for one in zip(*drawn, strict=True))
    top = min(_AROUND * np.nanmax(z), table.map.axes["z"][-1])
    eta_less_1 = np.linspace(1.1 * min(np.nanmin(shifts), 0.0), _AROUND * np.nanmax(shifts), _STEPS)
    return eta_less_1[None], np.linspace(0.0, top, _STEPS)[:, None]


def _read(table: Table, axes: tuple[Array, Array]) -> list[Array]:
    """ln of the ratio of the pads over that of the ramp, with its bounds; NaN where no stop is."""
    eta_less_1, z = axes
    shift = eta_less_1 / np.maximum(z, table.map.axes["z"][0])
    read = Reader(table.map, ("change", "change_lower", "change_upper", "share"))
    *values, share = read(z, shift, 0.0)
    return [np.where(share > _SEEN, one, np.nan) for one in values]


def _panel(
    name: str,
    title: str,
    axes: tuple[Array, Array],
    lines: Sequence[Line],
    values: Array,
    middle: float | None = None,
) -> Panel:
    x, z = 100.0 * axes[0].ravel(), axes[1].ravel()
    ends = (x[0], x[-1]), (z[0], z[-1])
    return Panel(name, title, ETA, "deceleration over g [1]", lines, xlim=ends[0], ylim=ends[1],
                 columns=2, field=Field(values, (*ends[0], *ends[1]), middle))  # fmt: skip
