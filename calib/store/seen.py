"""Stores that a user has seen: by itself, an old copy of a whole store is not noticed.

The newest head of a journal that was verified with a key is kept in the user's own folder,
`$XDG_STATE_HOME/brake-cal/seen.json`, on Windows `%LOCALAPPDATA%`. A journal only grows: one that
lacks that head is an older copy, or went another way. A store is known by the hash of the first
line of its journal, so that it may be moved; another store in its place is noticed. Two stores
whose first lines were written in one second by one person for the same table are taken for one.
"""

import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from calib.base.bounded import TABLE, read_bounded
from calib.base.errors import SignatureRefused
from calib.base.write import locked_folder, write_whole
from calib.store.journal import Journal

if TYPE_CHECKING:
    from calib.store.record_file import Sight

_FILE = Path("brake-cal") / "seen.json"
_UNSEEN = "an older copy of the store will not be noticed"


@dataclass(frozen=True)
class SeenJournals:
    """The journals that were seen, in the file ``path``; ``note`` why it cannot be used, or ""."""

    path: Path | None
    sights: "tuple[Sight, ...]" = ()
    note: str = ""

    def check(self, folder: Path, journal: Journal, key: str) -> None:
        """Raise SignatureRefused for a journal that lacks the head that was seen with a key.

        So for another store in the place of the one that was seen.
        """
        for sight in self.sights:
            if sight.key == key and (flaw := _flaw(sight, folder, journal)):
                raise SignatureRefused(
                    flaw,
                    where=folder,
                    expected=f"a journal with the line {sight.lines} {sight.head[:12]}...",
                    do=f"get the newest copy of the store; if it was replaced on purpose, remove "
                    f"the entry of its head from {self.path}",
                )

    def keep(self, folder: Path, journal: Journal, key: str) -> str:
        """Keep the head of a journal that was verified; returns why that failed, or "".

        Raises SignatureRefused when the file is damaged.
        """
        from calib.store.record_file import Sight

        if self.path is None or self.note or not journal.entries:
            return self.note
        first, lines = journal.entries[0].hash, len(journal.entries)
        place = str(folder.resolve())
        new = Sight(key=key, store=first, place=place, head=journal.head, lines=lines)
        try:
            with locked_folder(self.path.parent):
                now = recall()
                same = [old for old in now.sights if old.subject == new.subject]
                if now.note or any(old.lines >= lines for old in same):
                    return now.note
                sights = [*(old for old in now.sights if old not in same), new]
                document = {"schema": 1, "seen": [one.model_dump() for one in sights]}
                write_whole(self.path, (json.dumps(document, indent=2) + "\n").encode())
        except OSError as error:
            return f"{self.path} cannot be written ({error.strerror}): {_UNSEEN}"
        return ""


def recall() -> SeenJournals:
    """The journals that were seen; to be called before a journal is read, which may grow meanwhile.

    Raises SignatureRefused when the file is damaged.
    """
    from calib.base.record import validated
    from calib.store.record_file import SeenFile

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
    return SeenJournals(path, validated(data, SeenFile, path, SignatureRefused).seen)


def _flaw(sight: "Sight", folder: Path, journal: Journal) -> str:
    """Why a journal in ``folder`` cannot follow the one that was seen, or ""."""
    lines = journal.entries
    if not lines or lines[0].hash != sight.store:
        return "another store was seen here before" * (sight.place == str(folder.resolve()))
    if len(lines) < sight.lines:
        had = f"its journal has {len(lines)} lines, {sight.lines} were seen"
        return f"an older copy of the store: {had}"
    if lines[sight.lines - 1].hash != sight.head:
        return f"its journal went another way: line {sight.lines} is not the one that was seen"
    return ""
