"""The index of a folder of runs: last cars first, and only new runs are read."""

import os

import pytest

from calib.base.plain import METRICS
from calib.line.station import index
from calib.line.station.files import to_dict, to_text
from calib.show.station_index import index_facts, write_index


@pytest.fixture
def folder(outcome, stored, tmp_path):
    document = to_dict(outcome, stored, [])
    for i in range(3):
        (tmp_path / f"day/car-{i}").mkdir(parents=True)
        document["identity"] = {"serial": f"<b>{i}"}
        document["figures"]["pad_scale"] = 1.0 + 0.01 * i
        path = tmp_path / f"day/car-{i}" / "station.json"
        path.write_text(to_text(document))
        os.utime(path, (1000.0 + i, 1000.0 + i))
    return tmp_path


def test_the_last_car_is_first_with_its_verdict_and_next_step(folder):
    assert write_index(folder) == 3
    page = (folder / "index.html").read_text()
    assert page.index("&lt;b&gt;2") < page.index("&lt;b&gt;1") < page.index("&lt;b&gt;0")
    assert "Failed" in page
    assert METRICS["pad_scale"].action[:20] in page
    assert 'href="day/car-2/report.html"' in page
    assert 'http-equiv="refresh"' not in page
    assert 'http-equiv="refresh" content="10"' in (folder / "live.html").read_text()
    assert page.count("image/svg+xml") == 4
    assert "102.0" in page  # the last pad scale


def test_failed_runs_stand_on_top_of_the_recent_ones(folder):
    """Of six runs, from the newest: passed, failed, warning, damaged, failed, refused."""
    verdicts = ("passed", "failed", "warning", index.UNREADABLE, "failed", index.NO_VERDICT)
    runs = [index.IndexedRun(f"car-{i}", 10.0 - i, word) for i, word in enumerate(verdicts)]
    facts = index_facts(runs, "line")
    assert facts.word == "car-0: Passed"  # the last car is the headline
    assert [row[0] for row in facts.tables[0].rows] == [f"car-{i}" for i in (1, 3, 4, 5, 2, 0)]
    assert facts.tables[0].links[3] == ""  # a refused car has no report


def test_a_damaged_run_is_shown(folder):
    (folder / "day/car-1/station.json").write_text("{")
    (folder / "day/car-2/refused.json").write_text('{"identity": {}, "error": 3}')
    verdicts = sorted(run.verdict for run in index.runs_below(folder))
    assert verdicts == ["failed", index.UNREADABLE, index.UNREADABLE]


def test_a_folder_without_a_run(tmp_path):
    assert write_index(tmp_path) == 0
    assert "No run yet" in (tmp_path / "index.html").read_text()
