"""`brake-cal fleet report` as the shell runs it."""

import json
import os

import pyarrow as pa
import pytest

from tests.support.fleet_results import results


def test_a_report_is_written_and_told(brake_cal, tmp_path):
    path, out = results(tmp_path / "r.parquet"), tmp_path / "out"
    ran = brake_cal("fleet", "report", path, "--figure", "pad_friction_f", "--out", out)
    assert ran.code == 0, ran.err
    assert ran.out.startswith("Pad friction, front drifts; ")
    assert "line/car134.csv stands apart: Pad friction, front 0.550" in ran.out
    assert "3 x line/car14.csv: <b>ends</b> at " in ran.out
    assert sorted(p.name for p in out.iterdir()) == [
        "fleet.json",
        "pad_friction_f.png",
        "report.html",
    ]
    assert json.loads((out / "fleet.json").read_text())["logs"] == 400


def test_copies_of_a_recording_are_told(brake_cal, tmp_path):
    digests = ([*"abacbbd", None], pa.string(), None)
    path = results(tmp_path / "r.parquet", 8, extra={"digest": digests})
    out = tmp_path / "out"
    ran = brake_cal("fleet", "report", path, "--figure", "settling", "--out", out)
    assert "one recording, counted 2 times: line/car1.csv, line/car3.csv\n" in ran.out
    assert "counted 3 times: line/car2.csv, line/car5.csv, line/car6.csv\n" in ran.out
    assert len(json.loads((out / "fleet.json").read_text())["copies"]) == 2
    assert "line/car1.csv, line/car3.csv" in (out / "report.html").read_text()


def test_a_folder_whose_name_is_not_utf8_is_a_title(brake_cal, tmp_path):
    made = results(tmp_path / "r.parquet", 12)
    folder = tmp_path / os.fsdecode(b"fr\xfch")
    folder.mkdir()
    made.rename(folder / made.name)
    ran = brake_cal("fleet", "report", folder / made.name, "--out", tmp_path / "out")
    assert ran.code == 0, ran.err
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "<h1>fr\\udcfch/r.parquet</h1>" in page


def test_json_is_one_document_and_says_the_order(brake_cal, tmp_path):
    path = results(tmp_path / "r.parquet", 12)
    ran = brake_cal("fleet", "report", path, "--order", "built", "--json")
    told = json.loads(ran.out)
    assert told["ordered_by"] == "built"
    assert set(told["figures"]) == {"pad_friction_f", "settling", "built"}


@pytest.mark.parametrize(
    ("more", "code", "says"),
    [
        (("--figure", "pad_fricton_f"), 3, "did you mean 'pad_friction_f'"),
        (("--order", "biult"), 3, "did you mean 'built'"),
        (("--ordre", "built"), 2, "No such option"),
    ],
)
def test_mistakes(brake_cal, tmp_path, more, code, says):
    ran = brake_cal("fleet", "report", results(tmp_path / "r.parquet", 5), *more)
    assert (ran.code, ran.result) == (code, "")
    assert says in ran.err


def test_bad_files_and_places(brake_cal, tmp_path):
    assert brake_cal("fleet", "report", tmp_path / "none.parquet").code == 3
    path = results(tmp_path / "r.parquet", 5)
    ran = brake_cal("fleet", "report", path, "--out", path)
    assert (ran.code, ran.result) == (2, "")


def test_an_earlier_picture_does_not_stay(brake_cal, tmp_path):
    path, out = results(tmp_path / "r.parquet"), tmp_path / "out"
    assert brake_cal("fleet", "report", path, "--out", out).code == 0
    (out / "mine.png").touch()
    ran = brake_cal("fleet", "report", path, "--figure", "settling", "--out", out)
    assert ran.code == 0
    assert {p.name for p in out.glob("*.png")} == {"settling.png", "mine.png"}


def test_what_orders_the_line_does_not_drift(brake_cal, tmp_path):
    path = results(tmp_path / "r.parquet")
    told = json.loads(brake_cal("fleet", "report", path, "--order", "built", "--json").out)
    assert told["figures"]["built"]["change"] is None
    assert told["figures"]["pad_friction_f"]["change"] is not None


def test_an_index_of_no_run_is_a_page_and_a_document(brake_cal, document, tmp_path):
    ran = brake_cal("fleet", "index", tmp_path)
    assert (ran.code, ran.out) == (0, f"0 runs; {tmp_path / 'index.html'}\n")
    found = document(brake_cal("fleet", "index", tmp_path, "--json"))
    files = [tmp_path / name for name in ("index.html", "live.html")]
    assert found == {"schema": 1, "runs": 0, "files": list(map(str, files))}
    assert all(path.is_file() for path in files)
    assert brake_cal("fleet", "index", tmp_path / "none").code == 2
