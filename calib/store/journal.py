"""The journal of a store: one line for each event of a version. A line is never changed.

    tables/journal.jsonl   {"number": 7, ..., "previous": <hash of line 6>, "hash": <of line 7>}
    tables/journal.head    <hash of the last line> <number of lines>

The hash of a line is the SHA-256 of its canonical JSON with an empty ``hash``. Each line holds the
hash of the previous line, so a changed, lost or inserted line breaks the chain. The head shows
whether lines are missing at the end. Only a signature of the head shows whether somebody rewrote
journal and head together, see `calib.store.signature`.
"""

import json
import re
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple, Self

from calib.base.bounded import JOURNAL as JOURNAL_KIND
from calib.base.bounded import read_bounded
from calib.base.digest import canonical_json, sha256
from calib.base.errors import DamagedTable
from calib.base.names import PROGRAM
from calib.base.write import sync, write_whole
from calib.store.state import CHANGES, OUTSIDE, Evidence, StateDecision, VersionState, user

JOURNAL, HEAD = "journal.jsonl", "journal.head"
CRLF_FLAW = (
    "its line ends are CRLF, not LF as they were written: git changes them in a store without the "
    "line `* -text` in its .gitattributes; add this line and check the files out again"
)

STORED, CHANGED = "stored", "changed"  # events: a version is new, its state changes
SIGNED = "signed"  # an event that older programs wrote; it changes no state
_START = "0" * 64  # head of an empty journal

_TEXT = r'"[^"\\]*+(?:\\.[^"\\]*+)*+"'  # a string of JSON
_EVIDENCE = rf'\{{"name":{_TEXT},"sha256":{_TEXT}\}}'
_LINE = re.compile(
    rf'\{{"at":{_TEXT},"by":{_TEXT},"digest":"(?P<digest>\w*)","event":"(?P<event>\w*)",'
    rf'"evidence":\[(?:{_EVIDENCE}(?:,{_EVIDENCE})*)?\],"hash":"(?P<hash>\w*)",'
    rf'"inputs":"(?P<inputs>\w*)","key":{_TEXT},"number":(?P<number>\d+),'
    rf'"previous":"(?P<previous>\w*)","program":{_TEXT},"reason":{_TEXT},'
    rf'"record":"(?P<record>\w*)","state":"(?P<state>\w*)","table":"(?P<table>[\w.-]*)",'
    rf'"verdict":{_TEXT},"version":(?P<version>\d{{1,9}})\}}',
    re.ASCII,
)
"""Pattern of a line, which is canonical JSON. A JSON parser would take ten times as long."""


class Entry(NamedTuple):
    """A ``line`` of the journal, with the fields that are often read."""

    line: str
    number: int  # from 1
    version: int
    digest: str  # of the table's content
    event: str
    hash: str
    inputs: str  # digest of logs, vehicle and settings
    previous: str  # hash of the previous line
    record: str  # SHA-256 of the record file
    state: str  # of the version after the event
    table: str

    @classmethod
    def read(cls, line: str) -> Self:
        """Read a line that agrees with its hash. Raises ValueError for any other line."""
        match = _LINE.fullmatch(line)
        if match is None:
            raise ValueError("not an entry as it is written")
        start, end = match.span("hash")
        if sha256((line[:start] + line[end:]).encode()) != match["hash"]:
            raise ValueError("was changed: it does not agree with its hash")
        fields: dict[str, Any] = match.groupdict()
        fields |= {"number": int(match["number"]), "version": int(match["version"])}
        return cls(line=line, **fields)

    @property
    def document(self) -> dict[str, Any]:
        """All fields of the line, such as ``at`` (UTC), ``by`` and ``reason``."""
        return dict(json.loads(self.line))


