"""A run leaves all its files or none, if it is killed or the disk is full at any step."""

import fcntl
import os
from pathlib import Path

import pytest

from calib.base.write import locked_folder, publish, work_folder, write_whole
from tests.support.killed import killed

VERDICT = "verdict.json"


def stale_files(out):
    return ["old.txt", "sim/old.csv"]


def run(out, name, content):
    with work_folder(out) as work:
        (work / "sim").mkdir()
        for file in (f"{name}.txt", f"sim/{name}.csv", "both.txt"):
            (work / file).write_text(content)
        (work / VERDICT).write_text(content)
        return publish(work, out, VERDICT, stale_files)


def files(out):
    return {p.relative_to(out).as_posix(): p.read_text() for p in out.rglob("*") if p.is_file()}


def result_of(name, content):
    return dict.fromkeys((f"{name}.txt", f"sim/{name}.csv", "both.txt", VERDICT), content)


def visible_files(out):
    """Files that people see."""
    return {name: text for name, text in files(out).items() if not name.startswith(".")}


@pytest.fixture
def out(tmp_path):
    out = tmp_path / "out"
    run(out, "old", "1")
    (out / "notes").write_text("mine")
    return out


def test_files_of_the_next_run_take_the_place_of_the_earlier_ones(out):
    paths = run(out, "new", "2")
    assert paths[-1] == out / VERDICT
    assert files(out) == {**result_of("new", "2"), "notes": "mine"}


def test_a_kill_at_every_step_leaves_one_run_or_no_verdict(tmp_path):
    outcomes, stopped = set(), True
    for step in range(1000):
        out = tmp_path / str(step)
        run(out, "old", "1")
        stopped = killed(lambda out=out: run(out, "new", "2"), step)
        remaining = visible_files(out)
        whole = result_of("old", "1"), result_of("new", "2")
        assert VERDICT not in remaining or remaining in whole
        outcomes.add(remaining.get(VERDICT))
        run(out, "third", "3")
        assert visible_files(out).items() >= result_of("third", "3").items()
        assert not [p for p in out.iterdir() if p.name.startswith(".")], step
        if not stopped:
            break
    assert step > 20
    assert outcomes == {"1", "2", None}


def test_the_work_of_a_run_that_is_alive_stays(out):
    with work_folder(out) as work:
        (work / "a.txt").write_text("3")
        run(out, "new", "2")
        assert (work / "a.txt").read_text() == "3"


def test_a_run_that_cannot_be_moved_is_undone(out, monkeypatch):
    replace = os.replace

    def full(source, target):
        if Path(target) == out / VERDICT:
            raise OSError(28, "No space left on device")
        replace(source, target)

    monkeypatch.setattr(os, "replace", full)
    with pytest.raises(OSError, match="No space"):
        run(out, "new", "2")
    assert files(out) == {"notes": "mine"}
    assert not (out / "sim").exists()


def test_a_stale_name_cannot_lead_out_of_the_folder(out):
    (out.parent / "victim").write_text("kept")
    with work_folder(out) as work:
        (work / VERDICT).write_text("2")
        publish(work, out, VERDICT, lambda _: ["../victim", str(out.parent / "victim")])
    assert (out.parent / "victim").exists()


@pytest.mark.parametrize("name", ["both.txt", "sim"])
def test_an_obstacle_is_reported_before_anything_is_changed(out, name):
    if name == "sim":
        (out / "sim" / "old.csv").unlink()
        (out / "sim").rmdir()
        (out / "sim").touch()
    else:
        (out / name).unlink()
        (out / name).mkdir()
    previous = files(out)
    with pytest.raises(OSError, match=name):
        run(out, "new", "2")
    assert files(out) == previous


def test_many_writers_of_one_folder_wait_for_each_other(tmp_path):
    """Each child counts in a file; counts are lost if two read and write it at one time."""
    folder, children = tmp_path / "shared", []
    for _ in range(4):
        children.append(os.fork())
        if children[-1] == 0:
            for _ in range(25):
                with locked_folder(folder):
                    count = folder / "count"
                    previous = int(count.read_text()) if count.exists() else 0
                    count.write_text(str(previous + 1))
            os._exit(0)
    for child in children:
        os.waitpid(child, 0)
    assert files(folder) == {"count": "100"}


def test_a_lock_file_that_was_removed_meanwhile_locks_nothing(tmp_path, monkeypatch):
    """A network file system gives a removed file that is open another name."""
    flock, calls = fcntl.flock, []

    def late(handle, operation):
        if not calls:
            (tmp_path / ".lock").rename(tmp_path / ".nfs01")
        calls.append(operation)
        return flock(handle, operation)

    monkeypatch.setattr(fcntl, "flock", late)
    with locked_folder(tmp_path):
        assert (tmp_path / ".lock").exists()
    assert not (tmp_path / ".lock").exists()


def test_is_as_readable_as_any_new_file(tmp_path):
    write_whole(tmp_path / "a", b"")
    (tmp_path / "b").write_bytes(b"")
    assert os.stat(tmp_path / "a").st_mode == os.stat(tmp_path / "b").st_mode


def test_a_failure_leaves_the_old_file_and_no_other(tmp_path, monkeypatch):
    path = tmp_path / "a.bin"
    write_whole(path, b"old")

    def refuse(*_):
        raise OSError("disk full")

    monkeypatch.setattr(os, "replace", refuse)
    with pytest.raises(OSError, match="disk full"):
        write_whole(path, b"new")
    assert path.read_bytes() == b"old"
    assert [p.name for p in tmp_path.iterdir()] == ["a.bin"]
