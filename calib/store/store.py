"""The store: versions of tables that are written once, and the journal of their states.

`calib.store.folders` has the names of all files. What the store promises is in the manual, on the
page `tables`. A version exists as soon as the journal has a line of it. If a writer stops before
that line, the next writer deletes the folder of the version. If it stops after that line, the next
writer gives the folder its final name.
"""

import os
import shutil
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path

from calib.base.errors import StoreError
from calib.base.write import locked_folder, sync
from calib.store.folders import (
    NEW_PREFIX,
    checked_name,
    existing_folder,
    folder_of,
    names_in,
    path_of,
    refuse_link,
    unplaced,
)
from calib.store.journal import CHANGED, STORED, Journal, read_journal, write_journal
from calib.store.snapshot import Snapshot, StoreEntry
from calib.store.state import DRAFTED, StateDecision, changes_state
from calib.store.version import Stored, read_version, write_version
from calib.table.compare import inputs_digest
from calib.table.invariants import violations
from calib.table.table import Table


class Store:
    """The tables in ``folder``, which the first `save` makes.

    >>> import tempfile
    >>> import calib
    >>> logs = calib.sample_logs() / "simulation_study"
    >>> car = calib.read_vehicle(logs / "vehicle.toml")
    >>> table = calib.fit(car, [calib.read_log(logs / "ramp_noisy.parquet")])
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     store = calib.Store(folder)
    ...     again = [store.save(table).id for _ in range(2)]  # one content is one version
    ...     loaded = store.load("sedan-sim")
    ...     sound = [verdict.sound for verdict in store.verify()]
    >>> again, sound, loaded.state.word, loaded.digest == table.digest
    (['sedan-sim@1', 'sedan-sim@1'], [True], 'draft', True)
    """

    def __init__(self, folder: Path | str) -> None:
        self.folder = Path(folder)

    def __repr__(self) -> str:
        return f"Store({str(self.folder)!r})"

    def save(self, table: Table, decision: StateDecision = DRAFTED) -> Stored:
        """Write ``table`` as the next version of its name, or return the version that holds it.

        Raises StoreError, and stores nothing, for a table that is not sound, a state that may not
        follow, or a store that cannot be written.
        """
        _require_storable(table)
        with self._locked(table.name) as snapshot:
            same = snapshot.identical(table)
            if same is not None:
                return self._with_decision(same, decision, snapshot)
            return self._with_version(table, decision, snapshot)

    def preview(self, table: Table, decision: StateDecision) -> Stored:
        """Return what `save` would return now, and write nothing. Raises as `save`."""
        _require_storable(table)
        with self._unlocked() as snapshot:
            same, version = snapshot.identical(table), snapshot.next_number(table.name)
        if same and not changes_state(same.id, same.state, decision):
            return same
        path = self.folder / table.name / folder_of(version)
        stored = same or Stored(table, table.name, version, table.digest, path)
        event = CHANGED if same else STORED
        journal = snapshot.journal.added(stored.name, stored.version, event, decision)
        return replace(stored, state=journal.state(stored.name, stored.version))

    def judge(self, reference: str, decision: StateDecision) -> Stored:
        """Change the state of ``name@version``. Raises TableNotFound, DamagedTable, StoreError."""
        with self.changing(reference) as (snapshot, stored):
            return self._with_decision(stored, decision, snapshot)

    def withdraw_missing(self, reference: str, decision: StateDecision) -> bool:
        """Withdraw ``name@version`` if its folder is missing; return whether it is missing."""
        name, version = self.snapshot().numbered(reference)
        if existing_folder(self.folder / name, version):
            return False
        with self._locked(name) as snapshot:
            journal = snapshot.journal
            if changes_state(reference, journal.state(name, version), decision):
                write_journal(self.folder, journal.added(name, version, CHANGED, decision))
        return True

    def load(self, reference: str) -> Stored:
        """Read and verify ``name@version``, or the version at a path.

        A bare ``name`` is its newest version that is neither rejected nor withdrawn. Raises
        TableNotFound, DamagedTable, StoreError.
        """
        return self._find(reference, released=False)

    def released(self, reference: str) -> Stored:
        """Read a version as `load` does, but for a bare ``name`` the newest released version."""
        return self._find(reference, released=True)

    def snapshot(self) -> Snapshot:
        """Return the store as it is at this moment. Raises DamagedTable."""
        with self._unlocked() as snapshot:
            return snapshot

    def entries(self, state: str | None = None) -> Iterator[StoreEntry]:
        """Yield each version of the store, or each in a ``state``, by name and version.

        Each table is read when it is yielded. Raises TableNotFound, DamagedTable.
        """
        wanted = state.lower() if state else None
        with self._unlocked() as snapshot:
            for name in snapshot.names:
                for version in snapshot.journal.versions(name):
                    if wanted in (None, snapshot.journal.word(name, version)):
                        yield snapshot.entry(name, version)

    def verify(
        self,
        name: str | None = None,
        examine: Callable[[StoreEntry], StoreEntry] = lambda entry: entry,
    ) -> tuple[StoreEntry, ...]:
        """Compare the versions of one table, or of all, with digests, invariants and journal.

        Return an entry without its table for each version, and for each folder that the journal
        does not know. ``examine`` gets an entry while it has its table, and returns it completed.
        """
        with self._unlocked() as snapshot:
            all_names = {*snapshot.names, *names_in(self.folder)}
            names = [snapshot.require_table(name)] if name else sorted(all_names)
            entries = (
                snapshot.verified(table_name, version)
                for table_name in names
                for version in snapshot.with_strays(table_name)
            )
            return tuple(replace(examine(entry), stored=None) for entry in entries)

    @contextmanager
    def changing(self, reference: str) -> Iterator[tuple[Snapshot, Stored]]:
        """Lock the store, and yield its snapshot and its version ``name@version``."""
        name, version = self.snapshot().numbered(reference)  # raises before the lock is made
        with self._locked(name) as snapshot:
            yield snapshot, snapshot.load(name, version)

    def _find(self, reference: str, released: bool) -> Stored:
        path = path_of(reference)
        store = self if path is None else Store(path.resolve().parent.parent)  # perhaps another
        with store._unlocked() as snapshot:
            return snapshot.find(reference, released)

    def _with_version(self, table: Table, decision: StateDecision, snapshot: Snapshot) -> Stored:
        """Write a version under its new name, enter it in the journal, give it its final name."""
        _refuse_same_folder(table.name, snapshot.names)
        version = snapshot.next_number(table.name)
        final = self.folder / table.name / folder_of(version)
        path = final.with_name(f"{NEW_PREFIX}{final.name}")

        try:
            write_version(table, version, path)
            stored = read_version(path, f"{table.name}@{version}")
            digests = {"digest": stored.digest, "record": stored.record_digest}
            digests["inputs"] = inputs_digest(table.content()[0])
            journal = snapshot.journal.added(table.name, version, STORED, decision, **digests)
            write_journal(self.folder, journal)
        except BaseException:  # also an interrupt
            if version not in read_journal(self.folder).versions(table.name):
                shutil.rmtree(path, ignore_errors=True)
                with suppress(OSError):
                    path.parent.rmdir()  # if it is empty
            raise
        with suppress(OSError):  # the version exists; the next writer can rename it, too
            os.rename(path, final)
            path = final
            sync(final.parent)
        return replace(stored, path=path, state=journal.state(table.name, version))

    def _with_decision(self, stored: Stored, decision: StateDecision, snapshot: Snapshot) -> Stored:
        """Enter a decision in the journal if it changes the state; return the judged version."""
        if not changes_state(stored.id, stored.state, decision):
            return stored
        journal = snapshot.journal.added(stored.name, stored.version, CHANGED, decision)
        write_journal(self.folder, journal)
        return replace(stored, state=journal.state(stored.name, stored.version))

    @contextmanager
    def _locked(self, name: str) -> Iterator[Snapshot]:
        """Lock the store for a writer of the table ``name``. Raises StoreError for an OSError."""
        try:
            with locked_folder(self.folder):
                refuse_link(self.folder / name)
                snapshot = Snapshot(self.folder, read_journal(self.folder))
                snapshot.require_journal()
                _tidy(self.folder, name, snapshot.journal)
                yield snapshot
        except OSError as error:
            flaw, where = f"cannot be written ({error.strerror or error})", error.filename
            raise StoreError(flaw, where=where or self.folder, do="nothing was stored") from error

    @contextmanager
    def _unlocked(self) -> Iterator[Snapshot]:
        """Read the store without a lock. Raises StoreError for an OSError."""
        try:
            yield Snapshot(self.folder, read_journal(self.folder))
        except OSError as error:
            raise StoreError(f"cannot be read ({error.strerror})", where=self.folder) from error


