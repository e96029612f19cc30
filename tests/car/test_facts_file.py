"""What follows from the reference car, against figures worked out by hand."""

import pytest

from calib.car.facts_file import what_follows
from tests.support.tables import VEHICLE


def test_the_facts_of_the_reference_car():
    facts = what_follows(VEHICLE)
    assert facts.front.torque_per_bar_wheel == pytest.approx(2 * 0.38 * 28.84e-4 * 0.1309 * 1e5)
    assert facts.rear.torque_per_bar_axle == pytest.approx(4 * 0.38 * 11.34e-4 * 0.124 * 1e5)
    assert facts.front.static_load == pytest.approx(1744 * 1.6494 / 2.805)
    shifted = 1744 * 0.5 * 0.615 / 2.805
    assert facts.front.load_at_half_g == pytest.approx(facts.front.static_load + shifted)
    assert facts.rear.load_at_half_g == pytest.approx(facts.rear.static_load - shifted)
    assert facts.front_biased_up_to == pytest.approx(0.641, abs=5e-4)  # as the brief has it


def test_the_rows_are_consistent():
    facts = what_follows(VEHICLE)
    for row in facts.distribution:
        assert row.pressure == pytest.approx(row.deceleration * facts.pressure_per_g)
        force = (row.torque_f + row.torque_r) / 0.322
        assert force == pytest.approx(1744 * 9.80665 * row.deceleration)
    first = {lock.friction: lock for lock in facts.first_lock}
    assert (first[0.3].axle, first[0.8].axle) == ("front", "rear")
    assert all(lock.deceleration <= lock.friction for lock in facts.first_lock)
