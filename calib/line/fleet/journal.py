"""Journal of a batch: an SQLite database with a row for each finished log.

    settings   name, value          what the rows depend on besides the logs
    rows       log, digest, status, error, cells (JSON), lost

Rows that finish together are one transaction in a write-ahead log, on the disk when `add` returns:
a kill -9 or a power failure loses none of them. SQLite's exclusive lock on the journal excludes a
second run; it ends with the process.
"""

import errno
import json
import os
import sqlite3
from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from calib.base.errors import BatchError
from calib.line.fleet.rows import Row, Status

NAME = "journal.sqlite"
_SCHEMA = "2"
_ANEW = "name another --out, or remove this folder to start again"
_TABLES = """
BEGIN;
CREATE TABLE settings (name TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE rows (log TEXT PRIMARY KEY, digest TEXT, status TEXT NOT NULL,
    error TEXT, cells TEXT NOT NULL, lost INTEGER NOT NULL);
"""


class BatchJournal:
    """The journal of ``folder``, open for one run at a time; made if there is none.

    It and its methods raise BatchError for other settings or another version, damage, or use by
    another run, and OSError when the disk is full or fails.
    """

    def __init__(self, folder: Path, settings: dict[str, str]):
        folder.mkdir(parents=True, exist_ok=True)
        self.folder, self._path = folder, folder / NAME
        wanted = {"schema": _SCHEMA, **settings}
        self._db, stored = _locked(self._path)
        if not stored:
            with _explained(self._path), self._db:
                self._db.executescript(_TABLES)
                self._db.executemany("INSERT INTO settings VALUES (?, ?)", wanted.items())
        elif differ := {key for key, _ in stored.items() ^ wanted.items()}:
            self.close()
            problem = f"holds results of other settings: {', '.join(sorted(differ))}"
            raise BatchError(problem, where=folder, do=_ANEW)

    def add(self, rows: Iterable[Row]) -> None:
        """Store rows, all or none; each replaces an earlier row of its log."""
        values = [
            (r.log, r.digest, r.status, r.error, json.dumps(r.cells, allow_nan=False), r.lost)
            for r in rows
        ]
        with _explained(self._path), self._db:
            self._db.executemany("INSERT OR REPLACE INTO rows VALUES (?, ?, ?, ?, ?, ?)", values)

    def row(self, log: str) -> Row | None:
        """The row of a log, or None; floats are exact."""
        for _, digest, status, error, cells, lost in self._select("* FROM rows WHERE log = ?", log):
            return Row(log, digest, Status(status), error, tuple(json.loads(cells)), bool(lost))
        return None

    def digest(self, log: str) -> str | None:
        """The digest of a log that need not be tried again, else None."""
        row = self.row(log)
        return None if row is None or row.lost else row.digest

    def rows(self, logs: Iterable[str]) -> Iterator[Row]:
        """Rows of those of ``logs`` that have one, in their order."""
        return filter(None, map(self.row, logs))

    def counts(self) -> Counter[Status]:
        """Number of rows by status."""
        return Counter(Status(word) for (word,) in self._select("status FROM rows"))

    def logs(self) -> list[str]:
        """All logs that have a row, sorted."""
        return [log for (log,) in self._select("log FROM rows ORDER BY log")]

    def _select(self, query: str, *values: str) -> list[tuple[Any, ...]]:
        with _explained(self._path):
            return self._db.execute(f"SELECT {query}", values).fetchall()

    def close(self) -> None:
        """Close it; another run may then open it."""
        self._db.close()


def _locked(path: Path) -> tuple[sqlite3.Connection, dict[str, str]]:
    """Lock the file and check it; return its settings, none if it is new.

    A file that is not a journal is not changed.
    """
    with _explained(path):
        db = sqlite3.connect(path, timeout=0.0)
        try:
            db.execute("PRAGMA locking_mode = EXCLUSIVE")
            stored = {}
            if db.execute("SELECT * FROM sqlite_master").fetchone():
                stored = dict(db.execute("SELECT name, value FROM settings"))
                if db.execute("PRAGMA quick_check(1)").fetchone() != ("ok",):
                    raise sqlite3.DatabaseError("damaged")
            db.execute("PRAGMA journal_mode = WAL")
            db.execute("PRAGMA synchronous = FULL")
        except BaseException:
            db.close()
            raise
    return db, stored


@contextmanager
def _explained(path: Path) -> Iterator[None]:
    """Turn errors of SQLite into BatchError, or into OSError if the disk is the reason."""
    try:
        yield
    except sqlite3.DatabaseError as cause:
        code = getattr(cause, "sqlite_errorcode", sqlite3.SQLITE_CORRUPT) & 0xFF  # no details
        if code == sqlite3.SQLITE_BUSY:
            do = "wait for it, or name another --out"
            raise BatchError("another run uses this folder", where=path.parent, do=do) from cause
        if code in (sqlite3.SQLITE_NOTADB, sqlite3.SQLITE_ERROR, sqlite3.SQLITE_CORRUPT):
            problem = "damaged, or not the journal of a batch of this version"
            raise BatchError(problem, where=path, do=_ANEW) from cause
        if code == sqlite3.SQLITE_CANTOPEN:
            path.open("ab").close()  # raises OSError with the reason
        number = errno.ENOSPC if code == sqlite3.SQLITE_FULL else errno.EIO
        raise OSError(number, f"{os.strerror(number)}: {cause}", str(path)) from cause
