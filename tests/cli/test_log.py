"""`brake-cal log` as the shell runs it."""

import re
from pathlib import Path

import pytest

from tests.cli.conftest import parsed

SEDAN = Path(__file__).parents[2] / "sample_logs/sedan"
RAMP, COAST = SEDAN / "ramp_wet_asphalt.csv", SEDAN / "coast.csv"


def test_view_prints_one_document(brake_cal):
    document = parsed(brake_cal("log", RAMP, COAST, "--json"))
    ramp, coast = document["logs"]
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


@pytest.mark.parametrize(
    ("options", "code"),
    [(("--from", 50), 3), (("--from", 5, "--until", 4), 2), (("--from", "1,5"), 2)],
)
def test_a_cut_that_makes_no_sense_writes_nothing(brake_cal, tmp_path, options, code):
    assert brake_cal("log", RAMP, *options, "--out", tmp_path / "cut.csv").code == code
    assert list(tmp_path.iterdir()) == []
