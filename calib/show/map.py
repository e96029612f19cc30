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


def map_panels(
    table: Table, stops: Mapping[str, tuple[Array, Array]] = MappingProxyType({})
) -> tuple[Panel, Panel]:
    """Return two panels: the ratio of the pads, and the half width of its 95 % interval.

    ``stops`` are eta - 1 and z of stops, (n,) each, by the names of the stops.
    """
    axes = _axes(table, [*stops.values()])
    low, high = table.map.axes["slip"][[0, -1]]
    slider = "slip, in standard deviations of stops", float(low), float(high)
    ratios, halves = [], []  # first at the usual slip, then four slices for a browser
    for slip in (0.0, *np.linspace(low, high, 4)):
        change, lower, upper = _read(table, axes, slip)
        ratios.append(np.exp(change))
        halves.append(50.0 * (np.exp(upper) - np.exp(lower)))  # [%]
    thick = {**BODY, "linewidth": 1.8}
    lines = [Line(100.0 * (table.paper.eta - 1.0), table.paper.z, thick, "the ramp")]
    for (name, samples), look in zip(stops.items(), cycle(WHEEL_STROKES.values())):
        eta_less_1, z = (values[:: 1 + values.size // 400] for values in samples)  # some 400 points
        lines.append(Line(100.0 * eta_less_1, z, dots(look, 2.0, rasterized=True), name))
    x, y = 100.0 * axes[0].ravel(), axes[1].ravel()
    ends = x[0], x[-1], y[0], y[-1]

    def panel(name: str, title: str, field: Field) -> Panel:
        return Panel(name, title, ETA, "deceleration over g [1]", lines, xlim=ends[:2],
                     ylim=ends[2:], columns=2, field=field)  # fmt: skip

    torques = _torques(table)
    ratio = Field(ratios[0], ends, middle=1.0, slices=ratios[1:], slider=slider, torques=torques)
    half_width = Field(halves[0], ends, slices=halves[1:], slider=slider)
    return (
        panel("map", "Map: front over rear pads, over the ramp's [1]", ratio),
        panel("map-band", "Half width of its 95 % interval [%]", half_width),
    )


def _axes(table: Table, stops: Sequence[tuple[Array, Array]]) -> tuple[Array, Array]:
    """Return eta - 1 (1, 56) and z (56, 1) of the places, around the ramp and the ``stops``."""
    drawn = [(table.paper.eta - 1.0, table.paper.z), *stops]
    eta_less_1, z = (np.concatenate(values) for values in zip(*drawn, strict=True))
    left, right = 1.1 * min(np.nanmin(eta_less_1), 0.0), 1.5 * np.nanmax(eta_less_1)
    top = min(1.5 * np.nanmax(z), table.map.axes["z"][-1])
    return np.linspace(left, right, 56)[None], np.linspace(0.0, top, 56)[:, None]


def _read(table: Table, axes: tuple[Array, Array], slip: float) -> list[Array]:
    """Return ln of the drawn ratio and of its bounds, (56, 56) each.

    They are NaN, and so white, where at most 2 % of the stops at the same z are.
    """
    eta_less_1, z = axes
    shift = eta_less_1 / np.maximum(z, table.map.axes["z"][0])  # (eta - 1)/z, an axis of the map
    read = Reader(table.map, ("change", "change_lower", "change_upper", "share"))
    *changes, share = read(z, shift, slip)
    return [np.where(share > 0.02, change, np.nan) for change in changes]


def _torques(table: Table) -> tuple[float, float, float]:
    """Return `Field.torques` at the mean pad level of the table."""
    car, level = table.vehicle, float(np.exp(np.mean(table.level_map.level)))
    share = float(front_share(car, table.calibration.pad_log_ratio.value))  # of the brake force
    front, rear = (level * car.weight * axle.rolling_radius for axle in (car.front, car.rear))
    return front, rear, share / (1.0 - share)
