"""The map of a table over eta - 1 and z: the ratio of the pads, and how well the ratio is known.

z |  ...##%%   colours  front over rear pad friction, over that ratio on the ramp, or its half width
  | ..##%%     line     eta - 1 and z of the ramp
  |.##%%       points   eta - 1 and z of stops, as means over 0.3 s
  +-------- eta - 1
"""

from collections.abc import Mapping, Sequence
from itertools import cycle
from types import MappingProxyType

import numpy as np

from calib.car.balance import front_share
from calib.show.panel import Field, Line, Panel
from calib.show.style import BODY, ETA, WHEEL_STROKES, Array, dots
from calib.table.maps import Reader
from calib.table.table import Table

_SMALLEST_SHARE = 0.02
"""Share of the stops at a z below which a place of the map stays white [1]."""
_STEPS = 56
"""Places of the drawn map along each axis."""
_AROUND = 1.5
"""Ends of the axes over the largest eta - 1 and z of the ramp and of the stops."""
_POINTS, _SLICES = 400, 4
"""About the number of drawn points of a stop; number of maps for a browser, over slip."""
_SLIP = "slip, in standard deviations of stops"
"""Name of the third axis of the map."""


def map_panels(
    table: Table, stops: Mapping[str, tuple[Array, Array]] = MappingProxyType({})
) -> tuple[Panel, Panel]:
    """Return two panels: the ratio of the pads at the usual slip, and the ratio's half width.

    ``stops`` are eta - 1 and z of stops, (n,) each, by the names of the stops.
    """
    axes, (low, high) = _axes(table, [*stops.values()]), table.map.axes["slip"][[0, -1]]
    slider = _SLIP, float(low), float(high)
    # the first map is at the usual slip, the others are the slices for a browser
    maps = [_read(table, axes, slip) for slip in (0.0, *np.linspace(low, high, _SLICES))]
    ratio, *ratios = (np.exp(change) for change, _, _ in maps)
    half, *halves = (50.0 * (np.exp(upper) - np.exp(lower)) for _, lower, upper in maps)
    thick = {**BODY, "linewidth": 1.8}
    lines = [Line(100.0 * (table.paper.eta - 1.0), table.paper.z, thick, "the ramp")]
    for (name, samples), look in zip(stops.items(), cycle(WHEEL_STROKES.values())):
        x, z = (values[:: 1 + values.size // _POINTS] for values in samples)
        lines.append(Line(100.0 * x, z, dots(look, 2.0, rasterized=True), name))
    x, z = 100.0 * axes[0].ravel(), axes[1].ravel()
    place = x[0], x[-1], z[0], z[-1]

    def panel(name: str, title: str, field: Field) -> Panel:
        return Panel(name, title, ETA, "deceleration over g [1]", lines, xlim=place[:2],
                     ylim=place[2:], columns=2, field=field)  # fmt: skip

    of_ratio = Field(ratio, place, 1.0, ratios, slider, _torques(table))
    of_half = Field(half, place, None, halves, slider)
    return (
        panel("map", "Map: front over rear pads, over the ramp's [1]", of_ratio),
        panel("map-band", "Half width of its 95 % interval [%]", of_half),
    )


def _axes(table: Table, stops: Sequence[tuple[Array, Array]]) -> tuple[Array, Array]:
    """Return eta - 1 (1, k) and z (k, 1) of the places, around the ramp and the ``stops``."""
    drawn = [(table.paper.eta - 1.0, table.paper.z), *stops]
    eta_less_1, z = (np.concatenate(values) for values in zip(*drawn, strict=True))
    left, right = 1.1 * min(np.nanmin(eta_less_1), 0.0), _AROUND * np.nanmax(eta_less_1)
    top = min(_AROUND * np.nanmax(z), table.map.axes["z"][-1])
    return np.linspace(left, right, _STEPS)[None], np.linspace(0.0, top, _STEPS)[:, None]


def _read(table: Table, axes: tuple[Array, Array], slip: float) -> list[Array]:
    """Return ln of the ratio over the ramp's, and its bounds, (k, k) each; NaN off all stops."""
    eta_less_1, z = axes
    shift = eta_less_1 / np.maximum(z, table.map.axes["z"][0])  # an axis of the map
    read = Reader(table.map, ("change", "change_lower", "change_upper", "share"))
    *changes, share = read(z, shift, slip)
    return [np.where(share > _SMALLEST_SHARE, change, np.nan) for change in changes]


def _torques(table: Table) -> tuple[float, float, float]:
    """Return the ``torques`` of the `Field` of the ratio."""
    car, level = table.vehicle, float(np.exp(np.mean(table.level_map.level)))
    share = float(front_share(car, table.calibration.pad_log_ratio.value))
    front, rear = (level * car.weight * axle.rolling_radius for axle in (car.front, car.rear))
    return front, rear, share / (1.0 - share)
