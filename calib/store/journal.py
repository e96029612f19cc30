"""The journal of a store: one line for each thing that happened to a version, never changed.

    tables/journal.jsonl   {"number": 7, ..., "previous": <hash of line 6>, "hash": <of this line>}
    tables/journal.head    <hash of the last line> <number of lines>

``hash`` is the SHA-256 of the line's canonical JSON without ``hash``, and each line holds that of
the line before: a line that is changed, lost or put in breaks the chain. The head shows that lines
are missing at the end. Whoever can write both files can rewrite all of it; a signature over the
head (see `calib.store.signature`) is what shows that.
"""

import hashlib
import json
import re
from collections.abc import Callable
from dataclasses import asdict, dataclass, fields, replace
from datetime import UTC, datetime
from functools import cached_property
from pathlib import Path

from calib.base.bounded import JOURNAL as JOURNAL_FILE
from calib.base.bounded import read_bounded
from calib.base.digest import canonical_json
from calib.base.errors import DamagedTable
from calib.base.names import PROGRAM
from calib.base.write import sync, write_whole
from calib.store.state import (
    CHANGES,
    OUTSIDE,
    STATES,
    Evidence,
    StateDecision,
    VersionState,
    user,
)

JOURNAL, HEAD = "journal.jsonl", "journal.head"
ATTRIBUTES = ".gitattributes"
"""Says to git that the bytes of a store are to stay as they are."""
CRLF = (
    "its line ends are CRLF, which are not its own: git makes them of a store without the line "
    "`* -text` in its .gitattributes; add it and check the files out again"
)

EVENTS = STORED, CHANGED, SIGNED = "stored", "changed", "signed"

_START = "0" * 64
"""Head of an empty journal."""


@dataclass(frozen=True)
class Entry:
    """One line of the journal; ``number`` from 1, ``at`` ISO 8601 in UTC, ``state`` afterwards.

    ``digest`` of its content, ``record`` SHA-256 of its record file; ``inputs`` digest of what a
    new version was fitted from; ``key`` that signed.
    """

    number: int
    at: str
    by: str
    program: str
    event: str
    table: str
    version: int
    state: str
    digest: str
    record: str
    inputs: str
    reason: str
    verdict: str
    evidence: tuple[Evidence, ...]
    key: str
    previous: str
    hash: str

    @property
    def id(self) -> str:
        """name@version."""
        return f"{self.table}@{self.version}"


_KINDS = {field.name: field.type for field in fields(Entry) if field.type in (int, str)}


@dataclass(frozen=True)
class Journal:
    """All entries in order. An empty one is that of a new store."""

    entries: tuple[Entry, ...] = ()

    @property
    def head(self) -> str:
        """Hash of the last entry."""
        return self.entries[-1].hash if self.entries else _START

    @cached_property
    def tables(self) -> dict[str, dict[int, tuple[Entry, ...]]]:
        """The entries of each version of each table, in order; numbers rise."""
        found: dict[str, dict[int, tuple[Entry, ...]]] = {}
        for entry in sorted(self.entries, key=lambda e: (e.version, e.number)):
            of = found.setdefault(entry.table, {})
            of[entry.version] = (*of.get(entry.version, ()), entry)
        return found

    def of(self, name: str) -> dict[int, tuple[Entry, ...]]:
        """The entries of each version of a table; empty for a table that it does not know."""
        return self.tables.get(name, {})

    def state(self, name: str, version: int) -> VersionState:
        """The state of a version; `OUTSIDE` where the journal does not know it."""
        history = self.of(name).get(version)
        if not history:
            return OUTSIDE
        last = [entry for entry in history if entry.event != SIGNED][-1]
        return VersionState(
            last.state,
            last.at,
            last.by,
            last.reason,
            last.verdict,
            last.evidence,
            stored_at=history[0].at,
            seen=frozenset(one.sha256 for entry in history for one in entry.evidence),
        )

    def added(
        self, name: str, version: int, event: str, decision: StateDecision, **of: str
    ) -> "Journal":
        """The journal with one more entry; ``of`` other fields of a version that is new to it."""
        known = self.of(name).get(version)
        if known:
            of = {"digest": known[0].digest, "record": known[0].record, "inputs": ""} | of
        entry = Entry(
            number=len(self.entries) + 1,
            at=datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ"),
            by=decision.by or user(),
            program=PROGRAM,
            event=event,
            table=name,
            version=version,
            state=decision.state,
            reason=decision.reason,
            verdict=decision.verdict,
            evidence=decision.evidence,
            previous=self.head,
            hash="",
            **{"key": ""} | of,
        )
        return Journal((*self.entries, replace(entry, hash=_hash(entry))))

    @property
    def lines(self) -> bytes:
        """The bytes of the journal's file."""
        return b"".join(canonical_json(asdict(entry)) + b"\n" for entry in self.entries)

    @property
    def head_line(self) -> bytes:
        """The bytes of the head's file."""
        return f"{self.head} {len(self.entries)}\n".encode()


