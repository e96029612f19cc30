"""All or nothing, and nothing stale."""

import json
import os

import pytest

from calib.base.publish import workshop
from calib.exports.export import ENDINGS
from calib.line.station.folder import DOCUMENT, EXPORTS, export_name, publish_run


def put(work, **files):
    listed = [name.replace("_", ".") for name in files]
    for name, text in files.items():
        (work / name.replace("_", ".")).write_text(text)
    (work / DOCUMENT).write_text(json.dumps({"files": listed}))


def test_exports_of_an_earlier_run_go_and_other_files_stay(tmp_path):
    out = tmp_path / "car"
    with workshop(out) as work:
        put(work, table_dcm="old", report_html="old")
        publish_run(work, out)
    (out / "notes.txt").write_text("mine")
    with workshop(out) as work:
        put(work, report_html="new")
        paths = publish_run(work, out)
        assert work.parent == out  # on its file system, so that a move is one step
    assert paths[-1] == out / DOCUMENT
    assert {p.name for p in out.iterdir()} == {"notes.txt", "report.html", DOCUMENT}
    assert (out / "report.html").read_text() == "new"
    assert [p.name for p in tmp_path.iterdir()] == ["car"]


@pytest.mark.parametrize("listed", [["../precious"], ["/etc/passwd"], [3], "x", None])
def test_a_listing_cannot_lead_out_of_the_folder(tmp_path, listed):
    out = tmp_path / "car"
    out.mkdir()
    (tmp_path / "precious").write_text("kept")
    (out / DOCUMENT).write_text(json.dumps({"files": listed}))
    with workshop(out) as work:
        put(work, report_html="new")
        publish_run(work, out)
    assert (tmp_path / "precious").read_text() == "kept"


def test_a_move_that_fails_leaves_no_verdict(tmp_path, monkeypatch):
    out, moved, move = tmp_path / "car", [], os.replace

    def failing(source, target):
        if target == out / "b.txt":
            raise OSError(28, "no space left")
        moved.append(target)
        move(source, target)

    monkeypatch.setattr(os, "replace", failing)
    with workshop(out) as work:
        put(work, a_txt="1", b_txt="2")
        with pytest.raises(OSError, match="no space"):
            publish_run(work, out)
    assert out / "a.txt" in moved
    assert not out.exists()


def test_files_moved_before_a_failure_go_and_others_stay(tmp_path):
    out = tmp_path / "car"
    (out / "b.txt").mkdir(parents=True)  # a file cannot take its place
    (out / "notes.txt").write_text("mine")
    with workshop(out) as work:
        put(work, a_txt="1", b_txt="2")
        with pytest.raises(OSError, match=r"b\.txt"):
            publish_run(work, out)
    assert {p.name for p in out.iterdir()} == {"notes.txt", "b.txt"}


@pytest.mark.parametrize("verdict", [None, "{", '{"files": []}'])
def test_an_export_goes_where_no_verdict_lists_it(tmp_path, verdict):
    """As a version without intents left it: killed between the old verdict and the new one."""
    out = tmp_path / "car"
    out.mkdir()
    for name in EXPORTS:
        (out / name).write_text("of an earlier run")
    if verdict is not None:
        (out / DOCUMENT).write_text(verdict)
    with workshop(out) as work:
        put(work, table_dcm="new")
        publish_run(work, out)
    assert {p.name for p in out.iterdir()} == {"table.dcm", DOCUMENT}


def test_every_format_has_an_export_that_goes():
    assert {export_name(form) for form in ENDINGS} == EXPORTS
    assert len(EXPORTS) == len(ENDINGS)


def stopped(out):
    with workshop(out) as work:
        put(work, a_txt="1")
        raise KeyboardInterrupt


@pytest.mark.parametrize("there", [True, False])
def test_work_that_fails_leaves_the_folder_as_it_was(tmp_path, there):
    out = tmp_path / "car"
    if there:
        out.mkdir()
    with pytest.raises(KeyboardInterrupt):
        stopped(out)
    assert [p.name for p in tmp_path.rglob("*")] == (["car"] if there else [])
