"""Stores that a user has seen, so that an older copy of a whole store is noticed.

The newest head of a journal that was verified with a key is kept in the user's own folder,
`$XDG_STATE_HOME/brake-cal/seen.json`, on Windows `%LOCALAPPDATA%`. A journal only grows, so one
without that head is older or another branch. A store is identified by the hash of the first line of
its journal: it may be moved, but not replaced.
"""

import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from calib.base.bounded import TABLE, read_bounded
from calib.base.errors import SignatureRefused
from calib.base.write import locked_folder, write_whole
from calib.store.journal import Journal

_FILE = Path("brake-cal") / "seen.json"
_UNSEEN = "an older copy of the store will not be noticed"


class _Sight(NamedTuple):
    """The newest line of a journal that was seen: its hash ``head`` and number ``lines``.

    ``key`` that verified it, ``store`` hash of the first line, ``place`` the folder.
    """

    key: str
    store: str
    place: str
    head: str
    lines: int

    def flaw(self, folder: Path, journal: Journal) -> str:
        """Why a journal in ``folder`` cannot follow this one, or ""."""
        entries = journal.entries
        if not entries or entries[0].hash != self.store:
            return "another store was seen here before" * (self.place == str(folder.resolve()))
        if len(entries) < self.lines:
            had = f"its journal has {len(entries)} lines, {self.lines} were seen"
            return f"an older copy of the store: {had}"
        if entries[self.lines - 1].hash != self.head:
            return f"its journal went another way: line {self.lines} is not the one that was seen"
        return ""


@dataclass(frozen=True)
class SeenJournals:
    """The journals that were seen, in the file ``path``; ``note`` why it cannot be used, or ""."""

    path: Path | None
    sights: tuple[_Sight, ...] = ()
    note: str = ""

    def check(self, folder: Path, journal: Journal, key: str) -> None:
        """Raise SignatureRefused for a journal without the head seen, or of another store."""
        for sight in self.sights:
            if sight.key == key and (flaw := sight.flaw(folder, journal)):
                raise SignatureRefused(
                    flaw,
                    where=folder,
                    expected=f"a journal with the line {sight.lines} {sight.head[:12]}...",
                    do=f"get the newest copy of the store; if it was replaced on purpose, remove "
                    f"the entry of its head from {self.path}",
                )

    def keep(self, folder: Path, journal: Journal, key: str) -> str:
        """Keep the head of a verified journal; return why that failed, or "".

        Raises SignatureRefused for a damaged file.
        """
        if self.path is None or self.note or not journal.entries:
            return self.note
        first, lines = journal.entries[0].hash, len(journal.entries)
        new = _Sight(key, first, str(folder.resolve()), journal.head, lines)
        try:
            with locked_folder(self.path.parent):
                now = recall()
                same = [old for old in now.sights if old[:3] == new[:3]]
                if now.note or any(old.lines >= lines for old in same):
                    return now.note
                sights = [*(old for old in now.sights if old not in same), new]
                document = {"schema": 1, "seen": [one._asdict() for one in sights]}
                write_whole(self.path, (json.dumps(document, indent=2) + "\n").encode())
        except OSError as error:
            return f"{self.path} cannot be written ({error.strerror}): {_UNSEEN}"
        return ""


def recall() -> SeenJournals:
    """Read the journals that were seen, before a journal is read, which may grow meanwhile.

    Raises SignatureRefused for a damaged file.
    """
    try:
        states = (os.environ.get(name, "") for name in ("XDG_STATE_HOME", "LOCALAPPDATA"))
        state = next(filter(os.path.isabs, states), None) or Path.home() / ".local" / "state"
        path = Path(state) / _FILE
        data = read_bounded(path, TABLE)
    except FileNotFoundError:
        return SeenJournals(path)
    except RuntimeError:
        return SeenJournals(None, note=f"this user has no home folder: {_UNSEEN}")
    except OSError as error:
        return SeenJournals(path, note=f"{path} cannot be read ({error.strerror}): {_UNSEEN}")
    try:
        document = json.loads(data)
        sights = tuple(_Sight(**one) for one in document["seen"])
        typed = all([*map(type, one)] == [str] * 4 + [int] and one.lines > 0 for one in sights)
        if document["schema"] == 1 and typed:
            return SeenJournals(path, sights)
    except (ValueError, TypeError, KeyError, RecursionError):
        pass
    raise SignatureRefused("is damaged", where=path, do="get it from a copy, or remove it")
