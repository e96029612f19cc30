"""`brake-cal validate` as the shell runs it."""

import json
import shutil
from dataclasses import replace

import pyarrow.parquet as pq
import pytest

from calib.estimation.metrics import METRICS
from calib.logs.write import write_csv, write_parquet
from calib.store.store import Store
from tests.cli.conftest import parsed
from tests.support.reference_car import CAR, WET, cut, noisy, stop, without

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


def test_a_file_for_each_log_and_the_summary(run, tmp_path):
    """The pads of the stops are 0.31 and 0.27 for 0.38: weaker, apart by 15 %, and that is said."""
    out = tmp_path / "results"
    document = parsed(ran := run("wet.csv", "harder.parquet", "--out", out, "--json"))
    assert ran.code == 0
    assert [log["verdict"] for log in document["logs"]] == ["passed", "passed"]
    assert (document["table"], document["verdict"]) == ("sedan-2up@1", "passed")
    assert (document["proof"], document["exported"]) == ("truth", None)
    assert set(document["logs"][0]["figures"]) == set(METRICS)
    codes = {warning["code"] for warning in document["warnings"]}
    assert codes
    assert codes <= {"pads_changed_apart", "level_changed"}
    assert ran.err.count("warning: ") == len(document["warnings"])
    names = ["harder.parquet", "summary.json", "wet.parquet"]
    assert sorted(p.name for p in out.iterdir()) == names
    assert json.loads((out / "summary.json").read_text()) == document
    table = pq.read_table(out / "wet.parquet")
    assert table.column_names[:3] == ["time", "z", "eta"]
    assert table.column("valid").to_numpy().sum() > 1000


def test_a_log_past_its_limits_ends_with_1(run, tmp_path):
    limits = tmp_path / "limits.toml"
    limits.write_text("schema = 1\n[limits]\nfinal_error_f = { max = 0.0193 }\n")
    document = parsed(ran := run("wet.csv", "harder.parquet", "--json", "--limits", limits))
    assert (ran.code, document["verdict"]) == (1, "failed")
    assert [log["verdict"] for log in document["logs"]] == ["passed", "failed"]


def test_without_truth_and_v_it_is_consistent_and_a_release_says_so(brake_cal, bench, tmp_path):
    store, out = tmp_path / "tables", tmp_path / "results"
    shutil.copytree(bench / "tables", store)
    ran = brake_cal("validate", CAR.name, bench / "plain.csv", "--store", store, "--out", out)
    assert ran.code == 0
    summary = json.loads((out / "summary.json").read_text())
    assert (summary["verdict"], summary["proof"]) == ("passed", "none")
    words = ("--reason", "a test", "--evidence", out / "summary.json", "--store", store)
    assert brake_cal("tables", "release", f"{CAR.name}@1", *words).code == 0
    (row,) = parsed(brake_cal("tables", "list", "--store", store, "--json"))["tables"]
    assert row["verdict"] == "consistent, not proved"


@pytest.mark.parametrize("words", [("--points", 12, "--fixed-point", 16), ("--float",)])
def test_it_is_judged_as_it_is_exported(run, words):
    document, whole = (parsed(run("wet.csv", "--json", *more)) for more in (words, ()))
    typed = {"points": 12, "bits": 16} if "--points" in words else {}
    defaults = {"points": None, "bits": None, "single": "--float" in words, "code": False}
    assert document["exported"] == defaults | typed
    figures, full = (x["logs"][0]["figures"] for x in (document, whole))
    assert figures["pad_friction_r"] == full["pad_friction_r"]
    assert figures["ecu_pad_friction_r"] != full["ecu_pad_friction_r"]
    assert figures["ecu_pad_friction_r"] == pytest.approx(full["ecu_pad_friction_r"], rel=0.1)


@pytest.mark.parametrize("there_before", [True, False])
def test_a_bad_later_log_leaves_nothing_of_the_earlier_ones(run, tmp_path, there_before):
    out = tmp_path / "results"
    if there_before:
        out.mkdir()
    ran = run("wet.csv", "bad.csv", "--out", out, "--json")
    assert (ran.code, ran.result) == (3, "")
    assert out.exists() == there_before
    assert not there_before or not list(out.iterdir())


def test_two_logs_of_one_name_have_no_place_in_out(run, bench, tmp_path):
    twin = tmp_path / "wet.parquet"
    twin.write_bytes((bench / "harder.parquet").read_bytes())
    ran = run("wet.csv", twin, "--out", tmp_path / "results")
    assert (ran.code, ran.result) == (2, "")
    assert not (tmp_path / "results").exists()
    assert run("wet.csv", twin).code == 0
