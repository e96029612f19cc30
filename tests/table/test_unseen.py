"""What no log of a car shows, against closed forms and a root of the equation of eta."""

from dataclasses import replace

import pytest
from scipy.optimize import brentq

from calib.car.balance import front_share
from calib.car.forces import axle_loads
from calib.table.unseen import unseen_entries
from tests.support.tables import VEHICLE, made_table

TABLE = made_table()
Z = 0.2  # half of the ramp that the table is taken to have


def entries(**how):
    return {one.entry: one for one in unseen_entries(TABLE, **how)}


@pytest.mark.parametrize(
    ("how", "shown"),
    [
        ({"v": True}, {"a_x", "rolling_radius"}),
        ({"v": False, "mass": 0.004}, set()),
    ],
)
def test_what_a_speed_shows_is_not_on_the_list(how, shown):
    everything = entries(v=False)
    assert {*everything} - {*entries(**how)} == shown
    assert all(0.0 < one.up_to <= 0.5 and one.shown_by for one in everything.values())


def test_the_largest_doubt_comes_first():
    order = [one.entry for one in unseen_entries(TABLE, v=True, mass=0.1)]
    assert order[0] == "mass"
    assert order.index("front.pad_friction") < order.index("p_mc")  # one without a doubt


def test_an_area_moves_the_pads_of_its_own_axle_alone():
    front, rear = (entries(v=True)[f"{axle}.piston_area"] for axle in ("front", "rear"))
    assert (front.front, front.rear) == pytest.approx((-1.0, 0.0))
    assert (rear.front, rear.rear) == pytest.approx((0.0, -1.0))


@pytest.mark.parametrize("entry", ["cg_height", "cg_to_front_axle"])
def test_loads_move_the_ratio_as_the_same_eta_demands(entry):
    share = front_share(VEHICLE, 0.0)

    def unlike(share, car):
        front, rear = axle_loads(car, Z)
        return share / front - (1.0 - share) / rear

    by = 1e-4
    longer = {"cg_to_rear_axle": VEHICLE.cg_to_rear_axle - by * VEHICLE.cg_to_front_axle}
    other = replace(
        VEHICLE,
        **{entry: (1.0 + by) * getattr(VEHICLE, entry)},
        **(longer if entry == "cg_to_front_axle" else {}),
    )
    moved = brentq(lambda x: unlike(x, other) - unlike(share, VEHICLE), 0.1, 0.99, xtol=1e-14)
    ratio = (moved - share) / (share * (1.0 - share)) / by
    of = entries(v=True)[entry]
    assert of.front - of.rear == pytest.approx(ratio, rel=1e-2)


@pytest.mark.parametrize("weight", [0.0, 0.3])
def test_pads_of_the_file_move_the_ratio_by_the_weight_that_they_have(weight):
    table = replace(TABLE, quality={"pad_ratio_nominal_weight": weight})
    found = {one.entry: one for one in unseen_entries(table, v=True)}
    front, rear = (found[f"{axle}.pad_friction"] for axle in ("front", "rear"))
    assert front.front - front.rear == pytest.approx(weight)
    assert rear.front - rear.rear == pytest.approx(-weight)
    assert front.up_to == found["front.piston_area"].up_to
