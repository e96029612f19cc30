"""`brake-cal vehicle` as the shell runs it."""

from pathlib import Path

import pytest
from jsonschema import Draft202012Validator

from calib.car.vehicle_file import read_vehicle
from tests.cli.conftest import parsed

SEDAN = Path(__file__).parents[2] / "sample_logs/sedan/vehicle.toml"


@pytest.fixture
def car(tmp_path):
    """A copy of the reference file with texts replaced."""

    def write(**changes):
        file, text = tmp_path / "car.toml", SEDAN.read_text()
        for old, new in changes.values():
            assert old in text
            text = text.replace(old, new, 1)
        file.write_text(text)
        return file

    return write


def test_the_reference_car_is_written_and_never_replaced_silently(brake_cal, tmp_path):
    file = tmp_path / "cars" / "new.toml"
    assert brake_cal("vehicle", "init", file).code == 0
    assert brake_cal("vehicle", "init", file).code == 0  # nothing is lost
    assert read_vehicle(file) == read_vehicle(SEDAN)
    file.write_text("mine")
    ran = brake_cal("vehicle", "init", file)
    assert (ran.code, file.read_text()) == (2, "mine")
    assert brake_cal("vehicle", "init", file, "--force", "--json").code == 0
    assert read_vehicle(file) == read_vehicle(SEDAN)


def test_an_implausible_file_ends_with_1_and_names_the_causes(brake_cal, car):
    file = car(f=("friction_faces = 2", "friction_faces = 1"))
    ran = brake_cal("vehicle", "check", file)
    assert ran.code == 1
    ran = brake_cal("vehicle", "check", file, SEDAN, file.with_name("no.toml"), "--json")
    document = parsed(ran)
    assert ran.code == 3
    assert [v["plausible"] for v in document["vehicles"]] == [False, True]
    assert len(document["unreadable"]) == 1
    assert document["vehicles"][0]["warnings"][0]["log"] == "sedan-2up"


def test_show_prints_a_document_of_its_schema_and_draws(brake_cal, tmp_path):
    document = parsed(brake_cal("vehicle", "show", SEDAN, "--json"))
    schema = parsed(brake_cal("schema", "vehicle-facts"))
    Draft202012Validator(schema).validate(document)
    assert document["facts"]["pressure_per_g"] == pytest.approx(69.93, abs=0.01)
    picture = tmp_path / "brakes.png"
    assert brake_cal("vehicle", "show", SEDAN, "--plot", picture).code == 0
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert brake_cal("vehicle", "show", SEDAN, "--plot", "x.jpg").code == 2
    picture.write_text("mine")
    assert brake_cal("vehicle", "show", SEDAN, "--plot", picture).code == 2
    assert picture.read_text() == "mine"
