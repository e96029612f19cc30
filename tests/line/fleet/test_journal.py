"""The journal on disk: rows to the last bit, what a crash leaves, other runs, a full disk."""

import json
import signal
import sqlite3
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.base.errors import BatchError
from calib.line.fleet.journal import NAME, open_journal
from calib.line.fleet.rows import Row, Status

ROOT = Path(__file__).parents[3]
SETTINGS = {"command": "check", "table": "none"}

floats = st.floats(allow_nan=False, allow_infinity=False)
texts = st.text(st.characters(exclude_categories=["Cs"]))
rows = st.builds(
    Row,
    texts,
    st.none() | texts,
    st.sampled_from(Status),
    st.none() | texts,
    st.lists(st.none() | st.booleans() | floats | st.just("named")).map(tuple),
    st.booleans(),
)


def row(log, status=Status.DONE, cells=(0.1,), **more):
    return Row(log, "d" * 64, status, None, cells, **more)


@given(st.lists(rows, unique_by=lambda row: row.log))
def test_rows_come_back_to_the_last_bit(tmp_path_factory, rows):
    folder = tmp_path_factory.mktemp("rows")
    journal = open_journal(folder, SETTINGS)
    journal.add(rows)
    journal.close()
    again = open_journal(folder, SETTINGS)
    back = list(again.rows(row.log for row in rows))
    assert back == rows
    assert [list(map(repr, row.cells)) for row in back] == [list(map(repr, r.cells)) for r in rows]
    assert again.logs() == sorted(row.log for row in rows)
    assert again.counts().total() == len(rows)
    again.close()


@pytest.fixture(scope="module")
def killed(tmp_path_factory):
    """What kill -9 leaves on the disk after five transactions: the file and its unfinished log."""
    home = tmp_path_factory.mktemp("killed")
    journal = open_journal(home, SETTINGS)
    for i in range(5):
        journal.add([row(f"log {i}", cells=(i / 3.0,))])
    found = {path.name: path.read_bytes() for path in home.iterdir()}
    journal.close()
    return found


@given(st.data())
def test_cut_anywhere_it_holds_the_transactions_that_are_whole(tmp_path_factory, killed, data):
    folder = tmp_path_factory.mktemp("cut")
    for name, content in killed.items():
        (folder / name).write_bytes(content)
    pending = folder / f"{NAME}-wal"
    kept = data.draw(st.integers(0, len(killed[pending.name])))
    pending.write_bytes(killed[pending.name][:kept] + data.draw(st.binary(max_size=50)))
    again = open_journal(folder, SETTINGS)
    whole = len(again.logs())
    assert again.logs() == [f"log {i}" for i in range(whole)]
    assert [r.cells for r in again.rows(again.logs())] == [(i / 3.0,) for i in range(whole)]
    assert kept < len(killed[pending.name]) or whole == 5
    again.add([row("one more")])
    again.close()
    last = open_journal(folder, SETTINGS)
    assert len(last.logs()) == whole + 1
    last.close()


def test_the_later_row_of_a_log_counts(tmp_path):
    journal = open_journal(tmp_path, SETTINGS)
    journal.add([row("a", cells=(1.0,)), row("b"), row("a", cells=(2.0,))])
    assert journal.row("a").cells == (2.0,)
    journal.close()
    again = open_journal(tmp_path, SETTINGS)
    assert again.row("a").cells == (2.0,)
    assert again.row("c") is None
    with pytest.raises(KeyError):
        next(again.rows(["c"]))
    again.close()


def test_damage_is_told_and_makes_way_when_asked(tmp_path):
    journal = open_journal(tmp_path, SETTINGS)
    journal.add([row(f"log {i}") for i in range(200)])
    journal.close()
    path = tmp_path / NAME
    content = bytearray(path.read_bytes())
    content[-4096:] = b"rubbish!" * 512
    path.write_bytes(content)
    with pytest.raises(BatchError, match=r"damaged.*--fresh"):
        open_journal(tmp_path, SETTINGS)
    journal = open_journal(tmp_path, SETTINGS, fresh=True)
    assert journal.logs() == []
    journal.close()


