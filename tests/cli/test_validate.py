"""`brake-cal validate` as the shell runs it."""

import json
import shutil
from dataclasses import replace

import pyarrow.parquet as pq
import pytest

from calib.estimation.metrics import METRICS
from calib.logs.write import write_csv, write_parquet
from calib.store.store import Store
from tests.support.reference_car import (
    CAR,
    REAL,
    SEDAN,
    WET,
    cut,
    noisy,
    ramp,
    stop,
    without,
)
from tests.support.vehicle_files import write_vehicle

LOGS = ("wet.csv", "harder.parquet", "bad.csv", "plain.csv")


@pytest.fixture(scope="module")
def bench(tmp_path_factory, fitted):
    """A store with a table of the car, two stops that pass, and one that will not do."""
    home = tmp_path_factory.mktemp("bench")
    Store(home / "tables").save(fitted)
    wet = noisy(stop(WET), 3)
    write_csv(wet, home / "wet.csv")
    write_parquet(noisy(stop(WET, pressure=30e5), 4), home / "harder.parquet")
    write_csv(cut(wet, 1.8), home / "bad.csv")
    write_csv(without(replace(wet, truth={}), "v"), home / "plain.csv")
    return home


@pytest.fixture
def run(brake_cal, bench):
    def validate(*arguments, table=CAR.name):
        words = [bench / a if a in LOGS else a for a in arguments]
        return brake_cal("validate", table, *words, "--store", bench / "tables")

    return validate


def limits(tmp_path, text):
    path = tmp_path / "limits.toml"
    path.write_text(f"schema = 1\n[limits]\n{text}\n")
    return path


def test_logs_that_pass(run):
    """The pads of the stops are 0.31 and 0.27 for 0.38: weaker, apart by 15 %, and that is said."""
    ran = run("wet.csv", "harder.parquet", "--json")
    assert ran.code == 0
    document = json.loads(ran.out)
    assert [log["verdict"] for log in document["logs"]] == ["passed", "passed"]
    codes = {warning["code"] for warning in document["warnings"]}
    assert codes
    assert codes <= {"pads_changed_apart", "level_changed"}
    assert ran.err.count("warning: ") == len(document["warnings"])


@pytest.mark.parametrize(("bound", "code"), [("{ max = 1e-6 }", 1), ("{ max = 0.5 }", 0)])
def test_json_is_one_document(run, tmp_path, bound, code):
    ran = run("wet.csv", "--json", "--limits", limits(tmp_path, f"torque_error_f = {bound}"))
    assert ran.code == code
    document = json.loads(ran.out)
    assert document["table"] == "sedan-2up@1"
    assert document["verdict"] == ("failed" if code else "passed")
    assert (document["proof"], document["exported"]) == ("truth", None)
    assert set(document["logs"][0]["figures"]) == set(METRICS)


def test_out_holds_a_file_per_log_and_the_summary(run, tmp_path):
    out = tmp_path / "results"
    ran = run("wet.csv", "harder.parquet", "--out", out, "--json")
    assert ran.code == 0
    assert sorted(p.name for p in out.iterdir()) == [
        "harder.parquet",
        "summary.json",
        "wet.parquet",
    ]
    assert json.loads((out / "summary.json").read_text()) == json.loads(ran.out)
    table = pq.read_table(out / "wet.parquet")
    assert table.column_names[:3] == ["time", "z", "eta"]
    assert table.column("valid").to_numpy().sum() > 1000
    assert f"wrote {out / 'wet.parquet'}" in ran.err


def test_without_truth_and_v_it_is_consistent_and_a_release_says_so(brake_cal, bench, tmp_path):
    store, out = tmp_path / "tables", tmp_path / "results"
    shutil.copytree(bench / "tables", store)
    ran = brake_cal("validate", CAR.name, bench / "plain.csv", "--store", store, "--out", out)
    assert ran.code == 0
    assert "onsistent, not proved" in ran.out
    summary = json.loads((out / "summary.json").read_text())
    assert (summary["verdict"], summary["proof"]) == ("passed", "none")
    words = ("--reason", "a test", "--evidence", out / "summary.json", "--store", store)
    released = brake_cal("tables", "release", f"{CAR.name}@1", *words)
    assert released.code == 0, released.err
    assert "consistent, not proved" in released.out
    listed = json.loads(brake_cal("tables", "list", "--store", store, "--json").out)
    assert [row["verdict"] for row in listed["tables"]] == ["consistent, not proved"]


