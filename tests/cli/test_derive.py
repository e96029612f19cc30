"""`brake-cal tables derive`, and what show, diff and every export say of it."""

import pytest

from calib.store.store import Store
from calib.table.table import BY_HAND

WHY = ("--reason", "seen on the bench", "--by", "A. Smith")


@pytest.fixture
def derived(tables):
    """Run a command on a store with sedan@2, whose front pad and one row were set by hand."""
    words = ("--set", "pad_friction_f=0.41", "--set", "D[1.0025]=0.08")
    ran = tables("derive", "sedan@1", *words, *WHY)
    assert ran.code == 0, ran.err
    return tables


def test_what_was_set_and_what_moved_is_told(tables, store, document):
    ran = tables("derive", "sedan@1", "--set", "f1[1.0025]=0.03", *WHY)
    assert ran.code == 0
    said = ran.out.splitlines()
    assert said[0].startswith("f1[1.0025] set by hand to 0.03 from 0.025")
    assert said[0].endswith(", by A. Smith: seen on the bench")
    assert said[1].startswith("D[1.0025] moved along to 0.0791")
    assert said[2].startswith("f2[1.0025] moved along to -0.0491")
    assert said[-1] == "stored sedan@2, derived from sedan@1"
    assert Store(store).load("sedan@2").table.difference.flag[10] == BY_HAND


def test_the_document(tables, document):
    told = document(tables("derive", "sedan", "--set", "pad_friction_r=0.37", *WHY, "--json"))
    assert told["id"] == "sedan@2"
    assert told["parent"]["id"] == "sedan@1"
    assert told["set"] == [
        {"key": "pad_friction_r", "old": 0.39, "new": 0.37, "reason": WHY[1], "by": WHY[3]}
    ]
    assert [moved["key"] for moved in told["moved"]] == ["pad_scale", "pad_log_ratio"]


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (("--set", "mass=1700", *WHY), "'mass' cannot be set"),
        (("--set", "D[1.0026]=0.05", *WHY), "the nearest rows are at 1.0025 and 1.00275"),
        (("--set", "pad_friction_f=0", *WHY), "has no meaning for pad_friction_f"),
        (("--set", "pad_friction_f=0.4", *WHY), "is 0.4 already"),
        (("--set", "pad_friction_f=0.41", "--reason", ""), "no reason was given"),
        (("--set", "pad_friction_f=0.41"), "Missing option '--reason'"),
        (WHY, "Missing option '--set'"),
    ],
)
def test_what_cannot_be_set_ends_with_2_and_stores_nothing(tables, store, words, says):
    ran = tables("derive", "sedan@1", *words)
    assert (ran.code, ran.result) == (2, "")
    assert says in ran.err
    assert [entry.id for entry in Store(store).list()] == ["sedan@1"]


def test_show_and_diff_say_what_was_set(derived, document):
    said = "D[1.0025] set by hand to 0.08 from 0.0675, by A. Smith: seen on the bench"
    assert said in derived("show", "sedan@2").out
    assert f"sedan@2: {said}" in derived("diff", "sedan@1", "sedan@2").out
    told = document(derived("diff", "sedan@1", "sedan@2", "--json"))["by_hand"]
    assert told["a"] == []
    assert [one["key"] for one in told["b"]] == ["pad_friction_f", "D[1.0025]"]


@pytest.mark.parametrize(
    "form", ["json", "csv", "parquet", "dcm", "cdfx", "a2l", "c-header", "inca-csv"]
)
def test_every_export_marks_what_was_set(derived, tmp_path, form):
    before, after = (tmp_path / f"{n}.{form}" for n in (1, 2))
    for n, out in ((1, before), (2, after)):
        assert (
            derived("export", f"sedan@{n}", "--unreleased", "--format", form, "--out", out).code
            == 0
        )
    assert b"set by hand" not in before.read_bytes()
    written = after.read_bytes()
    assert b"pad_friction_f set by hand to 0.41 from 0.4" in written
    assert b"seen on the bench" in written
    if form != "inca-csv":  # it has no place for the meaning of an object
        assert b"D = F_f - F_r, 1 row set by hand" in written
        assert b"front pad friction set by hand" in written
    if form in ("dcm", "cdfx"):
        assert derived("import", after).code == 0


def test_the_flag_of_the_cells_is_in_the_columns(derived, tmp_path):
    derived("export", "sedan@2", "--unreleased", "--format", "csv", "--out", tmp_path / "t.csv")
    rows = [
        line.split(",") for line in (tmp_path / "t.csv").read_text().splitlines() if line[0] != "#"
    ]
    flag = rows[0].index("flag")
    marked = [(row[0], row[2]) for row in rows[1:] if row[flag] == "3.0"]
    assert marked == [(f"sedan_{name}", "1.0025") for name in ("f1", "f2", "D")]


def test_the_history_of_a_cdfx_says_it_too(derived, tmp_path):
    derived("export", "sedan@2", "--unreleased", "--format", "cdfx", "--out", tmp_path / "t.cdfx")
    text = (tmp_path / "t.cdfx").read_text()
    assert text.count("<P>set by hand; ") == 1
    assert text.count("<P>fitted, then set by hand in part; ") == 3


def test_it_can_be_drawn(derived, brake_cal, store, tmp_path):
    ran = brake_cal("plot", "sedan@2", "--store", store, "--out", tmp_path / "t.svg")
    assert ran.code == 0, ran.err
    assert "set by hand" in (tmp_path / "t.svg").read_text()
