"""The vehicle file: values in SI, exact reading back, and mistakes that are refused."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.base.errors import VehicleError
from calib.base.names import names_a_table
from calib.car.characteristics import characteristics
from calib.car.effects.effects import Effects
from calib.car.forces import axle_loads
from calib.car.keys import KEYS, vehicle_text
from calib.car.mass import mass_used, with_mass
from calib.car.vehicle import Axle, Vehicle, require_same_car
from calib.car.vehicle_file import read_vehicle
from tests.support.reference_car import CAR
from tests.support.refusals import refusal
from tests.support.tables import VEHICLE
from tests.support.vehicle_files import write_vehicle

CHASSIS, AXLE = ({k.name: k for k in KEYS if k.section == part} for part in ("chassis", "front"))
SEDAN = Path(__file__).parents[2] / "sample_logs/sedan/vehicle.toml"
TEXT = SEDAN.read_text()


def write(tmp_path, *changes):
    text = TEXT
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    path = tmp_path / "car.toml"
    path.write_text(text)
    return path


def refused(path):
    return refusal(read_vehicle, path, kind=VehicleError, names=path)


def test_reads_tables_i_and_ii():
    car = read_vehicle(SEDAN)
    assert car.name == "sedan-2up"
    assert car.mass == 1744
    assert car.wheelbase == pytest.approx(2.805)
    assert car.front == Axle(0.322, 1.20, 28.84e-4, pytest.approx(0.1309), 2, 0.38)
    assert car.rear.piston_area == pytest.approx(11.34e-4)
    assert isinstance(car.front.friction_faces, int)
    assert car.mass_tolerance == 0.03  # the load that nobody wrote down
    assert (car.front.pad_friction_tolerance, car.rear.pad_friction_tolerance) == (None, None)
    assert car.effects == Effects()


def test_known_effects_and_tolerance_come_in_si(tmp_path):
    path = write(
        tmp_path,
        ("[front]", 'mass_tolerance = "1.5 %"\nmotor_odds = 0\n\n[front]'),
        ("[rear]", 'pad_friction_tolerance = "3 %"\n\n[rear]'),
    )
    text = path.read_text() + (
        '\n[effects.aerodynamic_drag]\ndrag_area = "6600 cm^2"\n'
        "[effects.rolling_resistance]\ncoefficient = 0.012\n"
    )
    path.write_text(text)
    car = read_vehicle(path)
    assert car.mass_tolerance == pytest.approx(0.015)
    assert car.motor_odds == 0.0
    assert car.front.pad_friction_tolerance == pytest.approx(0.03)
    assert car.rear.pad_friction_tolerance is None
    assert car.effects == Effects(
        {
            "aerodynamic_drag": {"drag_area": pytest.approx(0.66)},
            "rolling_resistance": {"coefficient": 0.012},
        }
    )


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('mass = "1744 kg"', 'mass = "-1744 kg"', ("chassis.mass", "-1744", "300 to 60000 kg")),
        ('"0.615 m"', '"2.9 m"', ("cg_height", "wheelbase")),
        ("pad_friction = 0.38", "pad_friction = 3.8", ("front.pad_friction", "0.05 to 1")),
        ("[rear]", "pad_friction_tolerance = 3\n[rear]", ("front.pad_friction_tolerance", "0.3")),
        ("friction_faces = 2", "friction_faces = 2.5", ("front", "friction_faces: 2.5", "whole")),
        ('"130.9 mm"', '"330.9 mm"', ("front", "fits into the wheel")),
        ('name = "sedan-2up"', 'name = "a/b"', ("'a/b'", "name")),
        ("[chassis]", "[effects]\ndrag = 1\n[chassis]", ("drag", "[effects.drag]")),
    ],
)
def test_mistakes_are_named(tmp_path, old, new, words):
    message = refused(write(tmp_path, (old, new)))
    assert [word for word in words if word not in message] == []


in_bounds = {name: st.floats(key.least, key.most) for name, key in {**CHASSIS, **AXLE}.items()}


@st.composite
def vehicles(draw):
    """Any believable vehicle."""

    def axle():
        values = {key: draw(in_bounds[key]) for key in AXLE}
        values["effective_radius"] = draw(st.floats(0.03, 0.0999))
        values["friction_faces"] = draw(st.integers(1, 12))
        return Axle(**values)

    chassis = {key: draw(in_bounds[key]) for key in CHASSIS}
    chassis["cg_height"] = draw(st.floats(0.1, 0.399))
    name = draw(st.text("abcXYZ019_-.", min_size=1).filter(names_a_table))
    number = st.floats(-1e6, 1e6)
    parameters = st.dictionaries(st.text("ab c.\"'", min_size=1), number, max_size=2)
    effects = draw(st.dictionaries(st.sampled_from(["road_grade", "odd one"]), parameters))
    return Vehicle(name=name, front=axle(), rear=axle(), effects=Effects(effects), **chassis)


@given(car=vehicles())
def test_written_and_read_back_is_the_same(tmp_path_factory, car):
    path = tmp_path_factory.getbasetemp() / "round.toml"
    write_vehicle(car, path)
    assert read_vehicle(path) == car


def changed(name):
    """The reference car with one of its numbers doubled."""
    side, _, key = name.rpartition(".")
    owner = getattr(CAR, side) if side else CAR
    other = replace(owner, **{key: 2.0 * (getattr(owner, key) or 0.02)})
    return replace(CAR, **{side: other}) if side else other


CHASSIS_NUMBERS = [k for k, x in vars(CAR).items() if isinstance(x, float)]
NUMBERS = {*CHASSIS_NUMBERS, *(f"{s}.{k}" for s in ("front", "rear") for k in vars(CAR.front))}
UNCERTAIN = {"mass_tolerance", "motor_odds"} | {
    f"{side}.pad_friction{suffix}" for side in ("front", "rear") for suffix in ("", "_tolerance")
}


@pytest.mark.parametrize("name", sorted(NUMBERS))
def test_a_car_is_another_by_its_geometry_alone(name):
    """Not by its pads, nor by what is uncertain of it; a weighed one may have another mass."""
    require_same_car(CAR, replace(CAR, name="other", effects=Effects()))
    if name in UNCERTAIN:
        require_same_car(CAR, changed(name))
        return
    with pytest.raises(VehicleError, match=name) as error:
        require_same_car(CAR, changed(name), "V.toml")
    assert str(error.value).startswith("V.toml: ")
    if name == "mass":
        require_same_car(CAR, changed(name), weighed=True)


def test_the_example_is_the_reference_car(tmp_path):
    path = tmp_path / "vehicle.toml"
    path.write_text(vehicle_text())
    assert read_vehicle(path) == read_vehicle(SEDAN)


def test_characteristics_of_the_reference_car():
    values = characteristics(VEHICLE)
    front, rear = values["front"], values["rear"]
    assert front["torque_per_bar_wheel"] == pytest.approx(2 * 0.38 * 28.84e-4 * 0.1309 * 1e5)
    assert rear["torque_per_bar_axle"] == pytest.approx(4 * 0.38 * 11.34e-4 * 0.124 * 1e5)
    assert front["static_load"] == pytest.approx(1744 * 1.6494 / 2.805)
    shifted = 1744 * 0.5 * 0.615 / 2.805
    assert front["load_at_half_g"] == pytest.approx(front["static_load"] + shifted)
    assert rear["load_at_half_g"] == pytest.approx(rear["static_load"] - shifted)
    assert values["front_biased_up_to"] == pytest.approx(0.641, abs=5e-4)  # as the brief has it


UNKNOWN = replace(CAR, mass_tolerance=0.03)


def test_loads_grow_with_the_mass_and_the_centre_of_gravity_stays():
    heavy = with_mass(CAR, 2000.0)
    z = np.array([0.0, 0.4])
    for now, then in zip(axle_loads(heavy, z), axle_loads(CAR, z), strict=True):
        assert now == pytest.approx(then * 2000.0 / 1744.0)
    assert replace(heavy, mass=CAR.mass) == CAR


def test_what_was_weighed_is_known_to_half_a_percent_or_as_the_file_says():
    assert with_mass(UNKNOWN, 2000.0).mass_tolerance == 0.005
    assert with_mass(replace(CAR, mass_tolerance=0.002), 2000.0).mass_tolerance == 0.002


def test_a_stated_mass_drops_the_known_mass_error():
    effects = Effects({"mass_error": {"mass_error": 0.1}, "road_grade": {"grade": 0.01}})
    assert with_mass(replace(CAR, effects=effects), 2000.0).effects.names == ("road_grade",)


@pytest.mark.parametrize("factor", [0.45359237, 1.0 / 0.45359237, 0.1])
def test_pounds_written_as_kilograms_are_no_load_of_this_car(factor):
    with pytest.raises(VehicleError, match=r"times the 1744 kg of the vehicle file"):
        with_mass(CAR, factor * CAR.mass)
    with pytest.raises(VehicleError, match="check number and unit"):
        mass_used(CAR, factor * CAR.mass)
