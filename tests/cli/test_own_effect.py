"""`--effect`: what the page `own_effects` of the manual says, done as it is printed there."""

import json
import re
import shlex
from pathlib import Path

import pytest

from calib.help.samples import sample_logs
from tests.cli.conftest import parsed
from tests.support.own_effects import EXAMPLE

MANUAL = Path(__file__).parents[2] / "calib" / "manual"
PAGE = (MANUAL / "own_effects.md").read_text()
SEDAN = Path("sample_logs/sedan")
VEHICLE = ("--vehicle", SEDAN / "vehicle.toml")
FLAP = Path("sample_logs/own_effect/air_brake_flap.py")
WITH_FLAP = Path("sample_logs/own_effect/with_flap.toml")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A working folder with the sample logs."""
    (tmp_path / "sample_logs").symlink_to(sample_logs())
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_page_prints_the_file_of_the_sample():
    (printed,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    docstring, code = EXAMPLE.read_text().split('"""\n\n', 1)
    assert docstring.startswith('"""')
    assert printed == code


@pytest.mark.slow
def test_the_commands_of_the_page_work_as_printed_and_find_the_effect(brake_cal, folder):
    commands = [line for line in PAGE.splitlines() if line.startswith("brake-cal ")]
    assert [shlex.split(c)[1] for c in commands] == ["effects", *["simulate"] * 4, "diagnose"]
    for command in commands:
        ran = brake_cal(*shlex.split(command)[1:])
        assert ran.code == 0, ran.err
    assert "Missing from the model: air brake flap" in ran.out
    (effect,) = json.loads(Path("found/diagnosis.json").read_text())["effects"]
    low, high = effect["parameters"]["flap_area"]["ci95"]
    assert low < 0.8 < high
    model = ("--model", "found/model.toml")
    again = ("simulate", "step.csv", *VEHICLE, *model, "--out", "again.csv")
    ran = brake_cal(*again)
    assert ran.code == 3
    assert "--effect air_brake_flap.py" in ran.err
    assert not Path("again.csv").exists()
    assert brake_cal(*again, "--effect", FLAP).code == 0


def test_a_table_with_an_own_effect_needs_its_file_to_compute(brake_cal, folder):
    flap = ("--effect", FLAP)
    logs = [SEDAN / "ramp_wet_asphalt.csv", SEDAN / "coast.csv"]
    ran = brake_cal("fit", *logs, *VEHICLE, "--model", WITH_FLAP, *flap, "--store", "t", "--json")
    assert ran.code == 0
    fitted = parsed(ran)
    record = json.loads((Path(fitted["path"]) / "record.json").read_text())["record"]
    assert record["own_effects"]["air_brake_flap"]["file"] == FLAP.name
    stop = ("validate", "sedan-2up", SEDAN / "dry_asphalt_stop.csv", "--store", "t")
    ran = brake_cal(*stop)
    assert ran.code == 3
    assert FLAP.name in ran.err
    ran = brake_cal(*stop, *flap, "--json")
    assert ran.code in (0, 1)
    assert parsed(ran)["table"] == fitted["table"]
    assert brake_cal("tables", "verify", "--store", "t").code == 0
    assert brake_cal("tables", "show", "sedan-2up", "--store", "t").code == 0
