"""`brake-cal repeatability` as the shell runs it."""

import json

import pytest

from calib.logs.write import write_csv
from tests.cli.conftest import parsed
from tests.support.documents import missing_and_unknown
from tests.support.reference_car import REAL, SEDAN, noisy, ramp, with_pads

VEHICLE = SEDAN / "vehicle.toml"
PADS = {"a": 0.33, "b": 0.42}


@pytest.fixture(scope="module")
def ramps(tmp_path_factory):
    """Two cars, two ramps each, and their plan."""
    root, rows = tmp_path_factory.mktemp("ramps"), ["log,car"]
    for i, (car, mu) in enumerate(PADS.items()):
        clean = ramp(with_pads(REAL, mu, mu))
        for k in range(2):
            write_csv(noisy(clean, 10 * i + k), root / f"{car}{k}.csv")
            rows.append(f"{car}{k}.csv,{car}")
    (root / "plan.csv").write_text("\n".join([*rows, ""]))
    return root


def test_a_study(brake_cal, ramps, tmp_path):
    out = tmp_path / "gauge"
    page = tmp_path / "page.html"
    ran = brake_cal("repeatability", "--plan", ramps / "plan.csv", "--vehicle", VEHICLE,
                    "--metric", "pad_scale", "--out", out, "--report", page, "--json")  # fmt: skip
    assert ran.code == 0, ran.err
    document = parsed(ran)
    assert document == json.loads((out / "repeatability.json").read_text())
    assert (out / "repeatability.png").read_bytes().startswith(b"\x89PNG")
    assert page.read_text().count("<img") == 1
    assert missing_and_unknown("repeatability-json", document) == []
    quantity = document["quantities"]["pad_scale"]
    # the cars differ by 0.0636 in friction, sd, which is 0.167 of the nominal 0.38
    assert quantity["components"]["car"]["sd"] == pytest.approx(0.167, rel=0.1)
    assert quantity["grr"]["value"] < 0.3
    assert [row["df"] for row in quantity["anova"]] == [1, 2]
    assert list(document["ramps"][0]) == ["log", "car", "station", "figures", "digest"]
    assert len(document["ramps"]) == 4


@pytest.mark.parametrize(
    ("more", "code"),
    [
        (("--metric", "pad_scael", "--plan", "plan.csv"), 2),
        (("--plan", "nowhere.csv"), 3),
        ((), 2),
        (("--folders", "car/station"), 2),
    ],
)
def test_mistakes(brake_cal, ramps, monkeypatch, more, code):
    monkeypatch.chdir(ramps)
    assert brake_cal("repeatability", "--vehicle", VEHICLE, *more).code == code