def other_database(path):
    db = sqlite3.connect(path)
    db.execute("CREATE TABLE rows (log TEXT)")
    db.commit()
    db.close()


@pytest.mark.parametrize(
    ("name", "make"),
    [
        (NAME, lambda path: path.write_bytes(b"hello\n" * 1000)),
        (NAME, other_database),
    ],
)
def test_what_is_no_journal_is_not_touched_and_makes_way_when_asked(tmp_path, name, make):
    path = tmp_path / name
    make(path)
    content = path.read_bytes()
    with pytest.raises(BatchError, match=r"not the journal.*--fresh"):
        open_journal(tmp_path, SETTINGS)
    assert path.read_bytes() == content
    journal = open_journal(tmp_path, SETTINGS, fresh=True)
    journal.add([row("a")])
    journal.close()
    assert [path.name for path in tmp_path.iterdir()] == [NAME]


def test_fresh_holds_the_new_settings_and_no_row(tmp_path):
    journal = open_journal(tmp_path, SETTINGS)
    journal.add([row("a")])
    journal.close()
    other = {**SETTINGS, "table": "t"}
    open_journal(tmp_path, other, fresh=True).close()
    with pytest.raises(BatchError, match="table t for none"):
        open_journal(tmp_path, SETTINGS)
    journal = open_journal(tmp_path, other)
    assert journal.logs() == []
    journal.close()


@pytest.mark.parametrize("fresh", [False, True])
def test_two_runs_do_not_write_at_once(tmp_path, fresh):
    journal = open_journal(tmp_path, SETTINGS)
    journal.add([row("a")])
    with pytest.raises(BatchError, match="another run"):
        open_journal(tmp_path, SETTINGS, fresh)
    code = (
        "import sys; from pathlib import Path; from calib.line.fleet.journal import open_journal; "
        f"open_journal(Path(sys.argv[1]), {SETTINGS}, {fresh})"
    )
    ran = subprocess.run(
        [sys.executable, "-c", code, tmp_path], cwd=ROOT, capture_output=True, text=True
    )
    assert "another run uses this folder" in ran.stderr
    assert journal.logs() == ["a"]
    journal.close()
    open_journal(tmp_path, SETTINGS).close()


def test_a_journal_of_another_folder_that_tells_more_is_refused(tmp_path):
    open_journal(tmp_path, {**SETTINGS, "folder": "/bench"}).close()
    with pytest.raises(BatchError, match="folder /bench for none"):
        open_journal(tmp_path, SETTINGS)


# No file of this process may grow beyond 200 kB, as on a disk that is nearly full.
NEARLY_FULL = """
import json, resource, signal, sys
from pathlib import Path
from calib.line.fleet.journal import open_journal
from calib.line.fleet.rows import Row
from calib.line.fleet.rows import Status

signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, 200_000))
journal = open_journal(Path(sys.argv[1]), json.loads(sys.argv[2]))
kept = 0
try:
    while True:
        journal.add([Row(f"log {kept:05d}", None, Status.DONE, "e" * 1000)])
        kept += 1
except OSError as error:
    print(kept, error.strerror)
"""


@pytest.mark.skipif(not hasattr(signal, "SIGXFSZ"), reason="no limit of file sizes")
def test_a_disk_that_is_full_is_told_and_loses_no_row_that_was_kept(tmp_path):
    ran = subprocess.run(
        [sys.executable, "-c", NEARLY_FULL, tmp_path, json.dumps(SETTINGS)],
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    kept, _, why = ran.stdout.partition(" ")
    assert int(kept) > 10, ran.stderr
    assert why.strip()
    journal = open_journal(tmp_path, SETTINGS)
    assert journal.logs() == [f"log {i:05d}" for i in range(int(kept))]
    journal.close()


def test_a_folder_that_cannot_be_written_is_told_as_such(tmp_path):
    (tmp_path / NAME).mkdir()
    with pytest.raises(OSError, match="Is a directory"):
        open_journal(tmp_path, SETTINGS)
