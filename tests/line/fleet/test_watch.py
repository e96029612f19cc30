"""Watch a folder by the clock of the test, which changes the folder between two scans."""

import os
from functools import partial
from pathlib import Path
from threading import Event

import pyarrow.parquet as pq
import pytest

from calib.line.fleet.batch import run_batch
from calib.line.fleet.watch import watch
from tests.support.fleet_logs import Here, validating

RESULTS = Path("out/results.parquet")


class Bench(Event):
    """Do one of ``acts`` between two scans, and end the watch after the last one."""

    def __init__(self, *acts):
        super().__init__()
        self.acts, self.time = list(acts), 0.0

    def wait(self, timeout=None):
        self.time += timeout
        if self.acts:
            self.acts.pop(0)()
        else:
            self.set()
        return self.is_set()


def idle():
    pass


@pytest.fixture
def watched(fitted, tmp_path, monkeypatch):
    """Watch ``in`` while a bench acts; return rows, names done, errors and counts."""
    monkeypatch.chdir(tmp_path)
    Path("in").mkdir()

    def run(*acts):
        bench, rows, errors, executor = Bench(*acts), [], [], Here()
        how = validating(fitted), Path("in"), Path("out"), executor
        counts = watch(*how, bench, rows.append, errors.append, clock=lambda: bench.time)
        return rows, executor.done, errors, counts

    return run


def dropped(name, data):
    def act():
        Path("in", name).write_bytes(data)

    return act


def test_rows_are_those_of_a_batch(watched, six, fitted, monkeypatch):
    acts = [dropped(path.name, path.read_bytes()) for path in sorted(Path(six).iterdir())]
    rows, names, _, counts = watched(*acts, *[idle] * 5)
    assert len(rows) == len(names) == 6
    monkeypatch.chdir("in")
    batch = run_batch(validating(fitted), ["*.csv"], Path("../batch"), Here())
    assert counts == batch.counts
    monkeypatch.chdir("..")
    assert pq.read_table(RESULTS).equals(pq.read_table("batch/results.parquet"))


def test_a_log_that_changes_is_done_again_and_one_taken_away_keeps_its_row(watched, six):
    first, other = (Path(six, f"car_0000{i}.csv").read_bytes() for i in (0, 2))
    changes = [dropped("a.csv", first), *[idle] * 4, dropped("a.csv", other), *[idle] * 4]
    rows, *_ = watched(*changes, Path("in/a.csv").unlink, idle)
    assert [row.log for row in rows] == ["a.csv", "a.csv"]
    assert rows[0].digest != rows[1].digest
    (row,) = pq.read_table(RESULTS).to_pylist()
    assert row["digest"] == rows[1].digest


def test_a_folder_that_is_away_for_a_while_is_told_once(watched, six):
    data = Path(six, "car_00000.csv").read_bytes()
    away, back = partial(os.rename, "in", "gone"), partial(os.rename, "gone", "in")
    rows, _, errors, _ = watched(
        away, idle, idle, back, dropped("a.csv", data), *[idle] * 4, away, idle
    )
    assert [row.log for row in rows] == ["a.csv"]
    assert len(errors) == 2
    assert "in" in errors[0]
