"""Facts and Fig. 2 of the brakes of a vehicle file."""

from dataclasses import replace

import numpy as np
import pytest

from calib.car.balance import front_biased_up_to
from calib.show.vehicle import vehicle_facts, vehicle_sheet
from tests.support.plot_lines import line
from tests.support.tables import VEHICLE

WEIGHT, L, L_F, L_R, H, R = 1744.0 * 9.80665, 2.805, 1.1556, 1.6494, 0.615, 0.322
IDEAL, INSTALLED = "I curve: equal friction", "installed, nominal pads"


@pytest.fixture(scope="module")
def panel():
    return vehicle_sheet(VEHICLE).panels[0]


def test_on_the_i_curve_both_axles_use_the_same_friction(panel):
    front, rear = (1e3 * torque for torque in line(panel, IDEAL))
    z = (front + rear) / R / WEIGHT
    load_f, load_r = WEIGHT * (L_R + z * H) / L, WEIGHT * (L_F - z * H) / L
    assert front[1:] / R / load_f[1:] == pytest.approx(rear[1:] / R / load_r[1:])
    assert (z[0], z[-1]) == pytest.approx((0.0, 1.0))


def test_points_of_the_beta_line_have_their_deceleration_and_meet_the_i_curve(panel):
    # 28.84 cm^2 * 130.9 mm in front, 11.34 cm^2 * 124 mm behind, one pad friction: Table I
    ratio = 11.34 * 124.0 / (28.84 * 130.9)
    (_, end), (_, top) = line(panel, INSTALLED)
    assert top == pytest.approx(ratio * end)
    for text, front, rear in panel.texts:
        assert rear == pytest.approx(ratio * front)
        assert 1e3 * (front + rear) / R == pytest.approx(WEIGHT * float(text.split()[0]))  # (5)
    x, y = line(panel, "front locks first up to 0.64 g")
    assert 1e3 * (x + y) / R == pytest.approx(WEIGHT * front_biased_up_to(VEHICLE))
    assert np.interp(x, *line(panel, IDEAL)) == pytest.approx(y, rel=1e-3)


def test_a_pad_tolerance_of_the_file_is_shown():
    known_pads = replace(VEHICLE, rear=replace(VEHICLE.rear, pad_friction_tolerance=0.03))
    rows, more = (vehicle_facts(car).parts[0].tables[0].rows for car in (VEHICLE, known_pads))
    assert [row[1:] for row in more[len(rows) :]] == [("", "3")]
