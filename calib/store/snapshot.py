"""A store at one moment; each read compares digests of a version, its place, and the journal."""

from dataclasses import dataclass, replace
from pathlib import Path

from calib.base.errors import DamagedTable, StoreError, TableNotFound
from calib.base.toml import did_you_mean
from calib.store.folders import checked_name, names_in, numbers, path_of, place, versions_in
from calib.store.journal import JOURNAL, Journal
from calib.store.state import DRAFT, RELEASED, WITHDRAWN, VersionState
from calib.store.version import Stored, read_version
from calib.table.compare import inputs, same
from calib.table.invariants import violations
from calib.table.table import Table


@dataclass(frozen=True)
class StoreEntry:
    """One version; ``stored`` is None if it cannot be read (see ``violations``) or is not kept.

    ``signed``: the state in its valid signature, if a key was given.
    """

    name: str
    version: int
    state: VersionState
    stored: Stored | None
    violations: tuple[str, ...] = ()
    signed: str | None = None

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
        """Names of the tables, in order.

        Raises TableNotFound where there is no store, DamagedTable for versions without a journal.
        """
        if not self.folder.is_dir():
            do = "`brake-cal fit` makes one, --store names another"
            raise TableNotFound("no table store here", where=self.folder, do=do)
        if not self.journal.entries and names_in(self.folder):
            flaw = "missing, and versions are there whose state it knew"
            raise DamagedTable(flaw, where=self.folder / JOURNAL)
        return sorted(self.journal.tables)

    def require_table(self, name: str) -> str:
        """Return ``name`` if the store has a table of that name. Raises TableNotFound."""
        names = self.names
        if checked_name(name) in names or versions_in(self.folder / name):
            return name
        is_file = "a file of that name is here: give the table first, then the logs"
        expected = "one of " + ", ".join(names) if names else "a table: the store is empty"
        do = did_you_mean(name, names) or is_file * Path(name).is_file()
        raise TableNotFound(f"no table {name!r}", where=self.folder, expected=expected, do=do)

    def with_strays(self, name: str) -> list[int]:
        """Numbers of all versions in the journal, and of folders that are not in it."""
        return sorted({*self.journal.versions(name), *versions_in(self.folder / name)})

    def next_number(self, name: str) -> int:
        """The number after all versions, files and folders."""
        return 1 + max([*self.journal.versions(name), *numbers(self.folder / name)], default=0)

    def find(self, reference: str, released: bool = False) -> Stored:
        """Read the version of a reference; a bare name as in `Store.load`."""
        path = path_of(reference)
        if path is not None:
            stored = read_version(path)
            inside = place(self.folder / stored.name, stored.version)
            if inside and inside.resolve() == path.resolve():
                return self.load(stored.name, stored.version)
            return stored
        if "@" in reference:
            return self.load(*self.numbered(reference))
        name = self.require_table(reference)
        states = {v: self.journal.word(name, v) for v in self.journal.versions(name)}
        wanted = (RELEASED,) if released else (RELEASED, DRAFT)
        if fit := [version for version, word in states.items() if word in wanted]:
            return self.load(name, max(fit))
        others = ", ".join(f"{name}@{version} {word}" for version, word in states.items())
        release = f"release one: `brake-cal tables release {name}@N --reason ...`"
        raise StoreError(
            f"{name} has no {'released' if released else 'usable'} version; there is {others}",
            do=release if released else f"name the one that you mean, such as {name}@{max(states)}",
        )

    def numbered(self, reference: str) -> tuple[str, int]:
        """Name and version of ``name@version``. Raises TableNotFound."""
        name, _, version = reference.partition("@")
        versions = self.with_strays(self.require_table(name))
        if version.isascii() and version.isdecimal() and int(version) in versions:
            return name, int(version)
        expected = f"one of {', '.join(map(str, versions))}"
        raise TableNotFound(
            f"no version {version!r} of {name!r}", where=self.folder, expected=expected
        )

    def load(self, name: str, version: int) -> Stored:
        """Read a version. Raises DamagedTable where digests, place and journal do not agree."""
        id_ = f"{name}@{version}"
        path = place(self.folder / checked_name(name), version)
        if path is None:
            raise DamagedTable("missing: it was stored, and its folder is not there", where=id_)
        stored = read_version(path, id_)
        if version not in self.journal.versions(name):
            flaw = "not in the journal: it was copied here, or the journal was set back"
            do = "restore the journal from a copy, or move the version out of the store"
            raise DamagedTable(flaw, where=id_, do=do)
        first = self.journal.versions(name)[version][0]
        if (first.digest, first.record) != (stored.digest, stored.record):
            flaw = "replaced or edited: it is not what was stored as this version"
            expected = f"digest {first.digest[:12]}, it has {stored.digest[:12]}"
            raise DamagedTable(flaw, where=id_, expected=expected)
        return replace(stored, state=self.journal.state(name, version))

    def entry(self, name: str, version: int) -> StoreEntry:
        """A version, whether it can be read or not."""
        state = self.journal.state(name, version)
        try:
            return StoreEntry(name, version, state, self.load(name, version))
        except StoreError as error:
            return StoreEntry(name, version, state, None, (error.problem,))

    def verified(self, name: str, version: int) -> StoreEntry:
        """`entry` with the violations of its table; a withdrawn version may be missing."""
        entry = self.entry(name, version)
        if entry.stored:
            return replace(entry, violations=violations(entry.stored.table))
        given_up = entry.state.word == WITHDRAWN and not place(self.folder / name, version)
        return replace(entry, violations=()) if given_up else entry

    def identical(self, table: Table) -> Stored | None:
        """The newest undamaged version that holds the same table, or None."""
        fitted_from, digest = inputs(table.content()[0]), table.digest
        for version, history in reversed(self.journal.versions(table.name).items()):
            if history[0].digest == digest or history[0].inputs == fitted_from:
                stored = self.entry(table.name, version).stored
                if stored and same(stored.table, table):
                    return replace(stored, existed=True)
        return None
