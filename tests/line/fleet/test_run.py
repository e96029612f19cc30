"""A batch in this process: rows, what is done again and what is not, and who is guilty."""

import os
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from calib.base.errors import BatchError, LogError
from calib.estimation.limits import Limit
from calib.estimation.metrics import METRICS
from calib.estimation.validate import validate_one
from calib.line.fleet.batch import AHEAD, run_batch
from calib.line.fleet.journal import NAME, BatchJournal
from calib.line.fleet.work import Job, run_items
from calib.logs.channel_map import ChannelMap, DatabaseFile, Mapping
from calib.logs.read import read_log
from calib.logs.text.dialect import TextFormat
from tests.support.fleet_logs import Here, many, validating


@pytest.fixture
def job(fitted):
    return validating(fitted)


def rows_of(done):
    return pq.read_table(done.results).to_pylist()


def test_rows_are_those_of_validate_to_the_last_bit(job, six):
    done = run_batch(job, [six], Path("out"), Here())
    rows = rows_of(done)
    assert done.counts == {"error": 2, "passed": 4}
    assert [row["log"] for row in rows] == [f"logs/car_{i:05d}.csv" for i in range(6)]
    for row in rows:
        log = read_log(Path(row["log"]))
        assert row["digest"] == log.digest
        if row["status"] == "passed":
            alone = validate_one(job.table, log, None, job.limits).figures
            assert {name: row[name] for name in METRICS} == alone
        else:
            assert "steady rolling" in row["error"]
            assert row["error"].startswith(row["log"])
            assert all(row[name] is None for name in METRICS)


def test_a_second_run_does_nothing_again(job, six):
    first = run_batch(job, [six], Path("out"), Here())
    content, journal = first.results.read_bytes(), Path("out", NAME).read_bytes()
    again = run_batch(job, [six], Path("out"), Here())
    assert (again.pace.fresh, again.pace.done) == (0, 6)
    assert again.counts == first.counts
    assert again.results.read_bytes() == content
    assert Path("out", NAME).read_bytes() == journal


def test_only_a_log_that_changed_or_is_new_is_done_again(job, six, stops):
    run_batch(job, [six], Path("out"), Here())
    changed = Path("logs/car_00002.csv")
    changed.write_bytes(Path("logs/car_00000.csv").read_bytes())
    Path("logs/new.csv").write_bytes(Path("logs/car_00001.csv").read_bytes())
    Path("logs/car_00005.csv").unlink()
    done = run_batch(job, [six], Path("out"), Here())
    assert done.pace.fresh == 2
    rows = {row["log"]: row["status"] for row in rows_of(done)}
    assert rows[str(changed)] == "passed"
    assert "logs/new.csv" in rows
    assert "logs/car_00005.csv" not in rows


def test_other_settings_are_refused_and_begin_anew_when_asked(job, fitted, six):
    run_batch(job, [six], Path("out"), Here())
    before = Path("out/results.parquet").read_bytes()
    strict = type(job)("validate", table=fitted, limits=(Limit("interval_f", None, 1e-6),))
    with pytest.raises(BatchError, match=r"limits .* --fresh"):
        run_batch(strict, [six], Path("out"), Here())
    assert Path("out/results.parquet").read_bytes() == before
    done = run_batch(strict, [six], Path("out"), Here(), fresh=True)
    assert done.counts == {"error": 2, "failed": 4}
    assert done.pace.fresh == 6


def test_a_log_that_kills_its_worker_is_a_row_and_the_rest_goes_on(job, six):
    whole = rows_of(run_batch(job, [six], Path("whole"), Here()))
    executor = Here(lambda name: name.endswith("3.csv"))
    rows = rows_of(run_batch(job, [six], Path("out"), executor))
    assert [row["status"] for row in rows].count("error") == 3
    bad = rows.pop(3)
    assert "died on it twice" in bad["error"]
    assert bad["digest"] is None
    del whole[3]
    assert rows == whole
    assert executor.renewed == 2
    # the next run tries it again
    done = run_batch(job, [six], Path("out"), Here())
    assert done.pace.fresh == 1
    assert Path("out/results.parquet").read_bytes() == Path("whole/results.parquet").read_bytes()


def test_two_patterns_that_name_a_log_give_one_row(job, six):
    done = run_batch(job, [six, "logs/*.csv", "logs/car_00000.csv"], Path("out"), Here())
    assert (done.counts.total(), done.pace.done, done.pace.total) == (6, 6, 6)


