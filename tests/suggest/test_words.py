"""Words of names: wheels, axles, quantities."""

import pytest

from calib.suggest.words import (
    BRAKE,
    LONG,
    MASTER,
    SPEED,
    STEERING,
    axle,
    corner,
    loose_corner,
    score,
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
        ("WhlSpdFrntLe", "fl"),  # AUTOSAR
        ("WhlSpdReRi", "rr"),
        ("WhlSpdReLe", "rl"),
        ("Rad_VoRe", "fr"),
        ("Rad_HiLi", "rl"),
        ("ESP_HR_Radgeschw_02", "rr"),
    ],
)
def test_corner(name, wheel):
    assert corner(name) == wheel


def test_the_four_of_a_group_have_one_stem():
    for four in (("omega_fl", "omega_rr"), ("nRadVL", "nRadHR"), ("left front V", "right rear V")):
        assert len({loose_corner(name)[1] for name in four}) == 1


@pytest.mark.parametrize(
    ("name", "found"), [("T_disc_f", "f"), ("disc rear", "r"), ("disc_fl", None), ("disc", None)]
)
def test_axle(name, found):
    assert axle(name) == found


def test_scores():
    assert score("LongAcc", LONG) > 0 > score("LatAcc", LONG)
    assert score("vehicle speed", SPEED) > score("speed", SPEED)
    assert score("engine speed", SPEED) == -1


@pytest.mark.parametrize(
    ("name", "quantity"),
    [
        ("GW1_FzgGeschw", SPEED),
        ("v_Fzg", SPEED),
        ("vFzg", SPEED),
        ("Fahrzeuggeschw", SPEED),
        ("VehSpdEsc", SPEED),
        ("CarSpeed", SPEED),
        ("ESP_Laengsbeschl", LONG),
        ("VehALgt", LONG),
        ("ESP_Bremsdruck", BRAKE),
        ("pTHZ", MASTER),
        ("pVordruck", MASTER),
        ("LWI_Lenkradwinkel", STEERING),
        ("StrgAg", STEERING),
    ],
)
def test_names_of_vehicle_buses(name, quantity):
    assert score(name, quantity) > 0


@pytest.mark.parametrize(
    ("name", "quantity"),
    [
        ("Sollgeschw", SPEED),
        ("v_Soll", SPEED),
        ("WhlSpd", SPEED),
        ("ESP_Querbeschl", LONG),
    ],
)
def test_names_of_other_signals(name, quantity):
    assert score(name, quantity) < 1


def test_the_speed_that_is_displayed_is_less_likely():
    shown, driven = "KBI_angez_Geschw", "GW1_FzgGeschw"
    assert score(shown, SPEED) < score(driven, SPEED)


def test_scores_of_computed_channels():
    assert score("GPS_Speed_filtered", SPEED) < score("GPS_Speed", SPEED)