def read_journal(folder: Path) -> Journal:
    """The journal of a store; an empty one where there is none.

    It may be longer than its head says, by lines whose writer was stopped before it wrote the head.
    Raises DamagedTable that names the first line that is wrong, OSError.
    """
    # The head first: a writer may add a line between the two.
    head, data = _bytes(folder / HEAD), _bytes(folder / JOURNAL)
    try:
        entries = _entries(data or b"")
        _check_head(entries, head)
    except ValueError as error:
        raise DamagedTable(str(error), where=folder / JOURNAL) from error
    return Journal(tuple(entries))


def write_journal(folder: Path, journal: Journal) -> None:
    """Replace the journal by a longer one. Raises OSError."""
    if not (folder / HEAD).exists():  # a journal without a head is one whose head was lost
        write_whole(folder / ATTRIBUTES, b"* -text\n")
        write_whole(folder / HEAD, Journal().head_line)
    write_whole(folder / JOURNAL, journal.lines)
    write_whole(folder / HEAD, journal.head_line)
    sync(folder)


def enter(folder: Path, journal: Journal, undo: Callable[[], object]) -> None:
    """`write_journal`; ``undo`` what was made for it if it is not entered. Raises OSError."""
    try:
        write_journal(folder, journal)
    except BaseException:
        if _bytes(folder / JOURNAL) != journal.lines:
            undo()
        raise


def _bytes(path: Path) -> bytes | None:
    try:
        return read_bounded(path, JOURNAL_FILE)
    except FileNotFoundError:
        return None


def _entries(data: bytes) -> list[Entry]:
    """The entries of the journal's file. Raises ValueError."""
    if b"\r\n" in data:
        raise ValueError(CRLF)
    if data and not data.endswith(b"\n"):
        raise ValueError("torn: its last line has no end")
    entries: list[Entry] = []
    known: dict[str, Entry] = {}
    for number, line in enumerate(data.splitlines(), 1):
        try:
            entry = _entry(line)
        except (ValueError, TypeError, KeyError, AttributeError, RecursionError) as error:
            raise ValueError(f"line {number}: not an entry ({error})") from error
        flaw = _flaw(entry, number, entries[-1].hash if entries else _START, known.get(entry.id))
        if flaw:
            raise ValueError(f"line {number}: {flaw}")
        known[entry.id] = entry
        entries.append(entry)
    return entries


def _entry(line: bytes) -> Entry:
    document = json.loads(line)
    evidence = tuple(Evidence(**one) for one in document["evidence"])
    wrong = [name for name, kind in _KINDS.items() if type(document[name]) is not kind]
    if wrong or canonical_json(document) != line:
        raise ValueError(f"{', '.join(wrong) or 'its spelling'} not as written")
    return Entry(**{**document, "evidence": evidence})


def _flaw(entry: Entry, number: int, previous: str, before: Entry | None) -> str:
    """What is wrong with an entry after the ones before it, "" if nothing is."""
    if entry.hash != _hash(entry):
        return "was changed: it does not agree with its hash"
    if entry.previous != previous or entry.number != number:
        return "does not follow the line before: a line was changed, lost or put in"
    if entry.event not in EVENTS or entry.state not in STATES:
        return f"{entry.event} {entry.state}: no such event"
    if before is None or entry.event == STORED:
        fits = before is None and entry.event == STORED
    elif (entry.digest, entry.record) != (before.digest, before.record):
        return f"{entry.id} is another table than the one that was stored"
    else:
        same = entry.state == before.state
        fits = same if entry.event == SIGNED else entry.state in CHANGES[before.state]
    was = before.state if before else "never stored"
    return "" if fits else f"{entry.id} was {was} before {entry.event} {entry.state}"


def _check_head(entries: list[Entry], head: bytes | None) -> None:
    """Raise ValueError unless the head is that of one of the last lines."""
    if head is None:
        if entries:
            raise ValueError(f"{HEAD} beside it is missing")
        return
    digest, _, count = head.decode(errors="replace").strip().partition(" ")
    number = int(count) if re.fullmatch(r"[0-9]{1,18}", count) else -1
    hashes = [_START, *(entry.hash for entry in entries)]
    if number >= len(hashes):
        raise ValueError(f"has {len(entries)} lines, its head names {number}: lines are lost")
    if number < 0 or hashes[number] != digest:
        raise ValueError(f"does not agree with {HEAD}")


def _hash(entry: Entry) -> str:
    return hashlib.sha256(canonical_json({**asdict(entry), "hash": ""})).hexdigest()