def test_what_cannot_be_read_is_a_row_without_digest_and_not_journalled_twice(job, six):
    arguments = [six, "logs/missing.csv"]
    done = run_batch(job, arguments, Path("out"), Here())
    row = rows_of(done)[-1]
    assert (row["log"], row["digest"], row["status"]) == ("logs/missing.csv", None, "error")
    journal = Path("out", NAME).read_bytes()
    run_batch(job, arguments, Path("out"), Here())
    assert Path("out", NAME).read_bytes() == journal


def test_few_logs_are_under_way_at_a_time(job, sixty, tmp_path):
    class Counting(ThreadPoolExecutor):
        workers, most = 2, 0

        def submit(self, packed, items):
            future = super().submit(run_items, packed, items)
            under_way.add(future)
            future.add_done_callback(under_way.discard)
            type(self).most = max(self.most, len(under_way))
            return future

    under_way = set()
    with Counting(2) as executor:
        done = run_batch(job, [str(sixty)], tmp_path / "out", executor)
    assert done.counts.total() == 60
    assert Counting.most <= AHEAD * Counting.workers


def test_nothing_is_left_where_no_log_is_found(job, tmp_path):
    with pytest.raises(LogError, match="no log found"):
        run_batch(job, [str(tmp_path)], tmp_path / "out", Here())
    assert not (tmp_path / "out").exists()


def test_a_worker_of_another_version_ends_the_run(job, six, fitted):
    other = type(job)("validate", table=fitted, limits=job.limits, version="0.0.0")
    with pytest.raises(BatchError, match="a worker runs"):
        run_batch(other, [six], Path("out"), Here())


def test_a_name_that_is_not_utf8_is_a_row(job, tmp_path, stops):
    many(tmp_path / "logs", stops, 1)
    name = os.fsdecode(b"r\xfcck.csv")
    os.rename(tmp_path / "logs/car_00000.csv", tmp_path / "logs" / name)
    done = run_batch(job, [str(tmp_path / "logs")], tmp_path / "out", Here())
    assert done.counts == {"passed": 1}
    assert rows_of(done)[0]["log"].endswith("r\\udcfcck.csv")


def test_a_full_disk_is_told_and_no_log_is_done_twice(job, six, monkeypatch):
    executor = Here()

    def full(self, rows):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(BatchJournal, "add", full)
    with pytest.raises(OSError, match="No space"):
        run_batch(job, [six], Path("out"), executor)
    assert executor.renewed == 0
    assert len(set(executor.done)) == len(executor.done)


def test_the_row_of_a_log_says_why_it_cannot_be_read_now(job, six):
    arguments = [six, "logs/late.csv"]
    run_batch(job, arguments, Path("out"), Here())
    os.mkfifo("logs/late.csv")
    row = rows_of(run_batch(job, arguments, Path("out"), Here()))[-1]
    assert "a device, socket or pipe" in row["error"]


def test_a_log_for_which_memory_is_short_is_tried_again(job, six, monkeypatch):
    def short(*arguments, **told):
        raise MemoryError

    with monkeypatch.context() as patched:
        patched.setattr("calib.line.fleet.work.log_of", short)
        done = run_batch(job, ["logs/car_00000.csv"], Path("out"), Here())
    assert "not enough memory" in rows_of(done)[0]["error"]
    again = run_batch(job, ["logs/car_00000.csv"], Path("out"), Here())
    assert (again.pace.fresh, again.counts) == (1, {"passed": 1})


MAPS = (
    {"channels": {"p_mc": Mapping("p")}},
    {"channels": {"p_mc": Mapping("p", unit="bar")}},
    {"text": TextFormat(decimal=",")},
    {"ignore": ("v",)},
    {"j1939": ()},
    {"buses": ("a.dbc",)},
    {"dbc": "chassis"},
    {"dbc": None},
)


def test_all_that_a_channel_map_says_is_a_setting(tmp_path):
    bus = tmp_path / "a.dbc"
    bus.write_text("VERSION 1")

    def settings(**told):
        told = {"channels": {}, **told}
        if "dbc" in told:
            told["dbc"] = (DatabaseFile(bus, told["dbc"]),)
        if "buses" in told:
            told["buses"] = (("1", (DatabaseFile(bus),)),)
        return Job("check", channel_map=ChannelMap("m.toml", **told)).settings()["map"]

    found = [settings(), *(settings(**told) for told in MAPS)]
    bus.write_text("VERSION 2")
    found.append(settings(**MAPS[-1]))
    assert len(set(found)) == len(found) == 10
