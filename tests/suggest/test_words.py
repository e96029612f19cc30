"""Words of names: wheels, axles, quantities."""

import pytest

from calib.suggest.words import (
    BRAKE,
    LONG,
    MASTER,
    SPEED,
    STEERING,
    corner,
    loose_corner,
    score,
)


@pytest.mark.parametrize(
    ("wheel", "names"),
    [
        ("fl", ["omega_fl", "nRad_VL", "speed_lf", "front_l", "WhlSpdFrntLe"]),
        ("fr", ["WheelSpeedFR", "Rad_VoRe"]),
        ("rl", ["WhlSpd_RL_Meas", "wheel speed, left rear", "WhlSpdReLe", "Rad_HiLi"]),
        ("rr", ["Raddrehzahl hinten rechts", "Rear-Right Wheel", "ESP_HR_Radgeschw_02"]),
        (None, ["Front Axle Left Wheel", "velocity", "frontal area", "omega_rear", "l r"]),
    ],
)
def test_corner(wheel, names):
    """Parts of a corner that are not beside each other are not certain."""
    assert {name: corner(name) for name in names} == dict.fromkeys(names, wheel)


def test_the_four_of_a_group_have_one_stem():
    for four in (("omega_fl", "omega_rr"), ("nRadVL", "nRadHR"), ("left front V", "right rear V")):
        assert len({loose_corner(name)[1] for name in four}) == 1


@pytest.mark.parametrize(
    ("quantity", "names", "others"),
    [
        (SPEED, ["GW1_FzgGeschw", "vFzg", "VehSpdEsc", "CarSpeed"], ["v_Soll", "WhlSpd"]),
        (LONG, ["LongAcc", "ESP_Laengsbeschl", "VehALgt"], ["LatAcc", "ESP_Querbeschl"]),
        (BRAKE, ["ESP_Bremsdruck"], []),
        (MASTER, ["pTHZ", "pVordruck"], []),
        (STEERING, ["LWI_Lenkradwinkel", "StrgAg"], []),
    ],
)
def test_names_of_vehicle_buses(quantity, names, others):
    assert min(score(name, quantity) for name in names) > 0
    assert all(score(name, quantity) < 1 for name in others)


def test_of_two_speeds_the_likelier():
    """The car's before one of something, what was driven before what is shown or filtered."""
    for likely, less in (
        ("vehicle speed", "speed"),
        ("GW1_FzgGeschw", "KBI_angez_Geschw"),
        ("GPS_Speed", "GPS_Speed_filtered"),
    ):
        assert score(likely, SPEED) > score(less, SPEED)
    assert score("engine speed", SPEED) == -1
