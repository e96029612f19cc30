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


def logs_of(root):
    return sorted(root.glob("*/*/*.csv"))


def test_a_study_from_folders(brake_cal, ramps, tmp_path):
    out = tmp_path / "gauge"
    ran = brake_cal("repeatability", *logs_of(ramps), "--vehicle", VEHICLE, "--quantity",
                    "pad_scale", "--out", out, "--json")  # fmt: skip
    assert ran.code == 0, ran.err
    assert "cars a, b, c; stations north, south" in ran.err
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


def test_a_plan_and_limits_that_fail(brake_cal, ramps, tmp_path):
    plan, limits = ramps / "plan.csv", tmp_path / "limits.toml"
    rows = [f"{car}/{s}/{k}.csv,{car}" for car in PADS for s in ("north", "south") for k in (0, 1)]
    plan.write_text("\n".join(["log,car", *rows, ""]))
    limits.write_text("schema = 1\n[limits]\npad_scale_grr = { max = 0.0001 }\n")
    ran = brake_cal("repeatability", "--plan", plan, "--vehicle", VEHICLE, "--quantity",
                    "pad_scale", "--limits", limits)  # fmt: skip
    assert ran.code == 1, ran.err
    assert "pad_scale" in ran.out
    assert "bad" in ran.out
    assert "reproducibility is not measured" in ran.out


@pytest.mark.parametrize(
    ("more", "code", "says"),
    [
        (("--quantity", "pad_scael"), 2, "did you mean 'pad_scale'"),
        (("--folders", "station"), 2, "car/station"),
        (("--folders", "car", "--plan", "p.csv"), 2, "not together with --plan"),
        (("--plan", "nowhere.csv"), 3, "no such file"),
        (("--folders", "car", "--road", "wet"), 2, "only with a --plan"),
    ],
)
def test_mistakes(brake_cal, ramps, more, code, says):
    ran = brake_cal("repeatability", logs_of(ramps)[0], "--vehicle", VEHICLE, *more)
    assert ran.code == code
    assert says in " ".join(ran.err.split())


def test_it_asks_where_folders_do_not_say(brake_cal, ramps):
    ran = brake_cal("repeatability", *logs_of(ramps)[:4], "--vehicle", VEHICLE)
    assert ran.code == 3
    assert "--plan plan.csv" in ran.err
    ran = brake_cal("repeatability", "--vehicle", VEHICLE)
    assert ran.code == 2
    ran = brake_cal("repeatability", *logs_of(ramps))
    assert ran.code == 2
    assert "--vehicle" in ran.err
