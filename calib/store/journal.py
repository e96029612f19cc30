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
from collections.abc import Iterable
from dataclasses import asdict, dataclass, fields, replace
from datetime import UTC, datetime
from functools import cached_property
from typing import Any

from calib.base.digest import canonical_json
from calib.base.errors import DamagedTable
from calib.store.minisign import STATES
from calib.store.state import CHANGES, Evidence, StateDecision, VersionState

JOURNAL, HEAD = "journal.jsonl", "journal.head"

STORED, ADOPTED, CHANGED, SIGNED = "stored", "adopted", "changed", "signed"
FIRST = (STORED, ADOPTED)
"""Events with which the journal learns of a version; adopted: older than the journal."""

START = "0" * 64
"""Head of an empty journal."""


@dataclass(frozen=True)
class Entry:
    """One line of the journal.

    ``number`` from 1; ``at`` ISO 8601 in UTC; ``event`` stored, adopted, changed or signed;
    ``state`` of the version afterwards; ``digest`` of its content and ``record`` the SHA-256 of
    its record file; ``inputs`` digest of what it was fitted from, of an entry that adds a version;
    ``key`` that signed.
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

    def line(self) -> bytes:
        """The entry as a line of the file."""
        return canonical_json(asdict(self)) + b"\n"


KINDS = {field.name: field.type for field in fields(Entry) if field.type in (int, str)}
"""Type of each field that is a single value."""


@dataclass(frozen=True)
class Journal:
    """All entries in order. An empty one is that of a new store."""

    entries: tuple[Entry, ...] = ()

    @property
    def head(self) -> str:
        """Hash of the last entry."""
        return self.entries[-1].hash if self.entries else START

    def line_of(self, head: str) -> int:
        """Number of the line with the hash ``head``; 0 where there is none."""
        return next((e.number for e in self.entries if e.hash == head), 0)

    @cached_property
    def tables(self) -> dict[str, dict[int, tuple[Entry, ...]]]:
        """The entries of each version of each table, in order; numbers rise."""
        found: dict[str, dict[int, list[Entry]]] = {}
        for entry in self.entries:
            found.setdefault(entry.table, {}).setdefault(entry.version, []).append(entry)
        return {
            name: {version: tuple(of) for version, of in sorted(versions.items())}
            for name, versions in found.items()
        }

    def of(self, name: str) -> dict[int, tuple[Entry, ...]]:
        """The entries of each version of a table; empty for a table that it does not know."""
        return self.tables.get(name, {})

    def state(self, name: str, version: int) -> VersionState:
        """The state of a version. Raises KeyError for one that the journal does not know."""
        history = self.tables[name][version]
        told = [entry for entry in history if entry.event != SIGNED][-1]
        return VersionState(
            told.state,
            told.at,
            told.by,
            told.reason,
            told.verdict,
            told.evidence,
            stored_at=history[0].at if history[0].event == STORED else "",
            seen=frozenset(one.sha256 for entry in history for one in entry.evidence),
        )

    def added(
        self, event: str, name: str, version: int, digest: str, record: str,
        decision: StateDecision, *, inputs: str = "", key: str = "", program: str,
    ) -> "Journal":  # fmt: skip
        """The journal with one more entry."""
        entry = Entry(
            number=len(self.entries) + 1,
            at=datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ"),
            by=decision.person,
            program=program,
            event=event,
            table=name,
            version=version,
            state=decision.state,
            digest=digest,
            record=record,
            inputs=inputs,
            reason=decision.reason,
            verdict=decision.verdict,
            evidence=decision.evidence,
            key=key,
            previous=self.head,
            hash="",
        )
        return Journal((*self.entries, replace(entry, hash=_hash(asdict(entry)))))

    def content(self) -> bytes:
        """The bytes of the journal's file."""
        return b"".join(entry.line() for entry in self.entries)

    def head_content(self) -> bytes:
        """The bytes of the head's file."""
        return f"{self.head} {len(self.entries)}\n".encode()


def parse(data: bytes, head: bytes | None, where: object) -> Journal:
    """Read a journal; ``head`` the bytes of the head's file, None where there is none.

    A journal may be longer than its head says, by lines whose writer was stopped before it wrote
    the head. Raises DamagedTable that names the first line that is wrong.
    """
    if data and not data.endswith(b"\n"):
        raise damaged("torn: its last line has no end", where)
    entries: list[Entry] = []
    known: dict[str, Entry] = {}
    for number, line in enumerate(data.splitlines(), 1):
        entry = _entry(line, number, where)
        flaw = _flaw(entry, number, entries[-1].hash if entries else START, known.get(entry.id))
        if flaw:
            raise damaged(f"line {number}: {flaw}", where)
        known[entry.id] = entry
        entries.append(entry)
    _check_head(entries, head, where)
    return Journal(tuple(entries))


def damaged(what: str, where: object) -> DamagedTable:
    """The error for a journal that cannot be trusted."""
    return DamagedTable(what, where=where, do="restore journal and head from a copy of the store")


def without_duplicates(pairs: Iterable[tuple[str, Any]]) -> dict[str, Any]:
    """Hook of `json.loads` that refuses a key given twice. Raises ValueError."""
    document: dict[str, Any] = {}
    for key, value in pairs:
        if key in document:
            raise ValueError(f"key {key!r} is given twice")
        document[key] = value
    return document


def _entry(line: bytes, number: int, where: object) -> Entry:
    try:
        document = json.loads(line, object_pairs_hook=without_duplicates)
        evidence = tuple(Evidence(**one) for one in document["evidence"])
        entry = Entry(**{**document, "evidence": evidence})
        wrong = [name for name, kind in KINDS.items() if type(document[name]) is not kind]
        if wrong or canonical_json(document) != line:
            raise ValueError(f"{', '.join(wrong) or 'its spelling'} not as written")
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError) as error:
        raise damaged(f"line {number}: not an entry ({error})", where) from error
    return entry


def _flaw(entry: Entry, number: int, previous: str, before: Entry | None) -> str:
    """What is wrong with an entry after the ones before it, "" if nothing is."""
    if entry.hash != _hash(asdict(entry)):
        return "was changed: it does not agree with its hash"
    if entry.previous != previous or entry.number != number:
        return "does not follow the line before: a line was changed, lost or put in"
    if entry.event in FIRST:
        return f"{entry.id} is stored a second time" if before else ""
    if before is None:
        return f"{entry.id} was never stored"
    if (entry.digest, entry.record) != (before.digest, before.record):
        return f"{entry.id} is another table than the one that was stored"
    if entry.event == SIGNED:
        return "" if entry.state == before.state else "a signature does not change the state"
    if entry.event != CHANGED or entry.state not in STATES:
        return f"{entry.event} {entry.state}: no such event"
    allowed = entry.state in CHANGES[before.state]
    return "" if allowed else f"{entry.id} cannot become {entry.state} from {before.state}"


def _check_head(entries: list[Entry], head: bytes | None, where: object) -> None:
    if head is None:
        if entries:
            raise damaged(f"{HEAD} beside it is missing", where)
        return
    digest, _, count = head.decode(errors="replace").strip().partition(" ")
    number = int(count) if re.fullmatch(r"[0-9]{1,18}", count) else -1
    hashes = [START, *(entry.hash for entry in entries)]
    if number >= len(hashes):
        raise damaged(f"has {len(entries)} lines, its head names {number}: lines are lost", where)
    if number < 0 or hashes[number] != digest:
        raise damaged(f"does not agree with {HEAD}", where)


def _hash(entry: dict[str, Any]) -> str:
    return hashlib.sha256(canonical_json({**entry, "hash": ""})).hexdigest()
