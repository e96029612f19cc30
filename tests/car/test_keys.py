"""The file that is written: every key, read back as the reference car."""

from pathlib import Path

import pytest

from calib.base.errors import VehicleError
from calib.base.units import si_of, to_si
from calib.car.keys import KEYS, REFERENCE, default_of, vehicle_text
from calib.car.vehicle import Vehicle
from calib.car.vehicle_file import answered, read_vehicle

SEDAN = Path(__file__).parents[2] / "sample_logs/sedan/vehicle.toml"
BY_PATH = {key.path: key for key in KEYS}


def read(text: str, folder: Path) -> Vehicle:
    file = folder / "vehicle.toml"
    file.write_text(text)
    return read_vehicle(file)


def test_the_examples_are_the_reference_car(tmp_path):
    assert read(vehicle_text(REFERENCE), tmp_path) == read_vehicle(SEDAN)


def test_usual_ranges_are_inside_the_bounds():
    for key in KEYS[1:]:
        low, high = (to_si(end, key.unit, si_of(key.unit)) for end in (key.low, key.high))
        assert key.least <= low < high <= key.most


def test_an_optional_key_without_a_value_is_a_comment(tmp_path):
    values = {k: v for k, v in REFERENCE.items() if k != "chassis.mass_tolerance"}
    text = vehicle_text(values)
    assert "# mass_tolerance = 0.03" in text
    assert read(text, tmp_path).mass_tolerance == Vehicle.mass_tolerance


@pytest.mark.parametrize(
    ("path", "typed", "value"),
    [
        ("chassis.mass", " 1800 ", "1800 kg"),
        ("chassis.mass", "1.8 t", "1.8 t"),
        ("front.piston_area", "28.8", "28.8 cm^2"),
        ("front.friction_faces", "2", "2"),
        ("name", "my car", "my car"),
    ],
)
def test_a_number_has_the_unit_of_the_question(path, typed, value):
    assert answered(BY_PATH[path], typed) == value


@pytest.mark.parametrize(
    ("path", "typed", "says"),
    [
        ("chassis.mass", "heavy", "usual: 700 to 4500 kg"),
        ("chassis.mass", "1800 g", "known: kg, t, lb"),
        ("chassis.mass", "1,8 t", "is not a quantity"),
        ("chassis.mass", "12", "expected 300 to 60000 kg"),
        ("front.friction_faces", "1.5", "a whole number"),
        ("name", "a/b", "letters, digits"),
    ],
)
def test_nonsense_is_refused_with_what_was_expected(path, typed, says):
    with pytest.raises(VehicleError, match=says.replace("(", r"\(")):
        answered(BY_PATH[path], typed)


def test_enter_takes_the_wheel_of_the_front_axle_for_the_rear():
    before = {"front.rolling_radius": "0.35 m"}
    assert default_of(BY_PATH["rear.rolling_radius"], before) == "0.35 m"
    assert default_of(BY_PATH["rear.piston_area"], before) == "11.34 cm^2"
