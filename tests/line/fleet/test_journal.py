"""The journal on the disk: exact rows, a crash, another run, a full disk."""

import json
import signal
import sqlite3
import subprocess
import sys
from contextlib import closing
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.base.errors import BatchError
from calib.line.fleet.journal import NAME, BatchJournal
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


def opened(folder, **settings):
    return closing(BatchJournal(folder, SETTINGS | settings))


def row(log, cells=(0.1,)):
    return Row(log, "d" * 64, Status.DONE, None, cells)


@given(st.lists(rows, unique_by=lambda row: row.log))
def test_rows_come_back_to_the_last_bit(tmp_path_factory, rows):
    folder = tmp_path_factory.mktemp("rows")
    with opened(folder) as journal:
        journal.add(rows)
    with opened(folder) as again:
        back = list(again.rows(row.log for row in rows))
        assert list(map(repr, back)) == list(map(repr, rows))
        assert again.logs() == sorted(row.log for row in rows)
        assert again.counts().total() == len(rows)


@pytest.fixture(scope="module")
def killed(tmp_path_factory):
    """What kill -9 leaves on the disk after five transactions: the file and its unfinished log."""
    home = tmp_path_factory.mktemp("killed")
    with opened(home) as journal:
        for i in range(5):
            journal.add([row(f"log {i}", (i / 3.0,))])
        return {path.name: path.read_bytes() for path in home.iterdir()}


@given(st.data())
def test_cut_anywhere_it_holds_the_transactions_that_are_whole(tmp_path_factory, killed, data):
    folder = tmp_path_factory.mktemp("cut")
    for name, content in killed.items():
        (folder / name).write_bytes(content)
    pending = folder / f"{NAME}-wal"
    stored = data.draw(st.integers(0, len(killed[pending.name])))
    pending.write_bytes(killed[pending.name][:stored] + data.draw(st.binary(max_size=50)))
    with opened(folder) as again:
        whole = len(again.logs())
        assert again.logs() == [f"log {i}" for i in range(whole)]
        assert [r.cells for r in again.rows(again.logs())] == [(i / 3.0,) for i in range(whole)]
        assert stored < len(killed[pending.name]) or whole == 5
        again.add([row("one more")])
    with opened(folder) as last:
        assert len(last.logs()) == whole + 1


def damaged(path):
    with opened(path.parent) as journal:
        journal.add([row(f"log {i}") for i in range(200)])
    path.write_bytes(path.read_bytes()[:-4096] + b"rubbish!" * 512)


def other_database(path):
    with closing(sqlite3.connect(path)) as db:
        db.execute("CREATE TABLE rows (log TEXT)")


@pytest.mark.parametrize(
    "make", [damaged, other_database, lambda path: path.write_bytes(b"hello\n" * 1000)]
)
def test_what_is_no_journal_is_not_touched(tmp_path, make):
    path = tmp_path / NAME
    make(path)
    content = path.read_bytes()
    with pytest.raises(BatchError):
        BatchJournal(tmp_path, SETTINGS)
    assert path.read_bytes() == content


def test_two_runs_do_not_write_at_once(tmp_path):
    code = (
        "import sys; from pathlib import Path; from calib.line.fleet.journal import BatchJournal; "
        f"BatchJournal(Path(sys.argv[1]), {SETTINGS})"
    )
    with opened(tmp_path) as journal:
        journal.add([row("a")])
        with pytest.raises(BatchError):
            BatchJournal(tmp_path, SETTINGS)
        ran = subprocess.run(
            [sys.executable, "-c", code, tmp_path], cwd=ROOT, capture_output=True, text=True
        )
        assert "BatchError" in ran.stderr
        assert journal.logs() == ["a"]
    BatchJournal(tmp_path, SETTINGS).close()


# No file of this process may grow beyond 200 kB, as on a disk that is nearly full.
NEARLY_FULL = """
import json, resource, signal, sys
from pathlib import Path
from calib.line.fleet.journal import BatchJournal
from calib.line.fleet.rows import Row, Status

signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, 200_000))
journal = BatchJournal(Path(sys.argv[1]), json.loads(sys.argv[2]))
stored = 0
try:
    while True:
        journal.add([Row(f"log {stored:05d}", None, Status.DONE, "e" * 1000)])
        stored += 1
except OSError as error:
    print(stored, error.strerror)
"""


@pytest.mark.skipif(not hasattr(signal, "SIGXFSZ"), reason="no limit of file sizes")
def test_a_disk_that_is_full_is_told_and_loses_no_row_that_was_kept(tmp_path):
    code = [sys.executable, "-c", NEARLY_FULL, tmp_path, json.dumps(SETTINGS)]
    ran = subprocess.run(code, cwd=ROOT, capture_output=True, text=True)
    stored, _, why = ran.stdout.partition(" ")
    assert int(stored) > 10, ran.stderr
    assert why.strip()
    with opened(tmp_path) as journal:
        assert journal.logs() == [f"log {i:05d}" for i in range(int(stored))]
