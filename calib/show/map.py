"""The map of a table over eta - 1 and z: the ratio of the pads, and how well the ratio is known.

z |  ...##%%   colours  ratio of front to rear pad friction, over the ratio on the ramp; in the
  | ..##%%              second panel the half width of its 95 % interval
  |.##%%       line     eta - 1 and z of the ramp
  +-------- eta - 1     points: eta - 1 and z of stops, as means over 0.3 s

The map has a third axis, slip; still pictures show it at the usual slip, 0.
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
"""A place of the map that a smaller share of the stops at its z meets stays white [1]."""
_STEPS = 56
"""Places of the drawn map along each axis."""
_AROUND = 1.5
"""Ends of the axes over the largest eta - 1 and z of the ramp and of the stops [1]."""
_POINTS, _SLICES = 400, 4
"""Approximate number of drawn points of a stop; number of slices over slip for a browser."""
_SLIP = "slip, in standard deviations of stops"


def map_panels(
    table: Table, stops: Mapping[str, tuple[Array, Array]] = MappingProxyType({})
) -> tuple[Panel, Panel]:
    """Return two panels: the ratio of the pads, and the half width of its 95 % interval.

    ``stops`` are eta - 1 and z of stops, (n,) each, by the names of the stops.
    """
    axes, (low, high) = _axes(table, [*stops.values()]), table.map.axes["slip"][[0, -1]]
    slider = _SLIP, float(low), float(high)
    ratios, halves = [], []  # first at the usual slip, then the slices for a browser
    for slip in (0.0, *np.linspace(low, high, _SLICES)):
        change, lower, upper = _read(table, axes, slip)
        ratios.append(np.exp(change))
        halves.append(50.0 * (np.exp(upper) - np.exp(lower)))  # [%]
    thick = {**BODY, "linewidth": 1.8}
    lines = [Line(100.0 * (table.paper.eta - 1.0), table.paper.z, thick, "the ramp")]
    for (name, samples), look in zip(stops.items(), cycle(WHEEL_STROKES.values())):
        eta_less_1, z = (values[:: 1 + values.size // _POINTS] for values in samples)
        lines.append(Line(100.0 * eta_less_1, z, dots(look, 2.0, rasterized=True), name))
    x, y = 100.0 * axes[0].ravel(), axes[1].ravel()
    ends = x[0], x[-1], y[0], y[-1]

    def panel(name: str, title: str, field: Field) -> Panel:
        return Panel(name, title, ETA, "deceleration over g [1]", lines, xlim=ends[:2],
                     ylim=ends[2:], columns=2, field=field)  # fmt: skip

    ratio = Field(ratios[0], ends, 1.0, ratios[1:], slider, _torques(table))
    half_width = Field(halves[0], ends, None, halves[1:], slider)
    return (
        panel("map", "Map: front over rear pads, over the ramp's [1]", ratio),
        panel("map-band", "Half width of its 95 % interval [%]", half_width),
    )


def _axes(table: Table, stops: Sequence[tuple[Array, Array]]) -> tuple[Array, Array]:
    """Return eta - 1 (1, k) and z (k, 1) of the places, around the ramp and the ``stops``."""
    drawn = [(table.paper.eta - 1.0, table.paper.z), *stops]
    eta_less_1, z = (np.concatenate(values) for values in zip(*drawn, strict=True))
    left, right = 1.1 * min(np.nanmin(eta_less_1), 0.0), _AROUND * np.nanmax(eta_less_1)
    top = min(_AROUND * np.nanmax(z), table.map.axes["z"][-1])
    return np.linspace(left, right, _STEPS)[None], np.linspace(0.0, top, _STEPS)[:, None]


def _read(table: Table, axes: tuple[Array, Array], slip: float) -> list[Array]:
    """Return ln of the drawn ratio and of its bounds, (k, k) each; NaN where hardly a stop is."""
    eta_less_1, z = axes
    shift = eta_less_1 / np.maximum(z, table.map.axes["z"][0])  # (eta - 1)/z, an axis of the map
    read = Reader(table.map, ("change", "change_lower", "change_upper", "share"))
    *changes, share = read(z, shift, slip)
    return [np.where(share > _SMALLEST_SHARE, change, np.nan) for change in changes]


def _torques(table: Table) -> tuple[float, float, float]:
    """Return `Field.torques` at the mean pad level of the table."""
    car, level = table.vehicle, float(np.exp(np.mean(table.level_map.level)))
    share = float(front_share(car, table.calibration.pad_log_ratio.value))  # on the ramp
    front, rear = (level * car.weight * axle.rolling_radius for axle in (car.front, car.rear))
    return front, rear, share / (1.0 - share)
