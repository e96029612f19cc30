"""The journal of a store: one line for each event of a version, never changed.

    tables/journal.jsonl   {"number": 7, ..., "previous": <hash of line 6>, "hash": <of this line>}
    tables/journal.head    <hash of the last line> <number of lines>

``hash`` is the SHA-256 of the line's canonical JSON without ``hash``, and each line holds that of
the previous one: a changed, lost or inserted line breaks the chain. The head shows lines missing at
the end. Only a signature over the head (`calib.store.signature`) shows that both were rewritten.
"""

import json
import re
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

from calib.base.bounded import JOURNAL as JOURNAL_FILE
from calib.base.bounded import read_bounded
from calib.base.digest import canonical_json, sha256
from calib.base.errors import DamagedTable
from calib.base.names import PROGRAM
from calib.base.write import sync, write_whole
from calib.store.state import CHANGES, OUTSIDE, Evidence, StateDecision, VersionState, user

JOURNAL, HEAD = "journal.jsonl", "journal.head"
CRLF = (
    "its line ends are CRLF, which are not its own: git makes them of a store without the line "
    "`* -text` in its .gitattributes; add it and check the files out again"
)

STORED, CHANGED = "stored", "changed"
SIGNED = "signed"  # a line of older programs, which changes nothing
_START = "0" * 64  # head of an empty journal

_TEXT = r'"[^"\\]*+(?:\\.[^"\\]*+)*+"'
_PROOF = rf'\{{"name":{_TEXT},"sha256":{_TEXT}\}}'
_LINE = re.compile(
    rf'\{{"at":{_TEXT},"by":{_TEXT},"digest":"(\w*)","event":"(\w*)",'
    rf'"evidence":\[(?:{_PROOF}(?:,{_PROOF})*)?\],"hash":"(\w*)","inputs":"(\w*)","key":{_TEXT},'
    rf'"number":(\d+),"previous":"(\w*)","program":{_TEXT},"reason":{_TEXT},"record":"(\w*)",'
    rf'"state":"(\w*)","table":"([\w.-]*)","verdict":{_TEXT},"version":(\d{{1,9}})\}}',
    re.ASCII,
)
"""The one spelling of a line: reading JSON and spelling it again takes ten times as long."""


class Entry(NamedTuple):
    """One ``line`` of the journal, with the fields that every read needs.

    ``digest`` of the content, ``record`` SHA-256 of the record file, ``inputs`` digest of logs,
    vehicle and settings, ``state`` afterwards, ``number`` from 1.
    """

    line: str
    number: int
    version: int
    digest: str
    event: str
    hash: str
    inputs: str
    previous: str
    record: str
    state: str
    table: str

    @property
    def id(self) -> str:
        """name@version."""
        return f"{self.table}@{self.version}"

    @property
    def document(self) -> dict[str, Any]:
        """All fields: also ``at`` (UTC), ``by``, ``program``, ``reason``, ``verdict``, ``key``."""
        return dict(json.loads(self.line))


@dataclass(frozen=True)
class Journal:
    """All entries in order, none in a new store."""

    entries: Sequence[Entry] = ()

    @property
    def head(self) -> str:
        """Hash of the last entry."""
        return self.entries[-1].hash if self.entries else _START

    @cached_property
    def tables(self) -> dict[str, dict[int, list[Entry]]]:
        """The entries of each version of each table, in order; versions rise."""
        by_version: dict[str, dict[int, list[Entry]]] = {}
        for entry in self.entries:
            by_version.setdefault(entry.table, {}).setdefault(entry.version, []).append(entry)
        return {name: dict(sorted(versions.items())) for name, versions in by_version.items()}

    def versions(self, name: str) -> dict[int, list[Entry]]:
        """The entries of each version of a table, oldest first; empty for an unknown table."""
        return self.tables.get(name, {})

    def word(self, name: str, version: int) -> str:
        """The state of a known version, in a word."""
        return self.versions(name)[version][-1].state

    def state(self, name: str, version: int) -> VersionState:
        """The state of a version; `OUTSIDE` if the journal has no entry of it."""
        history = [entry.document for entry in self.versions(name).get(version, ())]
        if not history:
            return OUTSIDE
        last = [entry for entry in history if entry["event"] != SIGNED][-1]
        return VersionState(
            word=last["state"],
            since=last["at"],
            evidence=tuple(Evidence(**file) for file in last["evidence"]),
            stored_at=history[0]["at"],
            past_evidence=frozenset(file["sha256"] for e in history for file in e["evidence"]),
            **{key: last[key] for key in ("by", "reason", "verdict")},
        )

    def added(
        self, name: str, version: int, event: str, decision: StateDecision, **fields: str
    ) -> "Journal":
        """The journal with one more entry; ``fields`` of a new version."""
        for first in self.versions(name).get(version, ())[:1]:
            fields = {"digest": first.digest, "record": first.record} | fields
        decided = asdict(decision)
        del decided["automatic"]
        document = {
            **decided,
            "number": len(self.entries) + 1,
            "at": datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ"),
            "by": decision.by or user(),
            "program": PROGRAM,
            "event": event,
            "table": name,
            "version": version,
            "previous": self.head,
            **dict.fromkeys(("digest", "record", "inputs", "hash", "key"), ""),
            **fields,
        }
        document["hash"] = sha256(canonical_json(document))
        return Journal([*self.entries, _entry(canonical_json(document).decode())])

    @property
    def data(self) -> bytes:
        """The bytes of the journal's file."""
        return "".join(f"{entry.line}\n" for entry in self.entries).encode()

    @property
    def head_line(self) -> bytes:
        """The bytes of the head's file."""
        return f"{self.head} {len(self.entries)}\n".encode()


