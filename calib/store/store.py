"""The store: versions of tables that are written once, and the journal of their states.

`calib.store.folders` says where they lie, `calib.store.commit` how they get there. What the store
promises is on the page `tables` of the manual.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from calib.base.errors import StoreError
from calib.base.program import PROGRAM
from calib.store.commit import (
    commit,
    commit_signature,
    discard,
    read_journal,
    tidy,
    write_journal,
    write_version,
)
from calib.store.folders import checked_name, names_in, path_of, placed_in, unplaced, versions_in
from calib.store.journal import ADOPTED, CHANGED, FIRST, JOURNAL, SIGNED, STORED, Journal
from calib.store.lock import locked
from calib.store.minisign_keys import SecretKey
from calib.store.signature import Signed, anchored, signed
from calib.store.snapshot import Snapshot, StoreEntry
from calib.store.state import StateDecision, next_state
from calib.store.version import Stored, read_version
from calib.table.invariants import violations
from calib.table.same import inputs
from calib.table.table import Table


@dataclass(frozen=True)
class StoreVerdict:
    """Result of `verify` for one version: its violations in words, none when it is sound."""

    id: str
    violations: tuple[str, ...]

    @property
    def sound(self) -> bool:
        """Whether there are no violations."""
        return not self.violations


class Store:
    """A folder of tables; ``folder`` is its path, and is made by the first `save`.

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
        """Write ``table`` as the next version of its name, or return the one that holds it already.

        ``decision`` gives its state; without one a new version is a draft, and one that was there
        keeps its state. Raises StoreError when the name is not valid, the table is not sound, the
        state may not follow that of the version, or the store cannot be written; the store is then
        not changed.
        """
        _require_storable(table)
        with self._writing():
            now = self._with_older(self._snapshot())
            known = now.identical(table)
            if known is not None:
                return self._judged(known, decision, now)
            tidy(self.folder, now.journal)
            version = now.next_number(table.name)
            work = write_version(self.folder, table, version)
            try:
                stored = read_version(work, f"{table.name}@{version}")
                journal = _entered(STORED, stored, decision or StateDecision(), now.journal)
            except BaseException:
                discard(work)
                raise
            commit(self.folder, journal, work)
            return Snapshot(self.folder, journal).load(table.name, version)

    def judge(self, reference: str, decision: StateDecision) -> Stored:
        """Change the state of ``name@version``.

        Raises TableNotFound when there is no such version, DamagedTable when it is damaged,
        StoreError when the state may not follow the present one or the store cannot be written.
        """
        with self._changing(reference) as (now, stored):
            return self._judged(stored, decision, now)

    def withdraw_missing(self, reference: str, decision: StateDecision) -> bool:
        """Withdraw a version whose folder is gone, so that `verify` no longer counts it as missing.

        Returns False, and does nothing, where the folder is there. Raises TableNotFound when there
        never was such a version, StoreError when the store cannot be written.
        """
        name, _, version = reference.partition("@")
        with self._reading():
            now = self._snapshot()
            if not now.is_missing(name, now.number(name, version)):
                return False
        with self._writing():
            journal = read_journal(self.folder)
            first = journal.of(name)[int(version)][0]
            before = journal.state(name, int(version))
            if next_state(reference, before, decision) == before:
                return True
            tidy(self.folder, journal)
            entered = journal.added(
                CHANGED, name, int(version), first.digest, first.record, decision, program=PROGRAM
            )
            write_journal(self.folder, entered)
        return True

    def sign(self, reference: str, key: SecretKey, by: str = "") -> Signed:
        """Sign the record and the state of ``name@version``, and enter that in the journal.

        The signature covers the head of the journal before that line. It takes the place of an
        older one of the same key. Raises as `judge`; SignatureRefused when a signature of the key
        is over a journal that this one does not contain.
        """
        with self._changing(reference) as (now, stored):
            anchored(now, key.public)
            made = signed(now, stored, key)
            decision = StateDecision(stored.state.word, by=by)
            journal = _entered(SIGNED, stored, decision, now.journal, key.key_id)
            tidy(self.folder, now.journal)
            if read_journal(self.folder) != now.journal:
                write_journal(self.folder, now.journal)  # with the versions older than it
            commit_signature(self.folder, journal, made.path, made.content)
            return made

    def foreseen(self, table: Table, decision: StateDecision | None = None) -> Stored:
        """What `save` will return if no other writer adds a version before; writes nothing.

        Raises StoreError as `save` does.
        """
        from calib.store.record_file import from_content

        _require_storable(table)
        with self._reading():
            now = self._with_older(self._snapshot())
            known = now.identical(table)
            if known is not None:
                state = next_state(known.id, known.state, decision)
                return replace(known, state=replace(state, stored_at=known.state.stored_at))
            version = now.next_number(table.name)
        read, path = from_content(*table.content()), placed_in(self.folder, table.name, version)
        state = (decision or StateDecision()).as_state()
        return Stored(read, table.name, version, table.digest, path, state=state)

    def load(self, reference: str) -> Stored:
        """Read and verify a table, to look at it or to judge it.

        ``name`` is its newest version that is neither rejected nor withdrawn, ``name@version`` that
        version whatever its state, or a path to a version. Raises TableNotFound when there is none,
        StoreError when no version of the name may be meant, DamagedTable when it does not agree
        with its digests or with the journal.
        """
        return self._find(reference, released=False)

    def released(self, reference: str) -> Stored:
        """Read and verify a table, to hand it out or to measure others by it.

        As `load`, but ``name`` is its newest released version.
        """
        return self._find(reference, released=True)

    def journal(self, name: str | None = None) -> Journal:
        """The journal, of the whole store; with the versions that are older than it.

        Raises TableNotFound when there is no store, or no table ``name``; DamagedTable when the
        journal was changed.
        """
        with self._reading():
            now = self._snapshot()
            if name is not None:
                now.known(name)
            return self._with_older(now).journal if now.names else now.journal

    def now(self) -> Snapshot:
        """The store as it is at this moment. Raises as `journal`."""
        with self._reading():
            return self._snapshot()

    def list(self) -> tuple[StoreEntry, ...]:
        """Every version in the store, by name and version.

        Raises TableNotFound when there is no store, StoreError when it cannot be read.
        """
        with self._reading():
            now = self._snapshot()
            return tuple(now.entry(name, v) for name in now.names for v in now.versions(name))

    def verify(self, name: str | None = None) -> tuple[StoreVerdict, ...]:
        """Compare versions with digests, invariants and journal, of one table or of all.

        One verdict per version that is or ever was, and one for each that the journal does not
        know. Raises TableNotFound when there is no store, or no table of that name; DamagedTable
        when the journal cannot be trusted.
        """
        with self._reading():
            now = self._snapshot()
            names = {*now.names, *names_in(self.folder)} if name is None else {now.known(name)}
            return tuple(
                StoreVerdict(f"{one}@{version}", now.flaws(one, version))
                for one in sorted(names)
                for version in now.with_strays(one)
            )

    def unfinished(self) -> tuple[Path, ...]:
        """Folders that a writer has begun, or that a stopped one left; the next writer clears."""
        return tuple(unplaced(self.folder))

    def _find(self, reference: str, released: bool) -> Stored:
        path = path_of(reference)
        store = self if path is None else Store(path.resolve().parent.parent)
        with store._reading():
            return store._snapshot().find(reference, released)

    def _snapshot(self) -> Snapshot:
        return Snapshot(self.folder, read_journal(self.folder))

    def _with_older(self, now: Snapshot) -> Snapshot:
        """The store with the versions that are older than the journal, where it is still empty.

        Raises DamagedTable where one of them is not older: then the journal is missing.
        """
        journal = now.journal
        if journal.entries:
            return now
        for name in names_in(self.folder):
            for version in versions_in(self.folder / name):
                entry = now.entry(name, version)
                if entry.stored is not None:
                    journal = _entered(ADOPTED, entry.stored, StateDecision(), journal)
                elif JOURNAL in entry.flaw:
                    now.load(name, version)
        return Snapshot(self.folder, journal)

    def _judged(self, stored: Stored, decision: StateDecision | None, now: Snapshot) -> Stored:
        """Enter a change of state, unless it is one that the journal has already."""
        if decision is None or next_state(stored.id, stored.state, decision) == stored.state:
            return stored
        journal = _entered(CHANGED, stored, decision, now.journal)
        tidy(self.folder, now.journal)
        write_journal(self.folder, journal)
        return replace(stored, state=journal.state(stored.name, stored.version))

    @contextmanager
    def _changing(self, reference: str) -> Iterator[tuple[Snapshot, Stored]]:
        """The store, locked, and the version ``name@version`` of it, which will change."""
        name, _, version = reference.partition("@")
        with self._reading():
            self._snapshot().number(name, version)  # before anything is made
        with self._writing():
            now = self._with_older(self._snapshot())
            yield now, now.load(name, now.number(name, version))

    @contextmanager
    def _writing(self) -> Iterator[None]:
        try:
            with locked(self.folder):
                yield
        except OSError as error:
            raise StoreError(
                f"cannot be written ({error.strerror})", where=self.folder, do="nothing was stored"
            ) from error

    @contextmanager
    def _reading(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            raise StoreError(f"cannot be read ({error.strerror})", where=self.folder) from error


def _require_storable(table: Table) -> None:
    checked_name(table.name)
    if found := violations(table):
        raise StoreError(
            f"the table is not sound and was not stored: {'; '.join(found)}",
            where=table.name,
            expected="a table that `brake-cal tables verify` passes",
        )


def _entered(
    event: str, stored: Stored, decision: StateDecision, journal: Journal, key: str = ""
) -> Journal:
    """The journal with an event of a version."""
    given = inputs(stored.table.content()[0]) if event in FIRST else ""
    return journal.added(
        event, stored.name, stored.version, stored.digest, stored.record, decision,
        inputs=given, key=key, program=PROGRAM,
    )  # fmt: skip
