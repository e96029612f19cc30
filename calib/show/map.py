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

from calib.car.balance import front_share
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
_SLICES = 4
"""Slices through a map for a browser, from the lowest slip to the highest."""
_SLIP = "slip, in standard deviations of stops"


def map_panels(
    table: Table, stops: Mapping[str, tuple[Array, Array]] = MappingProxyType({})
) -> tuple[Panel, Panel]:
    """Ratio of the pads at the usual slip, and its half width; ``stops`` eta - 1 and z by name."""
    axes, (low, high) = _axes(table, [*stops.values()]), table.map.axes["slip"][[0, -1]]
    read = [_read(table, axes, slip) for slip in (0.0, *np.linspace(low, high, _SLICES))]
    slider = _SLIP, float(low), float(high)
    ratio, *ratios = (np.exp(change) for change, _, _ in read)
    half, *halves = (50.0 * (np.exp(upper) - np.exp(lower)) for _, lower, upper in read)
    thick = {**BODY, "linewidth": 1.8}
    lines = [Line(100.0 * (table.paper.eta - 1.0), table.paper.z, thick, "the ramp")]
    for (name, of_stop), look in zip(stops.items(), cycle(WHEEL_STROKES.values())):
        x, z = (column[:: 1 + column.size // _POINTS] for column in of_stop)
        lines.append(Line(100.0 * x, z, dots(look, 2.0, rasterized=True), name))
    x, z = 100.0 * axes[0].ravel(), axes[1].ravel()
    place = x[0], x[-1], z[0], z[-1]
    fields = {
        ("map", "Map: front over rear pads, over the ramp's [1]"): Field(
            ratio, place, 1.0, ratios, slider, _torques(table)
        ),
        ("map-band", "Half width of its 95 % interval [%]"): Field(
            half, place, None, halves, slider
        ),
    }
    first, second = (
        Panel(*names, ETA, "deceleration over g [1]", lines, xlim=place[:2], ylim=place[2:],
              columns=2, field=field)
        for names, field in fields.items()
    )  # fmt: skip
    return first, second


def _axes(table: Table, others: Sequence[tuple[Array, Array]]) -> tuple[Array, Array]:
    """eta - 1 (1, k) and z (k, 1) around the ramp and the ``others``."""
    drawn = [(table.paper.eta - 1.0, table.paper.z), *others]
    shifts, z = (np.concatenate(one) for one in zip(*drawn, strict=True))
    top = min(_AROUND * np.nanmax(z), table.map.axes["z"][-1])
    eta_less_1 = np.linspace(1.1 * min(np.nanmin(shifts), 0.0), _AROUND * np.nanmax(shifts), _STEPS)
    return eta_less_1[None], np.linspace(0.0, top, _STEPS)[:, None]


def _read(table: Table, axes: tuple[Array, Array], slip: float) -> list[Array]:
    """ln of the ratio of the pads over that of the ramp, with its bounds; NaN where no stop is."""
    eta_less_1, z = axes
    shift = eta_less_1 / np.maximum(z, table.map.axes["z"][0])
    read = Reader(table.map, ("change", "change_lower", "change_upper", "share"))
    *values, share = read(z, shift, slip)
    return [np.where(share > _SEEN, one, np.nan) for one in values]


def _torques(table: Table) -> tuple[float, float, float]:
    """Torques of an axle that brakes alone [N m] per z, and the odds of front over rear."""
    car, level = table.vehicle, float(np.exp(np.mean(table.level_map.level)))
    share = float(front_share(car, table.calibration.pad_log_ratio.value))
    front, rear = (level * car.weight * axle.rolling_radius for axle in (car.front, car.rear))
    return front, rear, share / (1.0 - share)
