"""What has been done so far, on disk: a line a row, appended as they finish.

    {"schema": 1, "settings": {...}}
    ["logs/a.csv", "3f2a...", "passed", null, [0.98, ...], false]
    ...

A line that is cut off, by a crash or a full disk, is no row; its log is done again. Of two rows of
one log the later counts. What stays in memory is where each row lies, not the row.
"""

import json
import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO, NamedTuple

from calib.errors import BatchError
from calib.fleet.row import Row, from_line, to_line

NAME = "journal.jsonl"
SCHEMA = 1


class JournalEntry(NamedTuple):
    """Where a row lies in the journal, and what must be known of it without reading it."""

    offset: int
    digest: str | None
    status: str
    lost: bool


class Journal:
    """The journal of a folder, open for one run at a time."""

    def __init__(self, file: BinaryIO, entries: dict[str, JournalEntry]):
        self._file, self.entries = file, entries

    def add(self, rows: list[Row]) -> None:
        """Append rows and hand them to the system. Raises OSError on a full disk."""
        for row in rows:
            offset = self._file.tell()
            self._file.write(to_line(row))
            self.entries[row.log] = JournalEntry(offset, row.digest, row.status, row.lost)
        self._file.flush()

    def sync(self) -> None:
        """Wait until the rows are on the disk."""
        self._file.flush()
        os.fsync(self._file.fileno())

    def rows(self, logs: list[str]) -> Iterator[Row]:
        """Read rows back, in the order of ``logs``."""
        self._file.flush()
        with open(self._file.name, "rb") as file:
            for log in logs:
                file.seek(self.entries[log].offset)
                yield from_line(file.readline())

    def close(self) -> None:
        """Sync and close; another run may then open it."""
        try:
            self.sync()
        finally:
            self._file.close()


def open_journal(folder: Path, settings: dict[str, str], fresh: bool = False) -> Journal:
    """Open the journal of ``folder``, or begin one; ``fresh`` throws away what it holds.

    Raises BatchError when it was written with other settings, is no journal, or is in use.
    """
    path = folder / NAME
    file = open(path, "a+b")  # noqa: SIM115  the journal closes it
    try:
        _lock(file, path)
        if fresh:
            file.truncate(0)
        file.seek(0)
        head = file.readline()
        ours = json.dumps({"schema": SCHEMA, "settings": settings}).encode() + b"\n"
        if head != ours and ours.startswith(head):  # new, or its very first line was cut off
            file.truncate(0)
            file.write(ours)
            entries: dict[str, JournalEntry] = {}
        else:
            _require_same(head, settings, path)
            entries = _read(file, path)
        journal = Journal(file, entries)
        journal.sync()
    except BaseException:
        file.close()
        raise
    return journal


def _read(file: BinaryIO, path: Path) -> dict[str, JournalEntry]:
    """Entries by log; cuts off a torn last line."""
    entries: dict[str, JournalEntry] = {}
    offset = file.tell()
    for line in file:
        try:
            row = from_line(line)
        except (ValueError, TypeError) as cause:
            if line.endswith(b"\n"):
                raise BatchError(
                    f"the line at byte {offset} is no row",
                    where=path,
                    do="start anew with --fresh",
                ) from cause
            break
        entries[row.log] = JournalEntry(offset, row.digest, row.status, row.lost)
        offset += len(line)
    file.truncate(offset)
    file.seek(offset)
    return entries


def _require_same(head: bytes, settings: dict[str, str], path: Path) -> None:
    try:
        document = json.loads(head)
        found = document["settings"] if document["schema"] == SCHEMA else None
    except (ValueError, TypeError, KeyError):
        found = None
    if not isinstance(found, dict):
        raise BatchError("not the journal of a batch", where=path, do="name another --out")
    differ = [k for k in {**settings, **found} if found.get(k) != settings.get(k)]
    if differ:
        pairs = [(k, _short(found.get(k)), _short(settings.get(k))) for k in differ]
        said = ", ".join(f"{key} {theirs} for {ours}" for key, theirs, ours in pairs)
        raise BatchError(
            f"holds results of other settings: {said}",
            where=path.parent,
            do="name another --out, or start anew with --fresh",
        )


def _short(value: object) -> str:
    """A digest by its first figures, anything else as it is."""
    text = "none" if value is None else str(value)
    return text[:12] if re.fullmatch("[0-9a-f]{64}", text) else text


def _lock(file: BinaryIO, path: Path) -> None:
    """Keep a second run out for as long as the file is open."""
    try:
        import fcntl
    except ImportError:  # not there on Windows
        return
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as cause:
        raise BatchError(
            "another run is at work here",
            where=path.parent,
            do="wait for it, or name another --out",
        ) from cause
