"""`brake-cal log` as the shell runs it."""

import re
from pathlib import Path

import numpy as np
import pytest

from calib.logs.read import read_log
from calib.logs.whole import read_whole
from tests.cli.conftest import parsed

SEDAN = Path(__file__).parents[2] / "sample_logs/sedan"
RAMP, COAST = SEDAN / "ramp_wet_asphalt.csv", SEDAN / "coast.csv"


def test_view_prints_one_document(brake_cal):
    found = parsed(brake_cal("log", RAMP, COAST, "--json"))
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
    assert "data:image/svg+xml," in text
    assert "omega_fl" not in text
    assert not re.findall(r'(?:src|href)="(?!data:)', text.partition("<script")[0])
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


@pytest.mark.parametrize(
    ("options", "code"),
    [(("--from", 50), 3), (("--from", 5, "--until", 4), 2), (("--from", "1,5"), 2)],
)
def test_a_cut_that_makes_no_sense_writes_nothing(brake_cal, tmp_path, options, code):
    assert brake_cal("log", RAMP, *options, "--out", tmp_path / "cut.csv").code == code
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
