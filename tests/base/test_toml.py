"""Numbers as people write them, and what a message makes of them."""

import pytest

from calib.base.errors import InputError, VehicleError
from calib.base.toml import load_toml, quantity


@pytest.mark.parametrize(
    ("line", "what", "right"),
    [
        ("mass = 1600,5", "a decimal comma", "mass = 1600.5"),
        ("  pad_friction = 0,38  # new", "a decimal comma", "pad_friction = 0.38"),
        ("mass = 1.744,5", "a decimal comma", "mass = 1744.5"),
        ("mass = 1600 kg", "without quotes", 'mass = "1600 kg"'),
        ("area = 28,84cm^2  # new", "without quotes", 'area = "28.84 cm^2"'),
    ],
)
def test_a_number_as_people_write_it_is_named_with_its_line(tmp_path, line, what, right):
    path = tmp_path / "car.toml"
    path.write_text(f"schema = 1\n[chassis]\n{line}\n")
    with pytest.raises(VehicleError, match=f"{what} in line 3") as error:
        load_toml(path, VehicleError)
    assert repr(right) in str(error.value)


def test_another_mistake_is_no_comma(tmp_path):
    path = tmp_path / "car.toml"
    path.write_text("list = [1,5]\nmass = 1600 5\n")
    with pytest.raises(VehicleError) as error:
        load_toml(path, VehicleError)
    assert "comma" not in str(error.value)


def test_a_decimal_comma_in_a_quantity():
    with pytest.raises(InputError, match=r"'1600,5 kg' has a decimal comma; .*'1600\.5 kg'"):
        quantity("1600,5 kg", "kg", "car.toml", InputError)


def test_a_comma_that_may_part_thousands_has_two_readings():
    with pytest.raises(InputError, match=r"'1\.744 kg', or no mark between thousands: '1744 kg'"):
        quantity("1,744 kg", "kg", "car.toml", InputError)


def test_a_deceleration_without_a_unit_may_be_in_g():
    with pytest.raises(InputError, match=r'"0\.4 m/s\^2" or "0\.4 g"'):
        quantity(0.4, "m/s^2", "car.toml", InputError)
