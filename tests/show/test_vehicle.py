"""The brakes of a vehicle file."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.car.balance import front_biased_up_to
from calib.show.vehicle import (
    beta_point,
    facts,
    ideal,
    rear_per_front,
    sheet,
)
from tests.support.plot_lines import line
from tests.support.tables import VEHICLE


def test_the_lines_meet_where_the_bias_turns():
    brakes, used = sheet(VEHICLE).panels
    x, y = line(brakes, "front locks first up to 0.64 g")
    assert np.interp(x, *line(brakes, "I curve: equal friction")) == pytest.approx(y, rel=1e-3)
    front, rear, _ = used.lines
    cross = np.argmin(np.abs(front.y - rear.y)[20:]) + 20
    assert front.x[cross] == pytest.approx(0.641, abs=0.01)


def test_what_the_file_says_of_its_pads_is_shown_where_it_does():
    told = replace(VEHICLE, rear=replace(VEHICLE.rear, pad_friction_tolerance=0.03))
    rows, more = (facts(car).parts[0].tables[0].rows for car in (VEHICLE, told))
    assert [row[1:] for row in more[len(rows) :]] == [("", "3")]


WEIGHT, L, L_F, L_R, H, R = 1744.0 * 9.80665, 2.805, 1.1556, 1.6494, 0.615, 0.322


@given(st.floats(0.05, 2.0), st.floats(0.05, 0.9))
def test_a_point_of_the_beta_line_decelerates_as_said(ratio, z):
    front, rear = beta_point(VEHICLE, ratio, z)
    assert rear == pytest.approx(ratio * front)
    assert (front + rear) / R == pytest.approx(WEIGHT * z)  # (5)


def test_on_the_i_curve_both_axles_use_the_same_friction():
    front, rear = ideal(VEHICLE)
    z = (front + rear) / R / WEIGHT
    load_f = WEIGHT * (L_R + z * H) / L
    load_r = WEIGHT * (L_F - z * H) / L
    assert front[1:] / R / load_f[1:] == pytest.approx(rear[1:] / R / load_r[1:])
    assert z[0] == 0.0
    assert z[-1] == pytest.approx(1.0)


def test_the_beta_line_meets_the_i_curve_where_the_front_bias_ends():
    # 28.84 cm^2 * 130.9 mm in front, 11.34 cm^2 * 124 mm behind, one pad friction: Table I
    ratio = rear_per_front(VEHICLE, 0.38, 0.38)
    assert ratio == pytest.approx(11.34 * 124.0 / (28.84 * 130.9))
    at = beta_point(VEHICLE, ratio, front_biased_up_to(VEHICLE))
    front, rear = ideal(VEHICLE)
    assert np.interp(at[0], front, rear) == pytest.approx(at[1], rel=1e-3)
