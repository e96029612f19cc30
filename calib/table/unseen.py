"""Entries of a vehicle file that logs cannot show to be wrong, and what would show it.

A wrong entry moves level and ratio of the pads. Only an error that is too large for the pads of the
file's grade gives a warning.
"""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from calib.base.intervals import Z95
from calib.base.warning import RULES
from calib.car.balance import front_share
from calib.car.beliefs import CAR, LOG
from calib.car.forces import axle_loads
from calib.table.budget import grade
from calib.table.table import Table

_MOST = {"a_x": 0.08, "rolling_radius": 0.08}
"""Largest error that the wheels do not show [1], see `a_x_by_wheels`; of other entries a half."""
_RADIUS = 0.01  # standard deviation of the rolling radii of a file: wear and inflation [1]
_SHOWN_BY = {
    "mass": "weigh the car with driver and load (--mass)",
    "p_mc": "a gauge at a caliper, or wheel pressures",
    "a_x": "log v, or turn the sensor over on level ground",
    "rolling_radius": "log v, or measure how far the car rolls in ten turns",
    "cg_height": "lift an axle on a scale, or the data sheet",
    "cg_to_front_axle": "axle loads on a scale",
}
_BRAKE = "a roller brake tester (--bench), or the drawing of the brake"


class Unseen(NamedTuple):
    """An ``entry`` of the vehicle file, or a channel, whose error may go unseen.

    ``doubt`` its standard deviation in the intervals [1], None if they do not count it.
    ``front``, ``rear`` relative change of the pads per relative error of the entry [1]; ``up_to``
    largest error without a warning [1]; ``shown_by`` what would show it.
    """

    entry: str
    doubt: float | None
    front: float
    rear: float
    up_to: float
    shown_by: str


def unseen(table: Table, v: bool, mass: float | None = None) -> list[Unseen]:
    """Entries whose errors the logs of a table's car do not show, the largest doubt first.

    ``v`` whether the logs have a reference speed; ``mass`` relative standard deviation of that of
    the car [1].
    """
    mass_sigma = table.vehicle.mass_tolerance if mass is None else mass
    entries = [_unseen(table, *one) for one in _entries(table, v, mass_sigma)]
    entries += _pads_of_file(table)
    return sorted(entries, key=lambda x: (-(x.doubt or 0.0) * math.hypot(*x[2:4]), x.up_to))


def unseen_line(entries: list[Unseen]) -> str:
    """Entries that move all pads alike, each with the largest error without a warning."""
    alike = [x for x in entries if x.front == x.rear]
    errors = ", ".join(f"{x.entry} ±{100.0 * x.up_to:.0f} %" for x in alike)
    return f"{errors}, and {len(entries) - len(alike)} entries of an axle or its load"


def _entries(
    table: Table, v: bool, mass: float
) -> Iterator[tuple[str, float | None, float, float]]:
    """Entry, its doubt, and the change of ln of the pads' level and ratio per its relative error.

    A wrong entry moves only that part of the ratio that comes from eta, not from the file.
    """
    share, by_eta = _share(table), 1.0 - table.quality.get("pad_ratio_nominal_weight", 0.0)
    yield "mass", mass, 1.0, 0.0
    yield "p_mc", None, -1.0, 0.0
    if not v:
        yield "a_x", LOG.a_x_scale.sigma, 1.0, 0.0
        yield "rolling_radius", _RADIUS, 1.0, 0.0
    for name in ("piston_area", "effective_radius"):
        yield f"front.{name}", None, -share, -by_eta
        yield f"rear.{name}", None, share - 1.0, by_eta
    height, ahead = _by_loads(table)
    yield "cg_height", CAR.cg_height.sigma, 0.0, by_eta * height
    yield "cg_to_front_axle", CAR.cg_to_front_axle.sigma, 0.0, by_eta * ahead


def _pads_of_file(table: Table) -> Iterator[Unseen]:
    """The pad frictions of the file, which have a weight in the ratio of the pads."""
    share, weight = _share(table), table.quality.get("pad_ratio_nominal_weight", 0.0)
    for name, sign in (("front", 1.0), ("rear", -1.0)):
        area = _unseen(
            table, "", None, -share if sign > 0.0 else share - 1.0, sign * (weight - 1.0)
        )
        pads = _unseen(table, f"{name}.pad_friction", grade(table.vehicle), 0.0, sign * weight)
        yield pads._replace(up_to=area.up_to)


def _share(table: Table) -> float:
    return front_share(table.vehicle, table.calibration.pad_log_ratio.value)


def _by_loads(table: Table) -> tuple[float, float]:
    """Change of ln of the pads' ratio for one of cg_height and of cg_to_front_axle, relative [1].

    Eta holds share/F_zf - (1 - share)/F_zr, (22) for alike tyres, at half of the ramp.
    """
    car, share = table.vehicle, _share(table)
    z = 0.5 * table.quality.get("deceleration_max", 0.4)
    front, rear = (float(load) / car.weight for load in axle_loads(car, np.asarray(z)))
    by_load = (share / front**2 + (1.0 - share) / rear**2) / (1.0 / front + 1.0 / rear)
    by_share = by_load / (share * (1.0 - share))  # of a load that moves to the front axle [1]
    height = z * car.cg_height / car.wheelbase
    return by_share * height, -by_share * car.cg_to_front_axle / car.wheelbase


def _unseen(table: Table, entry: str, doubt: float | None, level: float, ratio: float) -> Unseen:
    share, cal = _share(table), table.calibration
    sigmas = cal.pad_scale.sigma / cal.pad_scale.value, cal.pad_log_ratio.sigma
    of_level, of_ratio = (
        next(rule for rule in RULES if rule.code == code) for code in ("pads_off_file", "pad_ratio")
    )
    limits = (
        of_level.sigmas * math.hypot(grade(table.vehicle), sigmas[0]),
        max(of_ratio.high, Z95 * sigmas[1]),
    )
    moves, most = (level, ratio), _MOST.get(entry, 0.5)
    up_to = min(most, *(x / max(abs(m), 1e-6) for x, m in zip(limits, moves, strict=True)))
    front, rear = level + (1.0 - share) * ratio, level - share * ratio
    return Unseen(entry, doubt, front, rear, up_to, _SHOWN_BY.get(entry, _BRAKE))
