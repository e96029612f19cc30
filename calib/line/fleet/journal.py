"""Journal of a batch: an SQLite database with a row for each finished log.

    settings   name, value          on which the rows depend besides the logs
    rows       log, digest, status, error, cells (JSON), lost

Rows that finish together are one transaction in a write-ahead log, without waiting for the disk:
after kill -9 it has every finished row, after a power failure all but those of the last seconds,
and never a part of a transaction. `Journal.sync` waits for the disk. SQLite's exclusive lock, held
while the journal is open, excludes a second run; it ends with the process, also on Windows.
"""

import errno
import json
import os
import re
import sqlite3
from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from calib.base.errors import BatchError
from calib.line.fleet.columns import Status
from calib.line.fleet.row import Row

NAME = "journal.sqlite"
EARLIER = "journal.jsonl"
"""File name of the journal in versions up to 0.1; it is not read."""

SCHEMA = "2"
FOREIGN, DAMAGED = "not the journal of a batch of this version", "the journal is damaged"
ANEW = "name another --out, or start again with --fresh"
TABLES = (
    "DROP TABLE IF EXISTS settings",
    "DROP TABLE IF EXISTS rows",
    "CREATE TABLE settings (name TEXT PRIMARY KEY, value TEXT NOT NULL)",
    "CREATE TABLE rows (log TEXT PRIMARY KEY, digest TEXT, status TEXT NOT NULL, error TEXT, "
    "cells TEXT NOT NULL, lost INTEGER NOT NULL)",
)


class BatchJournal:
    """The journal of a folder, open for one run at a time.

    Its methods raise OSError when the disk is full or fails, BatchError when the file is damaged.
    """

    def __init__(self, db: sqlite3.Connection, path: Path):
        self._db, self._path = db, path

    def add(self, rows: Iterable[Row]) -> None:
        """Store rows, all or none; each replaces an earlier row of its log."""
        values = [
            (r.log, r.digest, r.status, r.error, json.dumps(r.cells, allow_nan=False), r.lost)
            for r in rows
        ]
        with _explained(self._path), self._db:
            self._db.executemany("INSERT OR REPLACE INTO rows VALUES (?, ?, ?, ?, ?, ?)", values)

    def sync(self) -> None:
        """Wait until the rows are on the disk."""
        with _explained(self._path):
            self._db.execute("PRAGMA wal_checkpoint").fetchone()

    def row(self, log: str) -> Row | None:
        """The row of a log, or None; floats are exact."""
        with _explained(self._path):
            found = self._db.execute("SELECT * FROM rows WHERE log = ?", (log,)).fetchone()
        if found is None:
            return None
        _, digest, status, error, cells, lost = found
        return Row(log, digest, Status(status), error, tuple(json.loads(cells)), bool(lost))

    def rows(self, logs: Iterable[str]) -> Iterator[Row]:
        """Rows of ``logs`` in their order. Raises KeyError for a log that has none."""
        for log in logs:
            row = self.row(log)
            if row is None:
                raise KeyError(log)
            yield row

    def logs(self) -> list[str]:
        """All logs that have a row, sorted."""
        with _explained(self._path):
            return sorted(log for (log,) in self._db.execute("SELECT log FROM rows"))

    def counts(self) -> Counter[Status]:
        """Number of rows by status."""
        with _explained(self._path):
            found = self._db.execute("SELECT status, count(*) FROM rows GROUP BY status")
            return Counter({Status(status): count for status, count in found})

    def close(self) -> None:
        """Sync and close; another run may then open it."""
        try:
            self.sync()
        finally:
            self._db.close()