def test_the_ecu_stands_beside_the_best_estimate_and_the_truth(run):
    ran = run("wet.csv", "-v")
    rows = [line.split() for line in ran.out.splitlines() if line.startswith("wet")]
    found = {row[1]: row for row in rows if "," not in row[0]}
    assert {"ECU", "best,", "truth"} <= set(found)
    assert found["truth"][2:] == ["0.310", "0.270", "0.787"]


@pytest.mark.parametrize("words", [("--points", 12, "--fixed-point", 16), ("--float",)])
def test_it_is_judged_as_it_is_exported(run, words):
    ran, whole = (run("wet.csv", "--json", *more) for more in (words, ()))
    assert ran.code == 0, ran.err
    document = json.loads(ran.out)
    given = {"points": None, "bits": None, "single": "--float" in words, "code": False}
    assert document["exported"] == given | (
        {} if "--float" in words else {"points": 12, "bits": 16}
    )
    one, other = (json.loads(x.out)["logs"][0]["figures"] for x in (ran, whole))
    assert one["pad_friction_r"] == other["pad_friction_r"]
    assert one["ecu_pad_friction_r"] != other["ecu_pad_friction_r"]
    assert one["ecu_pad_friction_r"] == pytest.approx(other["ecu_pad_friction_r"], rel=0.1)


@pytest.mark.parametrize(
    "words", [("--float", "--fixed-point", 16), ("--fixed-point", 12), ("--points", 1)]
)
def test_no_table_is_exported_like_that(run, words):
    assert run("wet.csv", *words).code == 2


def test_a_table_of_before_is_to_be_fitted_again(brake_cal, bench, fitted, tmp_path):
    store = tmp_path / "tables"
    Store(store).save(replace(fitted, map=None, level_map=None, draws=None))
    digest = fitted.provenance.logs[0].digest
    where = ("--store", store)
    for words in (
        ("validate", CAR.name, bench / "wet.csv"),
        ("plot", CAR.name, bench / "wet.csv", "--out", tmp_path / "a.png"),
        ("batch", "validate", bench / "wet.csv", "--table", CAR.name, "--out", tmp_path / "b"),
    ):
        ran = brake_cal(*words, *where)
        assert ran.code == 4, words
        assert digest in ran.err
    for words in (("show", CAR.name), ("verify",), ("diff", CAR.name, f"{CAR.name}@1")):
        assert brake_cal("tables", *words, *where).code == 0


@pytest.mark.parametrize("there_before", [True, False])
def test_a_bad_later_log_leaves_nothing_of_the_earlier_ones(run, tmp_path, there_before):
    out = tmp_path / "results"
    if there_before:
        out.mkdir()
    ran = run("wet.csv", "bad.csv", "--out", out, "--json")
    assert (ran.code, ran.result) == (3, "")
    assert "bad.csv" in ran.err
    assert out.exists() == there_before
    assert not there_before or not list(out.iterdir())


def test_every_log_that_cannot_be_used_is_told(run, tmp_path):
    other = tmp_path / "other.csv"
    other.write_text("time,p_mc\n0,1\n")
    ran = run("bad.csv", "wet.csv", str(other))
    assert ran.code == 3
    errors = [line for line in ran.err.splitlines() if line.startswith("error: ")]
    assert ["bad.csv" in errors[0], "other.csv" in errors[1]] == [True, True]


def test_two_logs_of_one_name_have_no_place_in_out(run, bench, tmp_path):
    twin = tmp_path / "wet.parquet"
    twin.write_bytes((bench / "harder.parquet").read_bytes())
    ran = run("wet.csv", twin, "--out", tmp_path / "results")
    assert (ran.code, ran.result) == (2, "")
    assert "two logs are named wet" in " ".join(ran.err.split())
    assert not (tmp_path / "results").exists()
    assert run("wet.csv", twin).code == 0


def test_vehicle_with_other_pads_is_accepted(run, tmp_path):
    path = tmp_path / "pads.toml"
    write_vehicle(replace(CAR, front=replace(CAR.front, pad_friction=0.5)), path)
    ran = run("wet.csv", "--vehicle", path, "--json")
    assert ran.code == 0
    figures = json.loads(ran.out)["logs"][0]["figures"]
    assert figures["pad_friction_f"] == pytest.approx(0.31, rel=0.05)


def test_a_calibration_log_is_named_as_no_proof(brake_cal, tmp_path):
    log = tmp_path / "ramp.csv"
    write_csv(noisy(ramp(REAL), 1), log)
    where = ("--store", tmp_path / "tables")
    assert brake_cal("fit", log, "--vehicle", SEDAN / "vehicle.toml", *where).code == 0
    ran = brake_cal("validate", "sedan-2up", log, *where)
    assert ran.code == 1
    assert "no hold-out" in ran.out


