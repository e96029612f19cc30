"""`brake-cal batch` as the shell runs it."""

import json
import re

import pyarrow.parquet as pq
import pytest

from calib.estimation.metrics import METRICS
from calib.line.fleet.rows import HEAD, columns_of
from calib.store.store import Store
from tests.support.fleet_logs import many
from tests.support.reference_car import CAR, REAL, SEDAN, WET, cut, noisy, stop
from tests.support.terminal import on_a_terminal


@pytest.fixture(scope="module")
def home(tmp_path_factory, fitted):
    """A table of the car in tables/, and three logs of which one will not do in logs/."""
    home = tmp_path_factory.mktemp("home")
    wet = noisy(stop(WET), 3)
    Store(home / "tables").save(fitted)
    many(home / "logs", [wet, noisy(stop(REAL), 4), cut(wet, 1.8)], 3)
    return home


@pytest.fixture
def batch(brake_cal, home, monkeypatch):
    monkeypatch.chdir(home)

    def run(command, *arguments, out):
        return brake_cal("batch", command, *arguments, "--out", out, "--workers", "2")

    return run


def rows(out):
    return pq.read_table(out / "results.parquet").to_pylist()


def test_validate_says_what_it_did_and_the_columns_have_units(batch, tmp_path):
    ran = batch("validate", "logs", "--table", CAR.name, "--json", out=tmp_path / "out")
    assert ran.code == 0
    said = json.loads(ran.out)
    assert said["counts"] == {"passed": 2, "failed": 0, "done": 0, "error": 1}
    assert said["done_now"] == said["logs"] == 3
    assert "validate on 2 workers" in ran.err
    assert "3 of 3 logs" in ran.err
    schema = pq.read_schema(tmp_path / "out/results.parquet")
    assert schema.names == ["log", "digest", "status", "error", *METRICS, "not_held", "warned"]
    assert all(field.metadata[b"unit"] for field in schema)
    assert {str(schema.field(name).type) for name in METRICS} == {"double"}
    again = batch("validate", "logs", "--table", CAR.name, "--json", out=tmp_path / "out")
    assert json.loads(again.out)["done_now"] == 0


def test_a_log_that_fails_its_limits_ends_with_1(batch, brake_cal, tmp_path):
    limits = tmp_path / "limits.toml"
    limits.write_text("schema = 1\n[limits]\ninterval_f = { max = 1e-6 }\n")
    words = ("logs", "--table", CAR.name)
    ran = batch("validate", *words, "--limits", limits, out=tmp_path / "out")
    assert (ran.code, ran.out.split(";")[0]) == (1, "3 logs: 1 error, 2 failed")
    assert [row["not_held"] for row in rows(tmp_path / "out")] == [
        "interval_f",
        "interval_f",
        None,
    ]
    ours = tmp_path / "line.toml"
    assert brake_cal("limits", "init", "--out", ours).code == 0
    assert batch("validate", *words, "--limits", ours, out=tmp_path / "ours").code == 0
    other = batch("validate", *words, out=tmp_path / "out")
    assert other.code == 2
    assert "other settings: limits" in other.err
    assert batch("validate", *words, "--fresh", out=tmp_path / "out").code == 0


def test_fit_and_check(batch, tmp_path):
    sedan = [SEDAN / "ramp_wet_asphalt.csv", SEDAN / "coast.csv"]
    ran = batch("fit", *sedan, "--vehicle", SEDAN / "vehicle.toml", out=tmp_path / "fit")
    assert ran.code == 0, ran.err
    coast, ramp_ = rows(tmp_path / "fit")
    assert (coast["status"], ramp_["status"]) == ("error", "done")
    assert 0.3 < ramp_["pad_friction_f"] < 0.5
    assert len(ramp_["table_digest"]) == 64
    assert batch("check", *sedan, out=tmp_path / "check").code == 0
    coast, ramp_ = rows(tmp_path / "check")
    assert (coast["usable_fit"], ramp_["usable_fit"]) == (False, True)
    assert list(ramp_) == [c.name for c in (*HEAD, *columns_of("check"))]
    assert (coast["samples"], coast["brakings"]) == (2000.0, 0.0)


def test_diagnose_takes_a_folder_for_a_log(batch, tmp_path):
    cases = SEDAN.parent / "hidden"
    (tmp_path / "cars/empty/calibration").mkdir(parents=True)
    (tmp_path / "cars/empty/holdout").mkdir()
    (tmp_path / "cars/empty/vehicle.toml").write_text("schema = 7\n")
    for log in ("calibration/coast", "calibration/ramp", "holdout/stop_a"):
        path = tmp_path / f"cars/case_0/{log}.parquet"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.symlink_to(cases / f"case_0/{log}.parquet")
    (tmp_path / "cars/case_0/vehicle.toml").symlink_to(cases / "case_0/vehicle.toml")
    cars = (tmp_path / "cars/empty", tmp_path / "cars/case_0")
    ran = batch("diagnose", *cars, out=tmp_path / "out")
    assert ran.code == 0, ran.err
    found, empty = rows(tmp_path / "out")
    assert found["status"] == "done", found["error"]
    assert found["effects"] == "aerodynamic_drag", "as answer.json beside it has it"
    assert found["gap_after"] < found["gap_before"]
    assert (empty["status"], len(empty["digest"])) == ("error", 64)
    assert str(tmp_path / "cars/empty/vehicle.toml") in empty["error"]


def test_nothing_that_can_be_read_ends_with_3(batch, tmp_path):
    bad = tmp_path / "bad.csv"
    bad.write_text("nonsense\n")
    assert batch("check", bad, out=tmp_path / "out").code == 3
    assert rows(tmp_path / "out")[0]["error"].startswith(str(bad))
    ran = batch("check", tmp_path / "nowhere", out=tmp_path / "none")
    assert ran.code == 3
    assert "no log found" in ran.err
    assert not (tmp_path / "none").exists()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("validate", "logs"), "validate needs a table"),
        (("fit", "logs"), "fit needs a vehicle"),
        (("check", "logs", "--table", "x"), "check takes none"),
        (("diagnose", "logs", "--limits", "x"), "diagnose takes none"),
        (("validat", "logs"), "'validat' is not one of"),
        (("check", "logs", "--scheduler", "tcp://127.0.0.1:1"), "has its own workers"),
    ],
)
def test_usage(batch, tmp_path, words, said):
    ran = batch(*words, out=tmp_path / "out")
    assert ran.code == 2
    assert said in ran.err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("environment", "bar", "colour"),
    [
        ({"TERM": "xterm"}, True, True),
        ({"TERM": "xterm", "NO_COLOR": "1"}, True, False),
        ({"TERM": "dumb"}, False, False),
    ],
)
def test_progress_is_a_bar_on_a_terminal_that_can_draw_one(
    home, tmp_path, environment, bar, colour
):
    words = ("batch", "check", "logs", "--out", tmp_path / "out", "--workers", "1")
    out, seen = on_a_terminal(words, home, **environment)
    assert out == f"3 logs: 1 failed, 2 passed; {tmp_path}/out/results.parquet\n"
    assert ("\u2501" in seen) == bar
    assert bool(re.search(r"\x1b\[[\d;]*3[0-9]m", seen)) == colour
    assert "3 of 3 logs" in seen
