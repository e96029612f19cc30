"""`brake-cal repeatability` as the shell runs it."""

import json

import pytest

from calib.logs.write import write_csv
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


@pytest.fixture
def study(brake_cal, ramps):
    """Run a study of the pads by a plan of these columns."""

    def run(columns, *more):
        rows = [
            (f"{car}/{station}/{k}.csv", car, station)
            for car in PADS
            for station in ("north", "south")
            for k in (0, 1)
        ]
        lines = [columns, *(",".join(row[: columns.count(",") + 1]) for row in rows)]
        (ramps / "plan.csv").write_text("\n".join(lines))
        return brake_cal("repeatability", "--plan", ramps / "plan.csv", *more)

    return run


CAR = ("--vehicle", VEHICLE, "--quantity", "pad_scale")


def test_a_study_of_cars_and_stations(study, tmp_path):
    out = tmp_path / "gauge"
    ran = study("log,car,station", *CAR, "--out", out, "--json")
    assert ran.code == 0, ran.err
    told = json.loads(ran.out)
    assert told == json.loads((out / "repeatability.json").read_text())
    assert (out / "repeatability.png").read_bytes().startswith(b"\x89PNG")
    found = told["quantities"]["pad_scale"]
    # the cars differ by 0.045 in friction, sd, which is 0.12 of the nominal 0.38
    assert found["components"]["car"]["sd"] == pytest.approx(0.119, rel=0.1)
    assert found["grr"]["value"] < 0.3
    assert [row["df"] for row in found["anova"]] == [2, 1, 2, 6]
    assert len(told["ramps"]) == 12
    assert list(told["ramps"][0]) == ["log", "car", "station", "figures", "digest"]


def test_limits_that_fail(study, tmp_path):
    limits = tmp_path / "limits.toml"
    limits.write_text("schema = 1\n[limits]\npad_scale_grr = { max = 0.0001 }\n")
    ran = study("log,car", *CAR, "--limits", limits)
    assert ran.code == 1, ran.err
    assert "reproducibility is not measured" in ran.out


@pytest.mark.parametrize(
    ("more", "code"),
    [
        (("--vehicle", VEHICLE, "--quantity", "pad_scael"), 2),
        (("--plan", "nowhere.csv"), 3),
        (("--road", "wet"), 3),
        ((), 2),
    ],
)
def test_mistakes(study, more, code):
    assert study("log,car", *more).code == code
