"""The settings of a project: where they come from, and which command takes them."""

import shutil
from pathlib import Path

import pytest

from calib.base.names import SETTINGS_FILE as NAME
from calib.base.names import SETTINGS_VARIABLE as VARIABLE
from calib.store.store import Store
from tests.cli.conftest import parsed

SEDAN = Path(__file__).parents[2] / "sample_logs" / "sedan"
RAMP, COAST, STOP = (
    SEDAN / f"{name}.csv" for name in ("ramp_wet_asphalt", "coast", "dry_asphalt_stop")
)
TOLD = "settings of ../brake-cal.toml"


@pytest.fixture
def project(tmp_path, monkeypatch):
    """A project with a vehicle, with the working folder in `sub`; writes its settings."""
    shutil.copy(SEDAN / "vehicle.toml", tmp_path / "car.toml")
    (tmp_path / "sub").mkdir()
    monkeypatch.chdir(tmp_path / "sub")
    monkeypatch.delenv(VARIABLE, raising=False)

    def write(text):
        (tmp_path / NAME).write_text(f"schema = 1\n{text}")
        return tmp_path

    return write


def settings_of(ran):
    return parsed(ran)["settings"]


def test_each_setting_says_where_it_comes_from(project, brake_cal):
    project('vehicle = "car.toml"\nby = "Bea"\n[station]\nexport = ["dcm", "csv"]\n')
    ran = brake_cal("settings", "--json")
    settings = settings_of(ran)
    source = f"file:../{NAME}"
    assert settings["vehicle"] == {"value": "../car.toml", "source": source}
    assert settings["station.export"] == {"value": ["dcm", "csv"], "source": source}
    assert settings["by"] == {"value": "Bea", "source": source}
    assert settings["store"]["source"] == "built-in"


def test_fit_takes_vehicle_and_store(project, brake_cal, tmp_path):
    project('vehicle = "car.toml"\nstore = "shelf"\n')
    ran = brake_cal("fit", RAMP, COAST, "--json")
    assert ran.code == 0, ran.err
    assert ran.err.count(TOLD) == 1
    assert [entry.id for entry in Store(tmp_path / "shelf").entries()] == ["sedan-2up@1"]
    ran = brake_cal("tables", "list", "--json")
    assert [row["id"] for row in parsed(ran)["tables"]] == ["sedan-2up@1"]
    assert ran.err == f"{TOLD}\n"


def test_an_option_wins(project, brake_cal, tmp_path):
    project('vehicle = "none.toml"\nstore = "shelf"\n')
    options = ("--vehicle", tmp_path / "car.toml", "--store", tmp_path / "mine")
    ran = brake_cal("fit", RAMP, COAST, *options)
    assert ran.code == 0, ran.err
    assert "settings" not in ran.err  # none was used
    assert (tmp_path / "mine").is_dir()
    assert not (tmp_path / "shelf").exists()


def test_settings_may_be_on_another_drive(project, brake_cal, monkeypatch):
    def on_another_drive(path, start=None):
        raise ValueError("path is on mount 'C:', start on mount 'D:'")

    project('vehicle = "car.toml"\n')
    monkeypatch.setattr("os.path.relpath", on_another_drive)
    monkeypatch.setenv(VARIABLE, "../brake-cal.toml")
    assert brake_cal("simulate", RAMP, "--out", "sim.csv").code == 0


def test_simulate_takes_the_vehicle_and_no_map_without_a_log(project, brake_cal):
    project('vehicle = "car.toml"\nmap = "none.toml"\n')
    ran = brake_cal("simulate", "--manoeuvre", "stop", "--out", "sim.csv")
    assert ran.code == 0, ran.err
    ran = brake_cal("simulate", RAMP, "--out", "again.csv")
    assert ran.code == 3
    assert "none.toml" in ran.err


def test_validate_takes_the_limits_and_not_the_vehicle(project, brake_cal, tmp_path):
    project('vehicle = "car.toml"\nstore = "shelf"\n')
    assert brake_cal("fit", RAMP, COAST).code == 0
    project('vehicle = "none.toml"\nstore = "shelf"\nlimits = "line.toml"\n')
    (tmp_path / "line.toml").write_text("schema = 1\n[limits]\nvalid_share = { min = 1.1 }\n")
    ran = brake_cal("validate", "sedan-2up", STOP)
    assert ran.code == 1, ran.err
    assert "valid_share" in ran.out


def test_station_takes_its_section(project, brake_cal, tmp_path):
    project(
        'vehicle = "car.toml"\nstore = "shelf"\n'
        '[station]\nname = "line 2"\ngolden = "sedan-2up@1"\nexport = ["dcm"]\n'
    )
    assert brake_cal("fit", RAMP, COAST).code == 0
    stops = (STOP, SEDAN / "transition_dry_to_basalt.csv", "--coast", COAST)
    ran = brake_cal("station", RAMP, *stops, "--out", "car", "--json")
    assert ran.code == 0, ran.err
    document = parsed(ran)
    assert document["identity"]["station"] == "line 2"
    assert document["golden"]
    assert Path("car/table.dcm").is_file()