@pytest.mark.parametrize(
    "reference", ["sedan", "sedan-2up@7", "sedan-2up@x", "./none", "log.csv", "./log.csv"]
)
def test_an_unknown_table_ends_with_2(run, tmp_path, monkeypatch, reference):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "log.csv").touch()
    ran = run("wet.csv", "--json", "--out", tmp_path / "results", table=reference)
    assert (ran.code, ran.result) == (2, "")
    assert not (tmp_path / "results").exists()


@pytest.mark.parametrize(
    ("file", "damage"),
    [("record.json", "cut"), ("difference.parquet", "bit"), ("tyre.parquet", "gone")],
)
def test_a_damaged_table_ends_with_4_and_names_the_file(brake_cal, bench, tmp_path, file, damage):
    store = tmp_path / "tables" / "sedan-2up" / "v0001"
    store.mkdir(parents=True)
    for source in (bench / "tables/sedan-2up/v0001").iterdir():
        (store / source.name).write_bytes(source.read_bytes())
    data = bytearray((store / file).read_bytes())
    if damage == "gone":
        (store / file).unlink()
    elif damage == "cut":
        (store / file).write_bytes(data[: len(data) // 2])
    else:
        data[len(data) // 2] ^= 1
        (store / file).write_bytes(data)
    ran = brake_cal(
        "validate", "sedan-2up@1", bench / "wet.csv", "--store", tmp_path / "tables", "--json"
    )
    assert (ran.code, ran.result) == (4, "")
    assert file in ran.err
    assert "Traceback" not in ran.err


@pytest.fixture(scope="module")
def loaded(tmp_path_factory):
    """A stop of the car with a fifth of its mass more on board."""
    path = tmp_path_factory.mktemp("loaded") / "loaded.csv"
    write_csv(noisy(stop(replace(WET, mass_scale=1.2)), 3), path)
    return path


def pads(ran):
    return json.loads(ran.out)["logs"][0]["figures"]["pad_friction_f"]


def test_a_stated_mass_is_used_and_told(run, loaded):
    told, untold = (run(loaded, "--json", *words) for words in (("--mass", "2093 kg"), ()))
    assert pads(told) == pytest.approx(0.31, rel=0.03)
    assert pads(untold) == pytest.approx(0.31 / 1.2, rel=0.03)
    assert json.loads(told.out)["mass"] == {
        "value": 2093.0,
        "tolerance": 0.005,
        "stated": True,
        "share": 2093.0 / 1744.0,
    }
    assert json.loads(untold.out)["mass"] == {
        "value": 1744.0,
        "tolerance": 0.005,
        "stated": False,
        "share": 1.0,
    }
    assert pads(run(loaded, "--json", "--mass", "2.093 t")) == pads(told)


def test_a_load_that_nobody_wrote_down_is_told(brake_cal, bench, fitted, tmp_path):
    unknown = replace(fitted, vehicle=replace(fitted.vehicle, mass_tolerance=0.03))
    Store(tmp_path / "tables").save(unknown)
    words = ("validate", CAR.name, bench / "wet.csv", "--store", tmp_path / "tables")
    told = json.loads(brake_cal(*words, "--json").out)["mass"]
    assert told == {"value": 1744.0, "tolerance": 0.03, "stated": False, "share": 1.0}


def test_a_vehicle_of_another_mass_is_refused_unless_the_mass_is_stated(run, loaded, tmp_path):
    other = tmp_path / "other.toml"
    other.write_text((SEDAN / "vehicle.toml").read_text().replace('"1744 kg"', '"1900 kg"'))
    refused = run(loaded, "--vehicle", other)
    assert refused.code == 3
    assert "mass 1900 for 1744" in refused.err
    ran = run(loaded, "--vehicle", other, "--mass", "2093 kg", "--json")
    assert ran.code == 0, ran.err
    assert pads(ran) == pytest.approx(0.31, rel=0.03)


@pytest.mark.parametrize("mass", ["2093", "heavy", "2 m", "20 kg"])
def test_a_mass_that_is_none_is_a_wrong_use(run, mass):
    assert run("wet.csv", "--mass", mass).code == 2


def test_a_report_has_a_section_for_each_stop(brake_cal, bench):
    page = bench / "validate.html"
    stops = (bench / "wet.csv", bench / "harder.parquet")
    ran = brake_cal("validate", CAR.name, *stops, "--store", bench / "tables", "--report", page)
    assert ran.code == 0, ran.err
    text = page.read_text()
    assert "<h1>Validation of" in text
    assert [text.count(f">{path.stem}: passed") for path in stops] == [1, 1]