def open_journal(folder: Path, settings: dict[str, str], fresh: bool = False) -> BatchJournal:
    """Open the journal of ``folder``, or make one; ``fresh`` deletes its content.

    Raises BatchError when it was written with other settings, is no journal of this version, is
    damaged or in use, and OSError when it cannot be written.
    """
    path, earlier = folder / NAME, folder / EARLIER
    ours = {"schema": SCHEMA, **settings}
    if earlier.exists() and not fresh:
        raise _Unusable(FOREIGN, where=earlier, do=ANEW)
    try:
        db, stored = _locked(path)
    except _Unusable:
        if not fresh:
            raise
        for rest in (path, Path(f"{path}-wal")):
            rest.unlink(missing_ok=True)
        db, stored = _locked(path)
    journal = BatchJournal(db, path)
    try:
        if fresh or stored is None:
            with _explained(path):
                _begin(db, ours)
        else:
            _require_same(stored, ours, folder)
        journal.sync()
        earlier.unlink(missing_ok=True)
    except BaseException:
        db.close()
        raise
    return journal


def _locked(path: Path) -> tuple[sqlite3.Connection, dict[str, str] | None]:
    """Lock the file and check it; return its settings, None if it is new.

    A file that is not a journal is not changed.
    """
    with _explained(path):
        db = sqlite3.connect(path, timeout=0.0)
    try:
        with _explained(path):
            db.execute("PRAGMA locking_mode = EXCLUSIVE")
            stored = None
            if db.execute("SELECT * FROM sqlite_master").fetchone():
                stored = dict(db.execute("SELECT name, value FROM settings"))
                if db.execute("PRAGMA quick_check(1)").fetchone() != ("ok",):
                    raise _Unusable(DAMAGED, where=path, do=ANEW)
            db.execute("PRAGMA journal_mode = WAL")
            db.execute("PRAGMA synchronous = NORMAL")  # a commit does not wait for the disk
    except BaseException:
        db.close()
        raise
    return db, stored


def _begin(db: sqlite3.Connection, settings: dict[str, str]) -> None:
    """Make new tables, in one transaction."""
    with db:
        db.execute("BEGIN")
        for statement in TABLES:
            db.execute(statement)
        db.executemany("INSERT INTO settings VALUES (?, ?)", settings.items())


def _require_same(found: dict[str, str], settings: dict[str, str], folder: Path) -> None:
    differ = [k for k in {**settings, **found} if found.get(k) != settings.get(k)]
    if differ:
        pairs = [(k, _short(found.get(k)), _short(settings.get(k))) for k in differ]
        changes = ", ".join(f"{key} {theirs} for {ours}" for key, theirs, ours in pairs)
        raise BatchError(f"holds results of other settings: {changes}", where=folder, do=ANEW)


def _short(value: str | None) -> str:
    """A digest by its first digits, anything else as it is."""
    text = "none" if value is None else value
    return text[:12] if re.fullmatch("[0-9a-f]{64}", text) else text


class _Unusable(BatchError):
    """The file is not a valid journal of this version."""


@contextmanager
def _explained(path: Path) -> Iterator[None]:
    """Turn errors of SQLite into BatchError, or into OSError if the disk is the reason."""
    try:
        yield
    except sqlite3.DatabaseError as cause:
        code = getattr(cause, "sqlite_errorcode", 0) & 0xFF  # without the details in higher bits
        if code == sqlite3.SQLITE_BUSY:
            what, do = "another run uses this folder", "wait for it, or name another --out"
            raise BatchError(what, where=path.parent, do=do) from cause
        if code in (sqlite3.SQLITE_NOTADB, sqlite3.SQLITE_ERROR):
            raise _Unusable(FOREIGN, where=path, do=ANEW) from cause
        if code == sqlite3.SQLITE_CORRUPT:
            raise _Unusable(DAMAGED, where=path, do=ANEW) from cause
        if code == sqlite3.SQLITE_CANTOPEN:
            path.open("ab").close()  # raises OSError with the reason
        number = errno.ENOSPC if code == sqlite3.SQLITE_FULL else errno.EIO
        raise OSError(number, f"{os.strerror(number)}: {cause}", str(path)) from cause
