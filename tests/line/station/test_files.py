"""The files of a run: all or none, and none of an earlier run."""

import json

import pytest

from calib.base.write import work_folder
from calib.exports.export import ENDINGS
from calib.line.station.files import DOCUMENT, export_name, publish_run


def put(work, **files):
    listed = [name.replace("_", ".") for name in files]
    for name, text in files.items():
        (work / name.replace("_", ".")).write_text(text)
    (work / DOCUMENT).write_text(json.dumps({"files": listed}))


def test_exports_of_an_earlier_run_go_and_other_files_stay(tmp_path):
    out = tmp_path / "car"
    with work_folder(out) as work:
        put(work, table_dcm="old", report_html="old")
        publish_run(work, out)
    (out / "notes.txt").write_text("mine")
    with work_folder(out) as work:
        put(work, report_html="new")
        paths = publish_run(work, out)
        assert work.parent == out  # on its file system, so that a move is one step
    assert paths[-1] == out / DOCUMENT
    assert {p.name for p in out.iterdir()} == {"notes.txt", "report.html", DOCUMENT}
    assert (out / "report.html").read_text() == "new"
    assert [p.name for p in tmp_path.iterdir()] == ["car"]


@pytest.mark.parametrize("listed", [["../precious"], [3], "x"])
def test_a_listing_cannot_lead_out_of_the_folder(tmp_path, listed):
    out = tmp_path / "car"
    out.mkdir()
    (tmp_path / "precious").write_text("kept")
    (out / DOCUMENT).write_text(json.dumps({"files": listed}))
    with work_folder(out) as work:
        put(work, report_html="new")
        publish_run(work, out)
    assert (tmp_path / "precious").read_text() == "kept"


@pytest.mark.parametrize("verdict", [None, "{"])
def test_an_export_goes_where_no_verdict_lists_it(tmp_path, verdict):
    """As a run leaves it that is killed between the old verdict and the new one."""
    out = tmp_path / "car"
    out.mkdir()
    for name in map(export_name, ENDINGS):
        (out / name).write_text("of an earlier run")
    if verdict is not None:
        (out / DOCUMENT).write_text(verdict)
    with work_folder(out) as work:
        put(work, table_dcm="new")
        publish_run(work, out)
    assert {p.name for p in out.iterdir()} == {"table.dcm", DOCUMENT}
