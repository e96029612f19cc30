"""Remember the journals that a user has seen, so that an older copy of a store is noticed.

After a journal was verified with a key, its head is kept in the user's own folder, in
`$XDG_STATE_HOME/brake-cal/seen.json`, on Windows below `%LOCALAPPDATA%`. A journal only grows. So a
journal without that head is an older copy, or was changed at some earlier line. The hash of the
first line of its journal identifies a store: a store may be moved, but not replaced.
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


class _SeenJournal(NamedTuple):
    """A journal when the user last saw it, and the key that verified it."""

    key: str
    store: str  # hash of the first line of the journal
    place: str  # folder of the store
    head: str  # hash of the last line
    lines: int

    def contradiction(self, folder: Path, journal: Journal) -> str:
        """Return why the ``journal`` in ``folder`` cannot have grown from this one; "" if it can.

        Journals with different first lines are those of different stores, which contradict each
        other only in the same folder.
        """
        entries = journal.entries
        if not entries or entries[0].hash != self.store:
            is_same_folder = self.place == str(folder.resolve())
            return "another store was seen here before" if is_same_folder else ""
        if len(entries) < self.lines:
            return f"an older copy of the store: {len(entries)} lines, {self.lines} were seen"
        if entries[self.lines - 1].hash != self.head:
            return f"its journal went another way: line {self.lines} is not the one that was seen"
        return ""


@dataclass(frozen=True)
class SeenJournals:
    """The journals of the file ``path``; ``note`` says why the file cannot be used."""

    path: Path | None
    journals: tuple[_SeenJournal, ...] = ()
    note: str = ""

    def check(self, folder: Path, journal: Journal, key: str) -> None:
        """Raise SignatureRefused if a journal seen with the key contradicts this ``journal``."""
        for earlier in self.journals:
            flaw = earlier.contradiction(folder, journal) if earlier.key == key else ""
            if flaw:
                expected = f"a journal with the line {earlier.lines} {earlier.head[:12]}..."
                do = "get the newest copy of the store; if it was replaced on purpose, remove the "
                do += f"entry of its head from {self.path}"
                raise SignatureRefused(flaw, where=folder, expected=expected, do=do)

    def keep(self, folder: Path, journal: Journal, key: str) -> str:
        """Keep the head of a journal that was verified with ``key``; return why not, or "".

        Raises SignatureRefused for a damaged file.
        """
        if self.path is None or self.note or not journal.entries:
            return self.note
        store, lines = journal.entries[0].hash, len(journal.entries)
        latest = _SeenJournal(key, store, str(folder.resolve()), journal.head, lines)
        try:
            with locked_folder(self.path.parent):
                current = recall()  # another process may have written the file since
                earlier = [x for x in current.journals if x[:3] == latest[:3]]  # key, store, place
                is_kept = any(x.lines >= lines for x in earlier)
                if current.note or is_kept:
                    return current.note
                others = [x for x in current.journals if x not in earlier]
                document = {"schema": 1, "seen": [x._asdict() for x in (*others, latest)]}
                write_whole(self.path, (json.dumps(document, indent=2) + "\n").encode())
        except OSError as error:
            return f"{self.path} cannot be written ({error.strerror}): {_UNSEEN}"
        return ""


def recall() -> SeenJournals:
    """Read the journals that were seen. Raises SignatureRefused for a damaged file.

    Call it before the journal of the store is read. Else another process may add a line and keep
    its head in between, and the journal that was read would look like an older copy.
    """
    try:
        variables = (os.environ.get(name, "") for name in ("XDG_STATE_HOME", "LOCALAPPDATA"))
        state_home = next(filter(os.path.isabs, variables), None)
        path = (Path(state_home) if state_home else Path.home() / ".local" / "state") / _FILE
        data = read_bounded(path, TABLE)
    except FileNotFoundError:
        return SeenJournals(path)
    except RuntimeError:
        return SeenJournals(None, note=f"this user has no home folder: {_UNSEEN}")
    except OSError as error:
        return SeenJournals(path, note=f"{path} cannot be read ({error.strerror}): {_UNSEEN}")
    try:
        document = json.loads(data)
        journals = tuple(_SeenJournal(**fields) for fields in document["seen"])
        if document["schema"] == 1 and all(map(_is_typed, journals)):
            return SeenJournals(path, journals)
    except (ValueError, TypeError, KeyError, RecursionError):
        pass
    raise SignatureRefused("is damaged", where=path, do="get it from a copy, or remove it")


def _is_typed(journal: _SeenJournal) -> bool:
    """Whether the fields have their types, and ``lines`` is positive."""
    *texts, lines = journal
    return all(type(text) is str for text in texts) and type(lines) is int and lines > 0
