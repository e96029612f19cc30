"""How a version gets into a store: made aside, entered in the journal, moved to its place.

The journal's line is what counts. A writer that is stopped before it leaves a folder that the next
writer deletes; one that is stopped after it leaves a version that every reader finds and the next
writer moves. All of it happens under the lock of the store.
"""

import os
import shutil
from contextlib import suppress
from pathlib import Path

from calib.base.bounded import JOURNAL as JOURNAL_FILE
from calib.base.bounded import read_bounded
from calib.base.write import sync, write_whole
from calib.store.folders import NEW, SIGNATURE, folder_of, unplaced
from calib.store.journal import HEAD, JOURNAL, Journal, damaged, parse
from calib.store.version import write_curves, write_record
from calib.table.table import Table


def read_journal(folder: Path) -> Journal:
    """The journal of a store; an empty one where there is none.

    Raises DamagedTable where it is torn or was changed, OSError where it cannot be read.
    """
    # The head first: a writer may add a line between the two.
    head = _bytes(folder / HEAD)
    data = _bytes(folder / JOURNAL)
    if data is None and head not in (None, Journal().head_content()):
        raise damaged(f"missing, and {HEAD} is there", folder / JOURNAL)
    return parse(data or b"", head, folder / JOURNAL)


def write_journal(folder: Path, journal: Journal) -> None:
    """Replace the journal by a longer one. Raises OSError."""
    if not (folder / HEAD).exists():  # a journal without a head is one whose head was lost
        write_whole(folder / HEAD, Journal().head_content())
    write_whole(folder / JOURNAL, journal.content())
    write_whole(folder / HEAD, journal.head_content())
    sync(folder)


def tidy(folder: Path, journal: Journal) -> None:
    """Finish or undo what stopped writers left. The caller holds the lock. Raises OSError."""
    for path in unplaced(folder):
        home, name = path.parent, path.name.removeprefix(NEW)
        known = {folder_of(version) for version in journal.of(home.name)}
        if name in known and not (home / name).exists():
            os.rename(path, home / name)
        else:
            shutil.rmtree(path)
    for begun in (f".{JOURNAL}.*", f".{HEAD}.*", f"*/.v*{SIGNATURE}.*"):
        for path in folder.glob(begun):
            path.unlink()


def write_version(folder: Path, table: Table, version: int) -> Path:
    """Write a version aside, where no listing shows it, and return its folder. Raises OSError."""
    work = folder / table.name / f"{NEW}{folder_of(version)}"
    try:
        work.mkdir(parents=True)
        write_curves(table, work)
        write_record(table, version, work)
    except BaseException:
        discard(work)
        raise
    return work


def commit(folder: Path, journal: Journal, work: Path) -> None:
    """Enter a version in the journal and move it to its place.

    If it is not entered, ``work`` is deleted. Raises OSError.
    """
    try:
        write_journal(folder, journal)
    except BaseException:
        if _bytes(folder / JOURNAL) != journal.content():
            discard(work)
        raise
    with suppress(OSError):  # it is stored: readers find it aside, the next writer moves it
        os.rename(work, work.parent / work.name.removeprefix(NEW))
        sync(work.parent)


def commit_signature(folder: Path, journal: Journal, path: Path, content: bytes) -> None:
    """Write a signature file, and enter it in the journal.

    The file comes first: it says nothing that is not so, entered or not, while a journal that
    names a signature which is not there would. If it is not entered, the file is put back as it
    was. Raises OSError.
    """
    before = _bytes(path)
    write_whole(path, content)
    try:
        write_journal(folder, journal)
    except BaseException:
        if _bytes(folder / JOURNAL) != journal.content():
            if before is None:
                path.unlink()
            else:
                write_whole(path, before)
        raise


def discard(work: Path) -> None:
    """Delete a version that was not entered, and its table's folder if that is then empty."""
    shutil.rmtree(work, ignore_errors=True)
    with suppress(OSError):
        work.parent.rmdir()


def _bytes(path: Path) -> bytes | None:
    try:
        return read_bounded(path, JOURNAL_FILE)
    except FileNotFoundError:
        return None
