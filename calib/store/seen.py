"""What a user has seen of stores: an old copy of a whole store shows nothing by itself.

The newest head of a journal that was verified with a key is kept in the user's own folder,
`$XDG_STATE_HOME/brake-cal/seen.json`. A journal only grows: one that lacks that head is an older
copy, or went another way. A store is known by the hash of the first line of its journal, so that it
may be moved; in a place where one store was seen, another one is not taken for it. Two stores whose
first lines were written in one second by one person for the same table are taken for one.
"""

import json
import os
import re
from dataclasses import asdict, dataclass
from pathlib import Path

from calib.base.bounded import TABLE, read_bounded
from calib.base.errors import SignatureRefused
from calib.base.write import locked_folder, write_whole
from calib.store.journal import Journal

_FILE = Path("brake-cal") / "seen.json"
_HASH = re.compile(r"[0-9a-f]{64}")
_UNSEEN = "an older copy of the store will not be noticed"


@dataclass(frozen=True)
class _Sight:
    """The newest line of a journal that was seen: its hash, ``head``, and its number, ``lines``.

    ``key`` id of the key that it was verified with; ``store`` hash of the first line; ``place``
    folder of the store.
    """

    key: str
    store: str
    place: str
    head: str
    lines: int

    @property
    def of(self) -> tuple[str, str, str]:
        """What it is a sight of; of these only the newest is kept."""
        return self.key, self.store, self.place


@dataclass(frozen=True)
class SeenJournals:
    """All that was seen, in the file ``path``; ``note`` says why it cannot be used, else ""."""

    path: Path | None
    sights: tuple[_Sight, ...] = ()
    note: str = ""

    def check(self, folder: Path, journal: Journal, key: str) -> None:
        """Raise SignatureRefused for an older journal than the one that was seen with a key.

        So for one that went another way, and for another store in the place of the one seen.
        """
        here = _sight(folder, journal, key)
        for seen in (one for one in self.sights if one.key == key):
            if flaw := _flaw(seen, here, journal):
                raise SignatureRefused(
                    flaw,
                    where=folder,
                    expected=f"a journal with the line {seen.lines} {seen.head[:12]}...",
                    do=f"get the newest copy of the store; if it was replaced on purpose, remove "
                    f"the entry of its head from {self.path}",
                )

    def keep(self, folder: Path, journal: Journal, key: str) -> str:
        """Keep the head of a journal that was verified; returns why that was not possible, or "".

        Raises SignatureRefused when the file is damaged.
        """
        if self.path is None or self.note or not journal.entries:
            return self.note
        try:
            with locked_folder(self.path.parent):
                return _write(self.path, _sight(folder, journal, key))
        except OSError as error:
            return f"{self.path} cannot be written ({error.strerror}): {_UNSEEN}"


def recall() -> SeenJournals:
    """What was seen. To be called before the journal is read, which may grow meanwhile.

    Raises SignatureRefused when the file is damaged.
    """
    try:
        state = os.environ.get("XDG_STATE_HOME", "")
        base = Path(state) if os.path.isabs(state) else Path.home() / ".local" / "state"
        path = base / _FILE
        data = read_bounded(path, TABLE)
    except FileNotFoundError:
        return SeenJournals(path)
    except RuntimeError:
        return SeenJournals(None, note=f"this user has no home folder: {_UNSEEN}")
    except OSError as error:
        return SeenJournals(path, note=f"{path} cannot be read ({error.strerror}): {_UNSEEN}")
    return SeenJournals(path, _sights(data, path))


def _sights(data: bytes, path: Path) -> tuple[_Sight, ...]:
    try:
        document = json.loads(data)
        sights = tuple(_Sight(**one) for one in document["seen"])
        hashes = all(_HASH.fullmatch(x) for one in sights for x in (one.store, one.head))
        if document["schema"] == 1 and hashes and all(one.lines >= 1 for one in sights):
            return sights
    except (ValueError, TypeError, KeyError, RecursionError):
        pass
    raise SignatureRefused(
        "is damaged",
        where=path,
        expected="what was seen of stores",
        do="restore it; or delete it, and look at the heads of your journals yourself",
    )


def _sight(folder: Path, journal: Journal, key: str) -> _Sight:
    first = journal.entries[0].hash if journal.entries else ""
    return _Sight(key, first, str(folder.resolve()), journal.head, len(journal.entries))


def _flaw(seen: _Sight, here: _Sight, journal: Journal) -> str:
    if seen.store != here.store:
        return "another store was seen here before" if seen.place == here.place else ""
    if here.lines < seen.lines:
        return (
            f"an older copy of the store: its journal has {here.lines} lines, {seen.lines} were "
            "seen"
        )
    if journal.entries[seen.lines - 1].hash != seen.head:
        return f"its journal went another way: line {seen.lines} is not the one that was seen"
    return ""


def _write(path: Path, new: _Sight) -> str:
    """Put a sight in the place of an older one. The caller holds the lock."""
    now = recall()
    if now.note or any(one.of == new.of and one.lines >= new.lines for one in now.sights):
        return now.note
    sights = [*(one for one in now.sights if one.of != new.of), new]
    document = {"schema": 1, "seen": [asdict(one) for one in sights]}
    write_whole(path, (json.dumps(document, indent=2) + "\n").encode())
    return ""
