"""The store: versions of tables that are written once, and the journal of their states.

`calib.store.folders` has the places, the page `tables` of the manual the promises. A version exists
once the journal has its line. A writer that is stopped before leaves a folder that the next writer
deletes; one that is stopped after it leaves a version that the next writer moves to its place.
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
    NEW,
    checked_name,
    folder_of,
    names_in,
    path_of,
    place,
    refuse_link,
    unplaced,
)
from calib.store.journal import CHANGED, STORED, Journal, read_journal, write_journal
from calib.store.snapshot import Snapshot, StoreEntry
from calib.store.state import StateDecision, is_new
from calib.store.version import Stored, read_version, write_version
from calib.table.compare import inputs
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

    def save(self, table: Table, decision: StateDecision | None = None) -> Stored:
        """Write ``table`` as the next version of its name, or return the one that holds it.

        A new version is a draft by default. Raises StoreError, and stores nothing, for a table that
        is not sound, a state that may not follow, or a store that cannot be written.
        """
        _require_storable(table)
        with self._writing(table.name) as now:
            same = now.identical(table)
            if same is not None:
                return self._judged(same, decision, now)
            return self._added(table, decision or StateDecision(), now)

    def foreseen(self, table: Table, decision: StateDecision) -> Stored:
        """The result of `save` if no other writer adds a version before. Raises as `save`."""
        _require_storable(table)
        with self._reading() as now:
            same, version = now.identical(table), now.next_number(table.name)
        if same and not is_new(same.id, same.state, decision):
            return same
        path = self.folder / table.name / folder_of(version)
        new = same or Stored(table, table.name, version, table.digest, path)
        event = CHANGED if same else STORED
        journal = now.journal.added(new.name, new.version, event, decision)
        return replace(new, state=journal.state(new.name, new.version))

    def judge(self, reference: str, decision: StateDecision) -> Stored:
        """Change the state of ``name@version``. Raises TableNotFound, DamagedTable, StoreError."""
        with self.changing(reference) as (now, stored):
            return self._judged(stored, decision, now)

    def withdraw_missing(self, reference: str, decision: StateDecision) -> bool:
        """Withdraw a version whose folder is missing; otherwise do nothing and return False."""
        name, version = self.now().numbered(reference)
        if place(self.folder / name, version):
            return False
        with self._writing(name) as now:
            if is_new(reference, now.journal.state(name, version), decision):
                write_journal(self.folder, now.journal.added(name, version, CHANGED, decision))
        return True

    def load(self, reference: str) -> Stored:
        """Read and verify ``name@version``, or the version at a path.

        A bare ``name`` is its newest version that is neither rejected nor withdrawn. Raises
        TableNotFound, DamagedTable, StoreError.
        """
        return self._find(reference, released=False)

    def released(self, reference: str) -> Stored:
        """`load`, where a bare ``name`` is its newest released version."""
        return self._find(reference, released=True)

    def now(self) -> Snapshot:
        """The store as it is at this moment. Raises DamagedTable."""
        with self._reading() as now:
            return now

    def entries(self, state: str | None = None) -> Iterator[StoreEntry]:
        """Each version of the store, or each in a ``state``, by name and version.

        Tables are read one at a time. Raises TableNotFound, DamagedTable.
        """
        wanted = state.lower() if state else None
        with self._reading() as now:
            for name in now.names:
                for version in now.journal.versions(name):
                    if wanted in (None, now.journal.word(name, version)):
                        yield now.entry(name, version)

    def verify(
        self, name: str | None = None, also: Callable[[StoreEntry], StoreEntry] = lambda x: x
    ) -> tuple[StoreEntry, ...]:
        """Compare the versions of one table or all with digests, invariants and journal.

        One entry for each version, and each folder that is not in the journal, without its table;
        ``also`` gets each entry with the table, one at a time.
        """
        with self._reading() as now:
            every = (
                [now.require_table(name)] if name else sorted({*now.names, *names_in(self.folder)})
            )
            each = (now.verified(table, v) for table in every for v in now.with_strays(table))
            return tuple(replace(also(entry), stored=None) for entry in each)

    @contextmanager
    def changing(self, reference: str) -> Iterator[tuple[Snapshot, Stored]]:
        """The locked store, and its version ``name@version`` to be changed."""
        name, version = self.now().numbered(reference)  # before anything is made
        with self._writing(name) as now:
            yield now, now.load(name, version)

    def _find(self, reference: str, released: bool) -> Stored:
        path = path_of(reference)
        store = self if path is None else Store(path.resolve().parent.parent)
        with store._reading() as now:
            return now.find(reference, released)

    def _added(self, table: Table, decision: StateDecision, now: Snapshot) -> Stored:
        """Write the new version aside, enter it in the journal, move it to its place."""
        _refuse_same_folder(table.name, now.names)
        version = now.next_number(table.name)
        final = self.folder / table.name / folder_of(version)
        work = final.with_name(f"{NEW}{final.name}")

        try:
            write_version(table, version, work)
            stored = read_version(work, f"{table.name}@{version}")
            fields = {"digest": stored.digest, "record": stored.record}
            fields["inputs"] = inputs(table.content()[0])
            journal = now.journal.added(table.name, version, STORED, decision, **fields)
            write_journal(self.folder, journal)
        except BaseException:
            if version not in read_journal(self.folder).versions(table.name):
                shutil.rmtree(work, ignore_errors=True)
                with suppress(OSError):
                    work.parent.rmdir()  # if it is empty
            raise
        with suppress(OSError):  # it is stored: the next writer can move it as well
            os.rename(work, final)
            work = final
            sync(final.parent)
        return replace(stored, path=work, state=journal.state(table.name, version))

    def _judged(self, stored: Stored, decision: StateDecision | None, now: Snapshot) -> Stored:
        if decision is None or not is_new(stored.id, stored.state, decision):
            return stored
        journal = now.journal.added(stored.name, stored.version, CHANGED, decision)
        write_journal(self.folder, journal)
        return replace(stored, state=journal.state(stored.name, stored.version))

    @contextmanager
    def _writing(self, name: str) -> Iterator[Snapshot]:
        try:
            with locked_folder(self.folder):
                refuse_link(self.folder / name)
                now = Snapshot(self.folder, read_journal(self.folder))
                _ = now.names  # refuses versions without a journal
                _tidy(self.folder, name, now.journal)
                yield now
        except OSError as error:
            flaw, where = f"cannot be written ({error.strerror or error})", error.filename
            raise StoreError(flaw, where=where or self.folder, do="nothing was stored") from error

    @contextmanager
    def _reading(self) -> Iterator[Snapshot]:
        try:
            yield Snapshot(self.folder, read_journal(self.folder))
        except OSError as error:
            raise StoreError(f"cannot be read ({error.strerror})", where=self.folder) from error


def _require_storable(table: Table) -> None:
    checked_name(table.name)
    if flaws := violations(table):
        flaw = f"the table is not sound and was not stored: {'; '.join(flaws)}"
        expected = "a table that `brake-cal tables verify` passes"
        raise StoreError(flaw, where=table.name, expected=expected)


def _refuse_same_folder(name: str, names: Sequence[str]) -> None:
    same = [other for other in names if other.lower() == name.lower()]
    if same and name not in same:
        raise StoreError(
            f"the store has a table {same[0]!r}, whose folder is the same on Windows and macOS",
            where=name,
            expected="a name that differs by more than upper and lower case",
            do=f"write {same[0]!r} in the vehicle file, or choose another name",
        )


def _tidy(folder: Path, table: str, journal: Journal) -> None:
    """Finish or undo the work of stopped writers, under the lock. Raises OSError."""
    for path in (*folder.glob(".*.new"), *(folder / table).glob(".*.new")):
        path.unlink(missing_ok=True)
    for path in unplaced(folder, table):
        final = path.with_name(path.name.removeprefix(NEW))
        if path.is_symlink():
            path.unlink()  # nobody knows where it leads
        elif final.name in map(folder_of, journal.versions(table)) and not final.exists():
            os.rename(path, final)
        else:
            shutil.rmtree(path)