def _require_storable(table: Table) -> None:
    checked_name(table.name)
    flaws = violations(table)
    if flaws:
        flaw = f"the table is not sound and was not stored: {'; '.join(flaws)}"
        expected = "a table that `brake-cal tables verify` passes"
        raise StoreError(flaw, where=table.name, expected=expected)


def _refuse_same_folder(name: str, names: Sequence[str]) -> None:
    """Raise StoreError if ``name`` is new and differs from one of ``names`` only by its case."""
    same = [other for other in names if other.lower() == name.lower()]
    if same and name not in same:
        flaw = f"the store has a table {same[0]!r}, whose folder is the same on Windows and macOS"
        expected = "a name that differs by more than upper and lower case"
        do = f"write {same[0]!r} in the vehicle file, or choose another name"
        raise StoreError(flaw, where=name, expected=expected, do=do)


def _tidy(folder: Path, table: str, journal: Journal) -> None:
    """Finish or delete what stopped writers left; the store is locked. Raises OSError."""
    for path in (*folder.glob(".*.new"), *(folder / table).glob(".*.new")):
        path.unlink(missing_ok=True)  # half of a file of `write_whole`
    stored_folders = [folder_of(version) for version in journal.versions(table)]
    for path in unplaced(folder, table):
        final = path.with_name(path.name.removeprefix(NEW_PREFIX))
        if path.is_symlink():
            path.unlink()  # the link only, wherever it leads
        elif final.name in stored_folders and not final.exists():
            os.rename(path, final)
        else:
            shutil.rmtree(path)
