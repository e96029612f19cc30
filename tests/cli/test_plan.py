"""`brake-cal plan` as the shell runs it, on two measures, and `fit --plan` after it."""

import json

import pytest

from calib.plan import search
from calib.plan.measure import measures
from tests.cli.conftest import parsed
from tests.support.documents import missing_and_unknown
from tests.support.reference_car import SEDAN

VEHICLE = SEDAN / "vehicle.toml"
FEW = tuple(m for m in measures() if m.name in ("ramp_60_3", "weighing"))


@pytest.fixture
def quick(monkeypatch):
    monkeypatch.setattr(search, "measures", lambda: FEW)
    monkeypatch.setattr(search, "_CARS", 1)
    return ("plan", "--vehicle", VEHICLE, "--track", "speed 120 km/h", "--workers", 1)


def test_a_plan_is_written_and_a_fit_is_compared_with_it(brake_cal, quick, store, tmp_path):
    ran = brake_cal(*quick, "--sensors", "v", "--out", tmp_path / "drive", "--json")
    assert ran.code == 0
    document = parsed(ran)
    assert missing_and_unknown("plan-json", document) == []
    assert json.loads((tmp_path / "drive" / "plan.json").read_text())["after"] == document["after"]
    assert (tmp_path / "drive" / document["steps"][0]["file"]).is_file()
    assert document["steps"][1]["half_width"]["total"] < document["steps"][0]["half_width"]["total"]
    ramp = SEDAN / "ramp_wet_asphalt.csv"
    plan = ("--plan", tmp_path / "drive" / "plan.json")
    ran = brake_cal("fit", ramp, "--vehicle", VEHICLE, "--store", store, *plan, "--json")
    compared = parsed(ran)["plan"]
    assert not compared["reached"]
    assert len(compared["reasons"]) == 1  # nobody weighed it
    assert compared["planned"] == document["after"]


def test_what_cannot_be_had_ends_with_1(brake_cal, quick):
    ran = brake_cal(*quick, "--want", "total 0.1 %", "--time", "8 s", "--json")
    assert (ran.code, parsed(ran)["met"]) == (1, False)


@pytest.mark.parametrize(
    "typed",
    [
        ("--want", "fron 2 %"),
        ("--want", "front 2 kg"),
        ("--want", "front 0 %"),
        ("--sensors", "p_xx"),
        ("--track", "length"),
        ("--time", "fast"),
    ],
)
def test_a_typing_mistake_is_usage(brake_cal, quick, typed):
    assert brake_cal(*quick, *typed).code == 2


@pytest.mark.parametrize("typed", [("--track", "length 50 m"), ("--time", "2 s")])
def test_no_track_or_time_for_a_ramp_is_bad_input(brake_cal, quick, typed):
    assert brake_cal(*quick, *typed).code == 3


def test_a_file_that_is_no_plan_is_bad_input(brake_cal, store):
    arguments = ("fit", SEDAN / "ramp_wet_asphalt.csv", "--vehicle", VEHICLE, "--store", store)
    assert brake_cal(*arguments, "--plan", VEHICLE).code == 3
