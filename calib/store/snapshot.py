"""A store at one moment: its journal, and the versions in its folder.

A version that is read is compared with its digests, the name of its folder, and the journal. A
stray is the folder of a version that is not in the journal.
"""

from dataclasses import dataclass, replace
from pathlib import Path

from calib.base.errors import DamagedTable, StoreError, TableNotFound
from calib.base.toml import did_you_mean
from calib.store.folders import (
    checked_name,
    existing_folder,
    names_in,
    path_of,
    taken_numbers,
    versions_in,
)
from calib.store.journal import JOURNAL, Journal
from calib.store.state import DRAFT, RELEASED, WITHDRAWN, VersionState
from calib.store.version import Stored, read_version
from calib.table.compare import inputs_digest, is_same_fit
from calib.table.invariants import violations
from calib.table.table import Table


@dataclass(frozen=True)
class StoreEntry:
    """A version in the list of `Store.entries` or `Store.verify`."""

    name: str
    version: int
    state: VersionState
    stored: Stored | None  # None in the list of `Store.verify`, or if it cannot be read
    violations: tuple[str, ...] = ()
    signed: str | None = None  # state that a valid signature covers, if a key was given

    @property
    def id(self) -> str:
        """name@version."""
        return f"{self.name}@{self.version}"

    @property
    def sound(self) -> bool:
        """Whether there are no violations."""
        return not self.violations


@dataclass(frozen=True)
class Snapshot:
    """The versions below ``folder`` and their ``journal``."""

    folder: Path
    journal: Journal

    @property
    def names(self) -> list[str]:
        """Names of the tables. Raises TableNotFound, and DamagedTable if the journal is missing."""
        if not self.folder.is_dir():
            do = "`brake-cal fit` makes one, --store names another"
            raise TableNotFound("no table store here", where=self.folder, do=do)
        self.require_journal()
        return sorted(self.journal.tables)

    def require_journal(self) -> None:
        """Raise DamagedTable if there are versions without a journal."""
        if not self.journal.entries and names_in(self.folder):
            flaw = "missing, and versions are there whose state it knew"
            raise DamagedTable(flaw, where=self.folder / JOURNAL)

    def require_table(self, name: str) -> str:
        """Return ``name`` if the store has a table of that name. Raises TableNotFound."""
        names = self.names
        if checked_name(name) in names or versions_in(self.folder / name):
            return name
        expected = "one of " + ", ".join(names) if names else "a table: the store is empty"
        do = did_you_mean(name, names)
        if not do and Path(name).is_file():
            do = "a file of that name is here: give the table first, then the logs"
        raise TableNotFound(f"no table {name!r}", where=self.folder, expected=expected, do=do)

    def with_strays(self, name: str) -> list[int]:
        """Return the numbers of a table's versions in the journal and of its strays, rising."""
        return sorted({*self.journal.versions(name), *versions_in(self.folder / name)})

    def next_number(self, name: str) -> int:
        """Return the number of the next version: one more than any in the journal or the folder."""
        numbers = [*self.journal.versions(name), *taken_numbers(self.folder / name)]
        return 1 + max(numbers, default=0)

    def find(self, reference: str, released: bool) -> Stored:
        """Read the version of a reference: a path, ``name@version`` or ``name``.

        A bare ``name`` means its newest version that is released or a draft; if ``released`` is
        true, the newest that is released. Raises TableNotFound, DamagedTable, StoreError.
        """
        path = path_of(reference)
        if path is not None:
            return self._at_path(path)
        if "@" in reference:
            return self.load(*self.numbered(reference))
        name = self.require_table(reference)
        states = {v: self.journal.word(name, v) for v in self.journal.versions(name)}
        if not states:  # all versions of the name are strays, which `load` refuses
            return self.load(name, max(self.with_strays(name)))
        allowed = (RELEASED,) if released else (RELEASED, DRAFT)
        possible = [version for version, state in states.items() if state in allowed]
        if possible:
            return self.load(name, max(possible))
        if released:
            kind, do = "released", f"release one: `brake-cal tables release {name}@N --reason ...`"
        else:
            kind, do = "usable", f"name the one that you mean, such as {name}@{max(states)}"
        existing = ", ".join(f"{name}@{version} {state}" for version, state in states.items())
        raise StoreError(f"{name} has no {kind} version; there is {existing}", do=do)

    def _at_path(self, path: Path) -> Stored:
        """Read the version in a folder, with its state if the folder is in this store."""
        copy = read_version(path)
        folder = existing_folder(self.folder / copy.name, copy.version)
        if folder and folder.resolve() == path.resolve():
            return self.load(copy.name, copy.version)
        return copy

    def numbered(self, reference: str) -> tuple[str, int]:
        """Return name and version of ``name@version``. Raises TableNotFound."""
        name, _, version = reference.partition("@")
        versions = self.with_strays(self.require_table(name))
        if version.isascii() and version.isdecimal() and int(version) in versions:
            return name, int(version)
        flaw, expected = f"no version {version!r} of {name!r}", ", ".join(map(str, versions))
        raise TableNotFound(flaw, where=self.folder, expected=f"one of {expected}")

    def load(self, name: str, version: int) -> Stored:
        """Read a version. Raises DamagedTable where digests, folder and journal do not agree."""
        id_ = f"{name}@{version}"
        path = existing_folder(self.folder / checked_name(name), version)
        if path is None:
            raise DamagedTable("missing: it was stored, and its folder is not there", where=id_)
        stored = read_version(path, id_)
        if version not in self.journal.versions(name):
            flaw = "not in the journal: it was copied here, or the journal was set back"
            do = "restore the journal from a copy, or move the version out of the store"
            raise DamagedTable(flaw, where=id_, do=do)
        first = self.journal.versions(name)[version][0]
        if (first.digest, first.record) != (stored.digest, stored.record_digest):
            flaw = "replaced or edited: it is not what was stored as this version"
            expected = f"digest {first.digest[:12]}, it has {stored.digest[:12]}"
            raise DamagedTable(flaw, where=id_, expected=expected)
        return replace(stored, state=self.journal.state(name, version))

    def entry(self, name: str, version: int) -> StoreEntry:
        """Return the entry of a version, whether the version can be read or not."""
        state = self.journal.state(name, version)
        try:
            return StoreEntry(name, version, state, self.load(name, version))
        except StoreError as error:
            return StoreEntry(name, version, state, None, (error.problem,))

    def verified(self, name: str, version: int) -> StoreEntry:
        """Return `entry` with the violations of the table; a withdrawn version may be missing."""
        entry = self.entry(name, version)
        if entry.stored:
            return replace(entry, violations=violations(entry.stored.table))
        is_missing = existing_folder(self.folder / name, version) is None
        if is_missing and entry.state.word == WITHDRAWN:
            return replace(entry, violations=())
        return entry

    def identical(self, table: Table) -> Stored | None:
        """Return the newest undamaged version that holds the same table, or None."""
        inputs, digest = inputs_digest(table.content()[0]), table.digest
        for version, history in reversed(self.journal.versions(table.name).items()):
            # reading takes time: only a version that may hold the same fit is read
            if history[0].digest == digest or history[0].inputs == inputs:
                stored = self.entry(table.name, version).stored
                if stored and is_same_fit(stored.table, table):
                    return replace(stored, existed=True)
        return None
