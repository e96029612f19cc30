"""Empirical terms: their drivers against values worked out by hand, and disc temperatures."""

import numpy as np
import pytest

from calib.car.effects.combined import total_axle_moment, total_body_force
from calib.car.effects.effects import Effects, EmpiricalTerm
from calib.car.effects.empirical import drivers_of
from calib.car.history import Motion
from tests.support.effect_runs import SEDAN, made_history

HEATED = made_history(3, temperature_f=np.full(3, 100.0), temperature_r=np.full(3, 400.0))


def over_temperature(place):
    """The friction falls by a thousandth for each degree."""
    return Effects(terms=(EmpiricalTerm(place, "temperature", (0.0, 500.0), (0.0, -0.5)),))


@pytest.mark.parametrize(
    ("driver", "expected"),
    [
        ("pressure", [0.0, 2e5, 3e5, 3e5, 1e5]),
        ("speed", [20.0, 19.0, 18.0, 17.0, 16.0]),
        ("deceleration", [0.0, 0.1, 0.2, 0.2, 0.1]),
        ("constant", [0.0, 0.0, 0.0, 0.0, 0.0]),
        ("elapsed", [0.0, 0.1, 0.2, 0.3, 0.4]),
        ("time", [0.0, 0.1, 0.2, 0.3, 0.0]),  # the pads are free below 1.5 bar
    ],
)
def test_drivers(driver, expected):
    history = made_history(
        5,
        time=3.0 + 0.1 * np.arange(5),
        v=20.0 - np.arange(5.0),
        z=np.array([0.0, 0.1, 0.2, 0.2, 0.1]),
        p_mc=np.array([0.0, 2e5, 3e5, 3e5, 1e5]),
    )
    assert drivers_of("front_brakes", driver, history)[0] == pytest.approx(expected)
    (values,) = drivers_of("brakes", driver, history)
    assert values == pytest.approx(expected)


def test_a_term_is_linear_between_knots_and_constant_beyond():
    term = EmpiricalTerm("body", "speed", (10.0, 20.0), (0.1, 0.3))
    history = made_history(4, v=np.array([5.0, 10.0, 15.0, 40.0]))
    force = total_body_force(
        SEDAN, Effects(terms=(term,)), Motion(history.v, history.v, history.v, history)
    )
    assert force / SEDAN.weight == pytest.approx([0.1, 0.1, 0.2, 0.3])


def test_wheels_read_the_discs_of_their_own_axle_and_the_body_those_in_front():
    motion = Motion(HEATED.v, np.full(3, 1e4), np.full(3, 7e3), HEATED)
    moments = {
        place: total_axle_moment(SEDAN, over_temperature(place), motion)
        for place in ("front_wheels", "rear_wheels")
    }
    front, rear = SEDAN.front.rolling_radius, SEDAN.rear.rolling_radius
    assert moments["front_wheels"][0] == pytest.approx(np.full(3, -0.1 * SEDAN.weight * front))
    assert moments["rear_wheels"][1] == pytest.approx(np.full(3, -0.4 * SEDAN.weight * rear))
    assert not np.any(moments["front_wheels"][1])
    assert not np.any(moments["rear_wheels"][0])
    body = total_body_force(SEDAN, over_temperature("body"), motion)
    assert body == pytest.approx(np.full(3, -0.1 * SEDAN.weight))
