"""Entries of a vehicle file whose errors the logs cannot show, and measurements that would.

A wrong entry makes level or ratio of the fitted pads wrong (`calib.table.budget`). A warning comes
only beyond the usual scatter of pads, so smaller errors go unseen.
"""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from calib.base.intervals import Z95
from calib.base.warning import RULES, bounds_of
from calib.car.balance import front_share
from calib.car.beliefs import CAR, LOG
from calib.car.forces import axle_loads
from calib.table.budget import grade_sigma
from calib.table.table import Table

_BY_WHEELS = {"a_x": 0.08, "rolling_radius": 0.08}
"""Largest relative error for which the rule `a_x_by_wheels` gives no warning [1]."""
_LARGEST = 0.5  # largest relative error of other entries that is considered [1]
_RADIUS_SIGMA = 0.01  # relative standard deviation of a file's radii, by wear and inflation [1]
_SHOWN_BY = {
    "mass": "weigh the car with driver and load (--mass)",
    "p_mc": "a gauge at a caliper, or wheel pressures",
    "a_x": "log v, or turn the sensor over on level ground",
    "rolling_radius": "log v, or measure how far the car rolls in ten turns",
    "cg_height": "lift an axle on a scale, or the data sheet",
    "cg_to_front_axle": "axle loads on a scale",
}
_BRAKES_SHOWN_BY = "a roller brake tester (--bench), or the drawing of the brake"


class Unseen(NamedTuple):
    """An ``entry`` of the vehicle file, or a channel, whose error may go unseen; figures in [1]."""

    entry: str
    doubt: float | None  # relative sigma of the entry in the table's intervals; None: not counted
    front: float  # relative change of the front pad friction per relative error of the entry
    rear: float  # relative change of the rear pad friction per relative error of the entry
    up_to: float  # largest relative error without a warning
    shown_by: str  # measurement that would show the error


def unseen_entries(table: Table, v: bool, mass: float | None = None) -> list[Unseen]:
    """Return entries whose errors the logs do not show, those that change the pads most first.

    ``v`` says whether the logs have a reference speed. ``mass`` is the relative standard deviation
    of the car's mass [1], by default that of the table's vehicle.
    """
    mass_sigma = table.vehicle.mass_tolerance if mass is None else mass
    entries = [_unseen(table, *entry) for entry in _entries(table, v, mass_sigma)]
    up_to = {entry.entry: entry.up_to for entry in entries}
    # wrong pads of the file give a warning at the same error as a wrong piston area
    weight, sigma = _nominal_weight(table), grade_sigma(table.vehicle)
    for axle, ratio_change in (("front", weight), ("rear", -weight)):
        pads = _unseen(table, f"{axle}.pad_friction", sigma, 0.0, ratio_change)
        entries.append(pads._replace(up_to=up_to[f"{axle}.piston_area"]))

    def order(entry: Unseen) -> tuple[float, float]:
        change = (entry.doubt or 0.0) * math.hypot(entry.front, entry.rear)
        return -change, entry.up_to

    return sorted(entries, key=order)


def unseen_line(entries: list[Unseen]) -> str:
    """Return text on the entries that change all pads alike, each with its largest error."""
    alike = [x for x in entries if x.front == x.rear]
    errors = ", ".join(f"{x.entry} ±{100.0 * x.up_to:.0f} %" for x in alike)
    return f"{errors}, and {len(entries) - len(alike)} entries of an axle or its load"


def _entries(
    table: Table, v: bool, mass: float
) -> Iterator[tuple[str, float | None, float, float]]:
    """Yield name, doubt, change of ln of the pads' level and change of ln of their ratio.

    The changes are per relative error of the entry. The fitted ratio is a mean of the ratio by eta,
    which changes, and that of the vehicle file, which stays.
    """
    share, by_eta = _front_share(table), 1.0 - _nominal_weight(table)
    yield "mass", mass, 1.0, 0.0
    yield "p_mc", None, -1.0, 0.0
    if not v:
        yield "a_x", LOG.a_x_scale.sigma, 1.0, 0.0
        yield "rolling_radius", _RADIUS_SIGMA, 1.0, 0.0
    for name in ("piston_area", "effective_radius"):
        yield f"front.{name}", None, -share, -by_eta
        yield f"rear.{name}", None, share - 1.0, by_eta
    by_height, by_distance = _by_loads(table)
    yield "cg_height", CAR.cg_height.sigma, 0.0, by_eta * by_height
    yield "cg_to_front_axle", CAR.cg_to_front_axle.sigma, 0.0, by_eta * by_distance


def _nominal_weight(table: Table) -> float:
    """Weight of the file's pads in the fitted ratio of the pads [1]."""
    return table.quality.get("pad_ratio_nominal_weight", 0.0)


def _front_share(table: Table) -> float:
    """Share of the front axle in the brake force [1] with the fitted pads."""
    return front_share(table.vehicle, table.calibration.pad_log_ratio.value)


def _by_loads(table: Table) -> tuple[float, float]:
    """Change of ln of the pads' ratio per relative change of cg_height and cg_to_front_axle [1].

    With equal tyres, eta fixes share/F_zf - (1 - share)/F_zr, by (22), where the share is that of
    the front axle in the brake force. A wrong load makes the share wrong. z is half of the ramp's.
    """
    car, share = table.vehicle, _front_share(table)
    z = 0.5 * table.quality.get("deceleration_max", 0.4)
    front, rear = (float(load) / car.weight for load in axle_loads(car, np.asarray(z)))
    # change of the share, then of ln(share/(1 - share)), per load over W that moves to the front
    share_by_load = (share / front**2 + (1.0 - share) / rear**2) / (1.0 / front + 1.0 / rear)
    ratio_by_load = share_by_load / (share * (1.0 - share))
    load_by_height = z * car.cg_height / car.wheelbase
    load_by_distance = -car.cg_to_front_axle / car.wheelbase
    return ratio_by_load * load_by_height, ratio_by_load * load_by_distance


def _unseen(table: Table, entry: str, doubt: float | None, level: float, ratio: float) -> Unseen:
    """Return an entry that changes ln of the pads' ``level`` and ``ratio`` per relative error."""
    share, pads = _front_share(table), table.calibration
    sigmas = next(rule.sigmas for rule in RULES if rule.code == "pads_off_file")
    scale_sigma = pads.pad_scale.sigma / pads.pad_scale.value
    level_limit = sigmas * math.hypot(grade_sigma(table.vehicle), scale_sigma)
    ratio_limit = max(bounds_of("pad_ratio")[1], Z95 * pads.pad_log_ratio.sigma)
    up_to = min(level_limit / max(abs(level), 1e-6), ratio_limit / max(abs(ratio), 1e-6))
    up_to = min(up_to, _BY_WHEELS.get(entry, _LARGEST))
    front, rear = level + (1.0 - share) * ratio, level - share * ratio
    return Unseen(entry, doubt, front, rear, up_to, _SHOWN_BY.get(entry, _BRAKES_SHOWN_BY))