def read_journal(folder: Path) -> Journal:
    """The journal of a store, empty if there is none. Raises DamagedTable, OSError.

    It may have more lines than the head names: their writer was stopped before the head.
    """
    # the head first: a writer may add a line in between
    head, data = _bytes(folder / HEAD), _bytes(folder / JOURNAL)
    try:
        entries = _entries((data or b"").decode())
        _check_head(entries, head)
    except ValueError as error:
        raise DamagedTable(str(error), where=folder / JOURNAL) from error
    return Journal(entries)


def write_journal(folder: Path, journal: Journal) -> None:
    """Replace the journal by a longer one. Raises OSError."""
    if not (folder / HEAD).exists():
        # git must not change the bytes of a store
        write_whole(folder / ".gitattributes", b"* -text\n")
        write_whole(folder / HEAD, Journal().head_line)
    write_whole(folder / JOURNAL, journal.data)
    write_whole(folder / HEAD, journal.head_line)
    sync(folder)


def _bytes(path: Path) -> bytes | None:
    try:
        return read_bounded(path, JOURNAL_FILE)
    except FileNotFoundError:
        return None


def _entries(text: str) -> list[Entry]:
    if "\r\n" in text:
        raise ValueError(CRLF)
    if text and not text.endswith("\n"):
        raise ValueError("torn: its last line has no end")
    entries: list[Entry] = []
    newest: dict[tuple[str, int], Entry] = {}
    previous = _START
    for number, line in enumerate(text.split("\n")[:-1], 1):
        try:
            entry = _entry(line)
            key = entry.table, entry.version
            if entry.previous != previous or entry.number != number:
                raise ValueError("does not follow the line before: one was changed, lost or put in")
            _check_state(entry, newest.get(key))
        except ValueError as error:
            raise ValueError(f"line {number}: {error}") from error
        newest[key] = entry
        entries.append(entry)
        previous = entry.hash
    return entries


def _entry(line: str) -> Entry:
    """The entry of a line that agrees with its hash. Raises ValueError."""
    match = _LINE.fullmatch(line)
    if match is None:
        raise ValueError("not an entry as it is written")
    start, end = match.span(3)
    if sha256((line[:start] + line[end:]).encode()) != match[3]:
        raise ValueError("was changed: it does not agree with its hash")
    digest, event, hash_, inputs, number, *texts, version = match.groups()
    return Entry(line, int(number), int(version), digest, event, hash_, inputs, *texts)


def _check_state(entry: Entry, predecessor: Entry | None) -> None:
    if predecessor is None:
        fits = entry.event == STORED and entry.state in CHANGES
    elif (entry.digest, entry.record) != (predecessor.digest, predecessor.record):
        raise ValueError(f"{entry.id} is another table than the one stored")
    elif entry.event == SIGNED:
        fits = entry.state == predecessor.state
    else:
        fits = entry.event == CHANGED and entry.state in CHANGES[predecessor.state]
    if not fits:
        was = predecessor.state if predecessor else "never stored"
        raise ValueError(f"{entry.id} was {was} before {entry.event} {entry.state}")


def _check_head(entries: list[Entry], head: bytes | None) -> None:
    if head is None and entries:
        raise ValueError(f"{HEAD} beside it is missing")
    if head is None:
        return
    digest, _, count = head.decode(errors="replace").strip().partition(" ")
    number = int(count) if re.fullmatch(r"[0-9]{1,18}", count) else -1
    hashes = [_START, *(entry.hash for entry in entries)]
    if number >= len(hashes):
        raise ValueError(f"has {len(entries)} lines, its head names {number}: lines are lost")
    if number < 0 or hashes[number] != digest:
        raise ValueError(f"does not agree with {HEAD}")
