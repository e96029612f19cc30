"""The file that is written: every key, read back as the reference car."""

from pathlib import Path

from calib.base.units import si_of, to_si
from calib.car.keys import KEYS, REFERENCE, vehicle_text
from calib.car.vehicle import Vehicle
from calib.car.vehicle_file import read_vehicle

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
    assert text.count("# pad_friction_tolerance = ") == 2
    assert read(text, tmp_path).mass_tolerance == Vehicle.mass_tolerance
