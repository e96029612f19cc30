"""`brake-cal log` as the shell runs it."""

import json
from pathlib import Path

import numpy as np
import pytest

from calib.logs.read import read_log
from calib.logs.whole import read_whole

SEDAN = Path(__file__).parents[2] / "sample_logs/sedan"
RAMP, COAST = SEDAN / "ramp_wet_asphalt.csv", SEDAN / "coast.csv"


@pytest.fixture
def document():
    return lambda ran: json.loads(ran.out)


def test_view_lists_columns_and_events(brake_cal):
    ran = brake_cal("log", RAMP)
    assert ran.code == 0
    for text in ("p_mc", "rad/s", "rate [Hz]", "lead-in", "bite", "braking", "200"):
        assert text in ran.out


def test_view_prints_one_document(brake_cal, document):
    found = document(brake_cal("log", RAMP, COAST, "--json"))
    ramp, coast = found["logs"]
    assert [e["kind"] for e in ramp["events"]] == ["lead-in", "bite", "braking"]
    assert [e["kind"] for e in coast["events"]] == ["lead-in"]
    assert {c["name"]: c["unit"] for c in ramp["columns"]}["p_mc"] == "bar"


def test_view_draws_a_picture_and_a_page_that_fetches_nothing(brake_cal, tmp_path):
    picture, page = tmp_path / "ramp.png", tmp_path / "ramp.html"
    assert brake_cal("log", RAMP, "--out", picture).code == 0
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert brake_cal("log", RAMP, "--channel", "p_mc", "--out", page).code == 0
    text = page.read_text()
    assert "data:image/png;base64," in text
    assert "omega_fl" not in text
    assert "http" not in text
    assert brake_cal("log", COAST, "--out", page).code == 0
    page.write_text("<!DOCTYPE html><p>mine</p>")
    ran = brake_cal("log", COAST, "--out", page)
    assert (ran.code, page.stat().st_size) == (2, 26)
    assert brake_cal("log", RAMP, COAST, "--out", picture).code == 2
    assert brake_cal("log", RAMP, "--channel", "p_mcc").code == 2


def test_cut_says_what_it_kept(brake_cal, tmp_path):
    out = tmp_path / "cut.parquet"
    ran = brake_cal("log", RAMP, "--from", 2.5, "--until", 6, "--out", out)
    assert ran.code == 0
    log, part = read_log(RAMP), read_log(out)
    np.testing.assert_array_equal(part["omega_fl"], log["omega_fl"][500:1201])


def test_cut_takes_times_with_units(brake_cal, tmp_path):
    for options in (("2.5", "6"), ("2.5 s", "6000 ms"), ("2500ms", "0.1 min")):
        out = tmp_path / "cut.csv"
        ran = brake_cal("log", RAMP, "--from", options[0], "--until", options[1], "--out", out)
        assert (ran.code, read_log(out).time.size) == (0, 701)


@pytest.mark.parametrize(
    ("options", "code", "says"),
    [
        (("--from", 50), 3, "no sample from 50 s"),
        (("--from", 5, "--until", 4), 2, "5 s is not before 4 s"),
        (("--from", "1,5"), 2, "'1,5' is not a quantity"),
        (("--until", "1 bar"), 2, "a unit of pressure, not of time"),
        (("--from", "early"), 2, 'expected a quantity such as "1.5 s"'),
        (("--from", "nan"), 2, "not finite"),
    ],
)
def test_a_cut_that_makes_no_sense_writes_nothing(brake_cal, tmp_path, options, code, says):
    ran = brake_cal("log", RAMP, *options, "--out", tmp_path / "cut.csv")
    assert ran.code == code
    assert list(tmp_path.iterdir()) == []


def test_convert_goes_round_all_formats(brake_cal, tmp_path):
    path = RAMP
    for name in ("a.mf4", "b.parquet", "c.csv"):
        assert brake_cal("log", path, "--out", tmp_path / name).code == 0
        path = tmp_path / name
    ours, theirs = read_whole(RAMP), read_whole(path)
    for a, b in zip(ours.columns, theirs.columns, strict=True):
        assert (a.name, a.unit) == (b.name, b.unit)
        np.testing.assert_array_equal(a.values, b.values)


def test_several_logs_go_into_a_folder_or_none(brake_cal, tmp_path):
    out = tmp_path / "made"
    ran = brake_cal("log", RAMP, COAST, "--out", out, "--to", "parquet", "--json")
    assert ran.code == 0
    made = [entry["out"] for entry in json.loads(ran.out)["logs"]]
    assert made == [str(out / f"{path.stem}.parquet") for path in (RAMP, COAST)]
    assert sorted(map(str, out.iterdir())) == sorted(made)
    bad = tmp_path / "bad.csv"
    bad.write_text("time [s]\n")
    ran = brake_cal("log", RAMP, bad, "--out", tmp_path / "none", "--to", "csv")
    assert ran.code == 3
    assert not (tmp_path / "none").exists()


def test_a_file_that_exists_is_replaced_with_force_only(brake_cal, tmp_path):
    out = tmp_path / "coast.csv"
    out.write_text("mine")
    for arguments in (("--out", out), ("--out", tmp_path, "--to", "csv")):
        ran = brake_cal("log", COAST, *arguments)
        assert (ran.code, out.read_text()) == (2, "mine")
    assert brake_cal("log", COAST, "--until", 3, "--out", out).code == 2
    assert brake_cal("log", COAST, "--out", tmp_path, "--to", "csv", "--force").code == 0
    assert read_log(out).time.size == 2000
    made = out.read_bytes()
    assert brake_cal("log", COAST, "--out", out).code == 0  # the same log once more
    assert brake_cal("log", RAMP, "--out", out).code == 2
    assert out.read_bytes() == made


def test_what_convert_cannot_write_is_a_usage_error(brake_cal, tmp_path):
    copy = tmp_path / "run.csv"
    copy.write_bytes(COAST.read_bytes())
    for arguments in (
        (copy, "--out", copy),
        (copy, "--out", "x.xlsx"),
        (copy, RAMP, "--out", "x.csv"),
        (copy, "--out", tmp_path / "d", "--to", "xlsx"),
    ):
        ran = brake_cal("log", *arguments)
        assert ran.code == 2
