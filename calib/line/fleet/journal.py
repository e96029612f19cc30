"""Journal of a batch: an SQLite database with a row for each finished log.

    settings   name, value          what the rows depend on besides the logs
    rows       log, digest, status, error, cells (JSON), lost

Rows of one `add` are one transaction, which is on the disk when `add` returns: a kill -9 or a power
failure loses none of them. The database is locked, so that a second run is refused.
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
_DO = "name another --out, or remove this folder to start again"
_TABLES = """
BEGIN;
CREATE TABLE settings (name TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE rows (log TEXT PRIMARY KEY, digest TEXT, status TEXT NOT NULL,
    error TEXT, cells TEXT NOT NULL, lost INTEGER NOT NULL);
"""


class BatchJournal:
    """The journal in ``folder``, open for one run at a time; it is made if there is none.

    The class and its methods raise BatchError for other settings, another version, damage, or use
    by another run, and OSError when the disk is full or fails.
    """

    def __init__(self, folder: Path, settings: dict[str, str]):
        folder.mkdir(parents=True, exist_ok=True)
        self.folder, self._path = folder, folder / NAME
        wanted = {"schema": _SCHEMA, **settings}
        self._db, stored = _locked(self._path)
        if not stored:
            with _errors_of_sqlite(self._path), self._db:
                self._db.executescript(_TABLES)
                self._db.executemany("INSERT INTO settings VALUES (?, ?)", wanted.items())
        elif stored != wanted:
            self.close()
            keys = sorted({*stored, *wanted})
            differing = [key for key in keys if stored.get(key) != wanted.get(key)]
            problem = f"holds results of other settings: {', '.join(differing)}"
            raise BatchError(problem, where=folder, do=_DO)

    def add(self, rows: Iterable[Row]) -> None:
        """Store rows, all or none. A row replaces an earlier row of its log."""
        values = []
        for row in rows:
            cells = json.dumps(row.cells, allow_nan=False)
            values.append((row.log, row.digest, row.status, row.error, cells, row.lost))
        with _errors_of_sqlite(self._path), self._db:
            self._db.executemany("INSERT OR REPLACE INTO rows VALUES (?, ?, ?, ?, ?, ?)", values)

    def row(self, log: str) -> Row | None:
        """Return the row of a log with exact floats, or None."""
        rows = self._select("* FROM rows WHERE log = ?", log)
        if not rows:
            return None
        _, digest, status, error, cells, lost = rows[0]
        return Row(log, digest, Status(status), error, tuple(json.loads(cells)), bool(lost))

    def digest(self, log: str) -> str | None:
        """Return the digest of a log that need not be tried again, else None."""
        row = self.row(log)
        return None if row is None or row.lost else row.digest

    def rows(self, logs: Iterable[str]) -> Iterator[Row]:
        """Return the rows of ``logs`` in that order, without logs that have no row."""
        return filter(None, map(self.row, logs))

    def counts(self) -> Counter[Status]:
        """Return the number of rows by status."""
        return Counter(Status(word) for (word,) in self._select("status FROM rows"))

    def logs(self) -> list[str]:
        """Return all logs that have a row, sorted."""
        return [log for (log,) in self._select("log FROM rows ORDER BY log")]

    def _select(self, query: str, *values: str) -> list[tuple[Any, ...]]:
        with _errors_of_sqlite(self._path):
            return self._db.execute(f"SELECT {query}", values).fetchall()

    def close(self) -> None:
        """Close the journal; another run may then open it."""
        self._db.close()


def _locked(path: Path) -> tuple[sqlite3.Connection, dict[str, str]]:
    """Lock and check the database; return it with its settings, which are empty if it is new."""
    with _errors_of_sqlite(path):
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
def _errors_of_sqlite(path: Path) -> Iterator[None]:
    """Raise errors of SQLite as BatchError, or as OSError if the disk is the reason."""
    try:
        yield
    except sqlite3.DatabaseError as cause:
        # the lowest byte is the primary code, the others are details
        code = getattr(cause, "sqlite_errorcode", sqlite3.SQLITE_CORRUPT) & 0xFF
        if code == sqlite3.SQLITE_BUSY:
            do = "wait for it, or name another --out"
            raise BatchError("another run uses this folder", where=path.parent, do=do) from cause
        if code in (sqlite3.SQLITE_NOTADB, sqlite3.SQLITE_ERROR, sqlite3.SQLITE_CORRUPT):
            problem = "damaged, or not the journal of a batch of this version"
            raise BatchError(problem, where=path, do=_DO) from cause
        if code == sqlite3.SQLITE_CANTOPEN:
            path.open("ab").close()  # raises OSError with the reason
        number = errno.ENOSPC if code == sqlite3.SQLITE_FULL else errno.EIO
        raise OSError(number, f"{os.strerror(number)}: {cause}", str(path)) from cause
