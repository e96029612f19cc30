"""`brake-cal repeatability` as the shell runs it."""

import json

import pytest

from calib.logs.write import write_csv
from tests.cli.conftest import parsed
from tests.support.reference_car import REAL, SEDAN, noisy, ramp, with_pads

VEHICLE = SEDAN / "vehicle.toml"
PADS = {"a": 0.33, "b": 0.38, "c": 0.42}


@pytest.fixture(scope="module")
def ramps(tmp_path_factory):
    """Three cars, two stations that differ in nothing, two ramps each."""
    root = tmp_path_factory.mktemp("ramps")
    for i, (car, mu) in enumerate(PADS.items()):
        clean = ramp(with_pads(REAL, mu, mu))
        for j, station in enumerate(("north", "south")):
            folder = root / car / station
            folder.mkdir(parents=True)
            for k in range(2):
                write_csv(noisy(clean, 100 * i + 10 * j + k), folder / f"{k}.csv")
    return root


def plan_of(root, stations=True):
    """A plan of all ramps, with their stations or without."""
    rows = [
        f"{car}/{station}/{k}.csv,{car}" + f",{station}" * stations
        for car in PADS
        for station in ("north", "south")
        for k in (0, 1)
    ]
    path = root / ("plan.csv" if stations else "cars.csv")
    path.write_text("\n".join(["log,car" + ",station" * stations, *rows, ""]))
    return path


def test_a_study(brake_cal, ramps, tmp_path):
    out = tmp_path / "gauge"
    ran = brake_cal("repeatability", "--plan", plan_of(ramps), "--vehicle", VEHICLE, "--metric",
                    "pad_scale", "--out", out, "--json")  # fmt: skip
    assert ran.code == 0, ran.err
    told = parsed(ran)
    assert told == json.loads((out / "repeatability.json").read_text())
    assert (out / "repeatability.png").read_bytes().startswith(b"\x89PNG")
    found = told["quantities"]["pad_scale"]
    # the cars differ by 0.045 in friction, sd, which is 0.12 of the nominal 0.38
    assert found["components"]["car"]["sd"] == pytest.approx(0.119, rel=0.1)
    assert found["grr"]["value"] < 0.3
    assert [row["df"] for row in found["anova"]] == [2, 1, 2, 6]
    assert len(told["ramps"]) == 12
    assert list(told["ramps"][0]) == ["log", "car", "station", "figures", "digest"]


@pytest.mark.parametrize(
    ("more", "code"),
    [
        (("--metric", "pad_scael", "--plan", "plan.csv"), 2),
        (("--plan", "nowhere.csv"), 3),
        (("--plan", "plan.csv", "nowhere.csv"), 3),
        ((), 2),
        (("--folders", "car/station"), 2),
    ],
)
def test_mistakes(brake_cal, ramps, monkeypatch, more, code):
    plan_of(ramps)
    monkeypatch.chdir(ramps)
    assert brake_cal("repeatability", "--vehicle", VEHICLE, *more).code == code
