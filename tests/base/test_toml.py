"""Text that is not TOML, and quantities that are wrong."""

import pytest

from calib.base.errors import InputError, VehicleError
from calib.base.toml import load_toml, quantity


@pytest.mark.parametrize("line", ["mass = 1600,5", "mass = 1600 kg", "a" + ".a" * 200 + " = 1"])
def test_text_that_is_not_toml_is_an_error(tmp_path, line):
    path = tmp_path / "car.toml"
    path.write_text(f"schema = 1\n[chassis]\n{line}\n")
    with pytest.raises(VehicleError, match="not TOML"):
        load_toml(path, VehicleError)


@pytest.mark.parametrize(
    "written", ["1600,5 kg", "1600", 1600, True, "1e999 kg", 10**400, "1 m", []]
)
def test_a_value_that_is_no_mass_is_an_error(written):
    with pytest.raises(InputError):
        quantity(written, "kg", "car.toml", InputError)