@dataclass(frozen=True)
class Journal:
    """All entries in order. A new store has none."""

    entries: Sequence[Entry] = ()

    @property
    def head(self) -> str:
        """The hash of the last entry."""
        return self.entries[-1].hash if self.entries else _START

    @cached_property
    def tables(self) -> dict[str, dict[int, list[Entry]]]:
        """The entries of each version of each table, oldest first; versions rise."""
        by_version: dict[str, dict[int, list[Entry]]] = {}
        for entry in self.entries:
            by_version.setdefault(entry.table, {}).setdefault(entry.version, []).append(entry)
        return {name: dict(sorted(versions.items())) for name, versions in by_version.items()}

    def versions(self, name: str) -> dict[int, list[Entry]]:
        """Return the entries of each version of a table, oldest first; empty for no such table."""
        return self.tables.get(name, {})

    def word(self, name: str, version: int) -> str:
        """Return the state of a version, such as "released"."""
        return self.versions(name)[version][-1].state

    def state(self, name: str, version: int) -> VersionState:
        """Return the state of a version; `OUTSIDE` if the journal has no entry of the version."""
        history = [entry.document for entry in self.versions(name).get(version, ())]
        if not history:
            return OUTSIDE
        last = [entry for entry in history if entry["event"] != SIGNED][-1]
        past_files = [file for entry in history for file in entry["evidence"]]
        return VersionState(
            word=last["state"],
            since=last["at"],
            by=last["by"],
            reason=last["reason"],
            verdict=last["verdict"],
            evidence=tuple(Evidence(**file) for file in last["evidence"]),
            stored_at=history[0]["at"],
            past_evidence=frozenset(file["sha256"] for file in past_files),
        )

    def added(
        self, name: str, version: int, event: str, decision: StateDecision, **fields: str
    ) -> "Journal":
        """Return the journal with one more entry: ``event`` of a version by a ``decision``.

        The ``fields`` of a new version are digest, record and inputs.
        """
        history = self.versions(name).get(version)
        if history:  # each entry repeats what was stored
            fields = {"digest": history[0].digest, "record": history[0].record}
        empty = dict.fromkeys(("digest", "record", "inputs", "hash", "key"), "")
        document = asdict(decision) | empty | fields
        del document["automatic"]  # no field of a line
        document |= {
            "number": len(self.entries) + 1,
            "at": datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ"),
            "by": decision.by or user(),
            "program": PROGRAM,
            "event": event,
            "table": name,
            "version": version,
            "previous": self.head,
        }
        document["hash"] = sha256(canonical_json(document))
        return Journal([*self.entries, Entry.read(canonical_json(document).decode())])


def read_journal(folder: Path) -> Journal:
    """Read the journal of a store, empty if there is none. Raises DamagedTable, OSError.

    The journal may have more lines than its head names: a writer stopped before the head.
    """
    # the head is read first, since a writer may add a line in between
    head = _bytes_if_any(folder / HEAD)
    data = _bytes_if_any(folder / JOURNAL)
    try:
        entries = _entries((data or b"").decode())
        _check_head(entries, head)
    except ValueError as error:
        raise DamagedTable(str(error), where=folder / JOURNAL) from error
    return Journal(entries)


def write_journal(folder: Path, journal: Journal) -> None:
    """Replace the journal by a longer one. Raises OSError."""
    if not (folder / HEAD).exists():
        write_whole(folder / ".gitattributes", b"* -text\n")  # git must not change line ends
        write_whole(folder / HEAD, f"{_START} 0\n".encode())
    write_whole(folder / JOURNAL, "".join(f"{entry.line}\n" for entry in journal.entries).encode())
    write_whole(folder / HEAD, f"{journal.head} {len(journal.entries)}\n".encode())
    sync(folder)


def _bytes_if_any(path: Path) -> bytes | None:
    try:
        return read_bounded(path, JOURNAL_KIND)
    except FileNotFoundError:
        return None


def _entries(text: str) -> list[Entry]:
    """Read the lines; check their chain and the order of states. Raises ValueError."""
    if "\r\n" in text:
        raise ValueError(CRLF_FLAW)
    if text and not text.endswith("\n"):
        raise ValueError("torn: its last line has no end")
    entries: list[Entry] = []
    newest: dict[tuple[str, int], Entry] = {}
    previous = _START
    for number, line in enumerate(text.split("\n")[:-1], 1):
        try:
            entry = Entry.read(line)
            if entry.previous != previous or entry.number != number:
                raise ValueError("does not follow the line before: one was changed, lost or put in")
            _check_state(entry, newest.get((entry.table, entry.version)))
        except ValueError as error:
            raise ValueError(f"line {number}: {error}") from error
        newest[entry.table, entry.version] = entry
        entries.append(entry)
        previous = entry.hash
    return entries


def _check_state(entry: Entry, predecessor: Entry | None) -> None:
    """Raise ValueError if an entry may not follow the ``predecessor`` of the same version."""
    id_ = f"{entry.table}@{entry.version}"
    if predecessor is None:
        may_follow = entry.event == STORED and entry.state in CHANGES
    elif (entry.digest, entry.record) != (predecessor.digest, predecessor.record):
        raise ValueError(f"{id_} is another table than the one stored")
    elif entry.event == SIGNED:
        may_follow = entry.state == predecessor.state
    else:
        may_follow = entry.event == CHANGED and entry.state in CHANGES[predecessor.state]
    if not may_follow:
        was = predecessor.state if predecessor else "never stored"
        raise ValueError(f"{id_} was {was} before {entry.event} {entry.state}")


def _check_head(entries: list[Entry], head: bytes | None) -> None:
    """Raise ValueError unless ``head``, the content of its file, names a line of the journal."""
    if head is None:
        if entries:
            raise ValueError(f"{HEAD} beside it is missing")
        return
    match = re.fullmatch(rb"([0-9a-f]{64}) ([0-9]{1,18})\s*", head)
    if match is None:
        raise ValueError(f"{HEAD} beside it is damaged")
    number, hashes = int(match[2]), [_START, *(entry.hash for entry in entries)]
    if number > len(entries):
        raise ValueError(f"has {len(entries)} lines, its head names {number}: lines are lost")
    if hashes[number] != match[1].decode():
        raise ValueError(f"does not agree with {HEAD}")
