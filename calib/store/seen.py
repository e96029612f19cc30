"""What a user has seen of stores: an old copy of a whole store shows nothing by itself.

The newest head of a journal that was verified with a key is kept in the user's own folder,
`$XDG_STATE_HOME/brake-cal/seen.json`. A journal only grows: one that lacks that head is an older
copy, or went another way. A store is known by the hash of the first line of its journal, so that it
may be moved; in a place where one store was seen, another one is not taken for it. Two stores whose
first lines were written in one second by one person for the same table are taken for one.
"""

import json
import os
from dataclasses import asdict, dataclass
from pathlib import Path

from calib.base.bounded import TABLE, read_bounded
from calib.base.errors import SignatureRefused
from calib.base.write import write_whole
from calib.store.journal import Journal
from calib.store.lock import locked

FILE = Path("brake-cal") / "seen.json"


@dataclass(frozen=True)
class Sight:
    """The newest line of a journal that was seen.

    ``key`` is the id of the key that it was verified with; ``store`` the hash of the first line;
    ``place`` the folder of the store; ``head`` and ``lines`` hash and number of the newest line.
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
    sights: tuple[Sight, ...] = ()
    note: str = ""

    def check(self, folder: Path, journal: Journal, key: str) -> None:
        """Compare the journal of the store in ``folder`` with what was seen with a key.

        Raises SignatureRefused for an older journal than the one that was seen, for one that went
        another way, and for another store than the one that was seen in this place.
        """
        here = _sight(folder, journal, key)
        for seen in self.sights:
            if seen.key != key:
                continue
            if seen.store == here.store:
                flaw = _flaw(seen, journal)
            else:
                flaw = "another store was seen here before" if seen.place == here.place else ""
            if flaw:
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
        new = _sight(folder, journal, key)
        try:
            with locked(self.path.parent):
                return _write(self.path, new)
        except OSError as error:
            return f"{self.path} cannot be written ({error.strerror}): {UNSEEN}"


UNSEEN = "an older copy of the store will not be noticed"


def recall() -> SeenJournals:
    """What was seen. To be called before the journal is read, which may grow meanwhile.

    Raises SignatureRefused when the file is damaged.
    """
    try:
        path = _path()
        data = read_bounded(path, TABLE)
    except FileNotFoundError:
        return SeenJournals(path)
    except RuntimeError:
        return SeenJournals(None, note=f"this user has no home folder: {UNSEEN}")
    except OSError as error:
        return SeenJournals(path, note=f"{path} cannot be read ({error.strerror}): {UNSEEN}")
    return SeenJournals(path, _sights(data, path))


def _path() -> Path:
    """The file. Raises RuntimeError for a user without a home folder."""
    state = os.environ.get("XDG_STATE_HOME", "")
    base = Path(state) if os.path.isabs(state) else Path.home() / ".local" / "state"
    return base / FILE


def _sights(data: bytes, path: Path) -> tuple[Sight, ...]:
    from calib.base.record import validated
    from calib.store.seen_file import SeenFile

    try:
        file = validated(data, SeenFile, None, SignatureRefused)
    except SignatureRefused as error:
        raise SignatureRefused(
            f"is damaged ({error})",
            where=path,
            expected="what was seen of stores",
            do="restore it; or delete it, and look at the heads of your journals yourself",
        ) from error
    return tuple(Sight(**one.model_dump()) for one in file.seen)


def _sight(folder: Path, journal: Journal, key: str) -> Sight:
    first = journal.entries[0].hash if journal.entries else ""
    return Sight(key, first, str(folder.resolve()), journal.head, len(journal.entries))


def _flaw(seen: Sight, journal: Journal) -> str:
    lines = len(journal.entries)
    if lines < seen.lines:
        return f"an older copy of the store: its journal has {lines} lines, {seen.lines} were seen"
    if journal.entries[seen.lines - 1].hash != seen.head:
        return f"its journal went another way: line {seen.lines} is not the one that was seen"
    return ""


def _write(path: Path, new: Sight) -> str:
    """Put a sight in the place of an older one. The caller holds the lock."""
    now = recall()
    if now.note or any(one.of == new.of and one.lines >= new.lines for one in now.sights):
        return now.note
    sights = [*(one for one in now.sights if one.of != new.of), new]
    document = {"schema": 1, "seen": [asdict(one) for one in sights]}
    write_whole(path, (json.dumps(document, indent=2) + "\n").encode())
    return now.note
