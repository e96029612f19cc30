"""The brakes of a vehicle file."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.car.forces import front_biased_up_to
from calib.show.vehicle import (
    DECELERATIONS,
    beta_point,
    distribution,
    ideal,
    rear_per_front,
    sheet,
)
from tests.support.plot_lines import axes, labels, line
from tests.support.tables import VEHICLE, made_table


def test_the_lines_meet_where_the_bias_turns():
    drawn = sheet(VEHICLE).overview()
    brakes, used = drawn.axes
    by_label = {line.get_label(): line for line in brakes.lines}
    at = by_label["front locks first up to 0.64 g"].get_xydata()[0]
    ideal = by_label["I curve: both axles use the same friction"].get_xydata()
    assert np.interp(at[0], *ideal.T) == pytest.approx(at[1], rel=1e-3)
    front, rear, _ = used.lines
    cross = np.argmin(np.abs(front.get_ydata() - rear.get_ydata())[20:]) + 20
    assert front.get_xdata()[cross] == pytest.approx(0.641, abs=0.01)


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


def test_the_figure_shows_the_lines_and_p():
    ax = axes()
    distribution(ax, made_table())
    assert {
        "I curve: both axles use the same friction",
        r"$\beta$, pads as identified",
        r"$\beta$, nominal pads",
    } < {*labels(ax)}
    front, rear = line(ax, r"$\beta$, pads as identified")
    # made_table: pads 0.4 and 0.39
    slope = 0.39 * 11.34 * 124.0 / (0.40 * 28.84 * 130.9)
    assert rear[1] / front[1] == pytest.approx(slope)
    written = [text.get_text() for text in ax.texts]
    assert len(written) == len(DECELERATIONS) == 8
    assert "P, 0.3 g" in written


def test_a_car_that_is_front_biased_throughout_has_no_end_of_it():
    from dataclasses import replace

    front = replace(VEHICLE.front, piston_area=60e-4)
    table = replace(made_table(), vehicle=replace(VEHICLE, front=front))
    ax = axes()
    distribution(ax, table)
    assert not any("front locks" in label for label in labels(ax))


def test_the_end_of_the_table_is_marked_on_the_identified_line():
    ax = axes()
    distribution(ax, made_table())
    end = made_table().paper.z[-2]  # the last row is extrapolated
    front, rear = line(ax, f"usable up to {end:.2f} g")
    assert (front[0] + rear[0]) * 1e3 / R == pytest.approx(WEIGHT * 0.285)  # (5)
    assert "deceleration [g]" in labels(ax)
