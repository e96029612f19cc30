"""Words of names: wheels, axles, quantities."""

import pytest

from calib.suggest.words import (
    LONG,
    NO_LONG,
    NO_SPEED,
    SPEED,
    axle,
    corner,
    score,
    stem,
)


@pytest.mark.parametrize(
    ("name", "wheel"),
    [
        ("omega_fl", "fl"),
        ("WheelSpeedFR", "fr"),
        ("WhlSpd_RL_Meas", "rl"),
        ("nRad_VL", "fl"),
        ("Raddrehzahl hinten rechts", "rr"),
        ("wheel speed, left rear", "rl"),
        ("Rear-Right Wheel", "rr"),
        ("speed_lf", "fl"),
        ("front_l", "fl"),
        ("Front Axle Left Wheel", None),  # not beside each other: not certain
        ("velocity", None),
        ("p_mc", None),
        ("frontal area", None),
        ("omega_rear", None),
        ("l r", None),
    ],
)
def test_corner(name, wheel):
    assert corner(name) == wheel


def test_the_four_of_a_group_have_one_stem():
    for four in (("omega_fl", "omega_rr"), ("nRadVL", "nRadHR"), ("left front V", "right rear V")):
        assert len({stem(name) for name in four}) == 1


@pytest.mark.parametrize(
    ("name", "found"), [("T_disc_f", "f"), ("disc rear", "r"), ("disc_fl", None), ("disc", None)]
)
def test_axle(name, found):
    assert axle(name) == found


def test_scores():
    assert score("LongAcc", LONG, NO_LONG) > 0 > score("LatAcc", LONG, NO_LONG)
    assert score("vehicle speed", SPEED, NO_SPEED) > score("speed", SPEED, NO_SPEED)
    assert score("engine speed", SPEED, NO_SPEED) == -1
    assert score("GPS_Speed_filtered", SPEED, NO_SPEED) < score("GPS_Speed", SPEED, NO_SPEED)
