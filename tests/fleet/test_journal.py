"""The journal on disk: torn lines, later rows, other runs."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.errors import BatchError
from calib.fleet.journal import NAME, open_journal
from calib.fleet.results_file import STATUSES
from calib.fleet.row import Row, from_line, to_line

SETTINGS = {"command": "check", "table": "none"}

floats = st.floats(allow_nan=False, allow_infinity=False)
rows = st.builds(
    Row,
    st.text(st.characters(exclude_categories=["Cs"]), min_size=1),
    st.none() | st.text(st.characters(exclude_categories=["Cs"])),
    st.sampled_from(STATUSES),
    st.none() | st.text(st.characters(exclude_categories=["Cs"])),
    st.lists(st.none() | st.booleans() | floats | st.just("named")).map(tuple),
    st.booleans(),
)


def row(log, status="done", cells=(0.1,), **more):
    return Row(log, "d" * 64, status, None, cells, **more)


@given(rows)
def test_a_row_comes_back_from_its_line_to_the_last_bit(row):
    line = to_line(row)
    assert from_line(line) == row
    assert line.count(b"\n") == 1


@given(rows, st.data())
def test_no_part_of_a_line_is_a_row(row, data):
    line = to_line(row)
    part = line[: data.draw(st.integers(0, len(line) - 1))]
    with pytest.raises((ValueError, TypeError)):
        from_line(part)


@given(kept=st.integers(0, 10_000))
def test_cut_anywhere_it_holds_the_rows_that_are_whole(tmp_path_factory, kept):
    folder = tmp_path_factory.mktemp("cut")
    journal = open_journal(folder, SETTINGS)
    journal.add([row(f"log {i}", cells=(i / 3.0,)) for i in range(5)])
    journal.close()
    content = (folder / NAME).read_bytes()[:kept]
    (folder / NAME).write_bytes(content)
    again = open_journal(folder, SETTINGS)
    whole = max(content.count(b"\n") - 1, 0)
    assert list(again.entries) == [f"log {i}" for i in range(whole)]
    again.add([row("one more")])
    names = [r.log for r in again.rows([*again.entries])]
    assert names == [*(f"log {i}" for i in range(whole)), "one more"]
    again.close()
    lines = (folder / NAME).read_bytes().splitlines()
    assert [json.loads(line)[0] for line in lines[1:]] == names


def test_the_later_row_of_a_log_counts(tmp_path):
    journal = open_journal(tmp_path, SETTINGS)
    journal.add([row("a", cells=(1.0,)), row("b"), row("a", cells=(2.0,))])
    assert [r.cells for r in journal.rows(["a"])] == [(2.0,)]
    journal.close()
    again = open_journal(tmp_path, SETTINGS)
    assert [r.cells for r in again.rows(["a"])] == [(2.0,)]
    again.close()


def test_a_damaged_line_in_the_middle_is_told(tmp_path):
    journal = open_journal(tmp_path, SETTINGS)
    journal.add([row("a"), row("b")])
    journal.close()
    lines = (tmp_path / NAME).read_bytes().splitlines(keepends=True)
    (tmp_path / NAME).write_bytes(lines[0] + b"rubbish\n" + lines[2])
    with pytest.raises(BatchError, match=r"no row.*--fresh"):
        open_journal(tmp_path, SETTINGS)


@pytest.mark.parametrize("content", [b"hello\n", b"[1]\n", b'{"schema": 2, "settings": {}}\n'])
def test_what_is_no_journal_is_not_touched(tmp_path, content):
    (tmp_path / NAME).write_bytes(content)
    with pytest.raises(BatchError, match="not the journal"):
        open_journal(tmp_path, SETTINGS)
    assert (tmp_path / NAME).read_bytes() == content


def test_two_runs_do_not_write_at_once(tmp_path):
    pytest.importorskip("fcntl")
    journal = open_journal(tmp_path, SETTINGS)
    with pytest.raises(BatchError, match="another run"):
        open_journal(tmp_path, SETTINGS)
    journal.close()
    open_journal(tmp_path, SETTINGS).close()


def test_a_journal_of_another_folder_that_tells_more_is_refused(tmp_path):
    open_journal(tmp_path, {**SETTINGS, "folder": "/bench"}).close()
    with pytest.raises(BatchError, match="folder /bench for none"):
        open_journal(tmp_path, SETTINGS)


def test_a_disk_that_fails_at_the_end_leaves_the_file_closed(tmp_path, monkeypatch):
    journal = open_journal(tmp_path, SETTINGS)

    def full():
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(journal, "sync", full)
    with pytest.raises(OSError, match="No space"):
        journal.close()
    open_journal(tmp_path, SETTINGS).close()  # the lock is free again
