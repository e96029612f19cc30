"""Entries whose errors no log shows, against closed forms and a root of the equation of eta."""

from dataclasses import replace

import pytest
from scipy.optimize import brentq

from calib.car.balance import front_share
from calib.car.forces import axle_loads
from calib.table.unseen import unseen_entries
from tests.support.tables import VEHICLE, made_table

TABLE = made_table()
Z = 0.2  # half of the deceleration that the ramp of the table is assumed to reach


def entries(**options):
    return {entry.entry: entry for entry in unseen_entries(TABLE, **options)}


@pytest.mark.parametrize(
    ("options", "shown"),
    [({"v": True}, {"a_x", "rolling_radius"}), ({"v": False, "mass": 0.004}, set())],
)
def test_entries_that_a_speed_shows_are_not_listed(options, shown):
    without_v = entries(v=False)
    assert {*without_v} - {*entries(**options)} == shown
    assert all(0.0 < entry.up_to <= 0.5 and entry.shown_by for entry in without_v.values())


def test_the_largest_doubt_comes_first():
    order = [entry.entry for entry in unseen_entries(TABLE, v=True, mass=0.1)]
    assert order[0] == "mass"
    assert order.index("front.pad_friction") < order.index("p_mc")  # which has no doubt


def test_an_area_moves_the_pads_of_its_own_axle_alone():
    front, rear = (entries(v=True)[f"{axle}.piston_area"] for axle in ("front", "rear"))
    assert (front.front, front.rear) == pytest.approx((-1.0, 0.0))
    assert (rear.front, rear.rear) == pytest.approx((0.0, -1.0))


@pytest.mark.parametrize("entry", ["cg_height", "cg_to_front_axle"])
def test_loads_move_the_ratio_as_the_same_eta_demands(entry):
    share = front_share(VEHICLE, 0.0)

    def difference(share, car):  # what eta fixes, by (22)
        front, rear = axle_loads(car, Z)
        return share / front - (1.0 - share) / rear

    step = 1e-4
    changed = {entry: (1.0 + step) * getattr(VEHICLE, entry)}
    if entry == "cg_to_front_axle":  # the wheelbase stays
        changed["cg_to_rear_axle"] = VEHICLE.cg_to_rear_axle - step * VEHICLE.cg_to_front_axle
    other = replace(VEHICLE, **changed)
    of_eta = difference(share, VEHICLE)
    moved = brentq(lambda x: difference(x, other) - of_eta, 0.1, 0.99, xtol=1e-14)
    ratio = (moved - share) / (share * (1.0 - share)) / step
    moved_entry = entries(v=True)[entry]
    assert moved_entry.front - moved_entry.rear == pytest.approx(ratio, rel=1e-2)


@pytest.mark.parametrize("weight", [0.0, 0.3])
def test_pads_of_the_file_move_the_ratio_by_the_weight_that_they_have(weight):
    table = replace(TABLE, quality={"pad_ratio_nominal_weight": weight})
    by_entry = {entry.entry: entry for entry in unseen_entries(table, v=True)}
    front, rear = (by_entry[f"{axle}.pad_friction"] for axle in ("front", "rear"))
    assert front.front - front.rear == pytest.approx(weight)
    assert rear.front - rear.rear == pytest.approx(-weight)
    assert front.up_to == by_entry["front.piston_area"].up_to
