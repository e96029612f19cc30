"""The signatures of a version: minisign's, of its record file, each in a file of its own.

    tables/sedan/v0001.minisig         of the first key that signed
    tables/sedan/v0001.KEYID.minisig   of another one

The record holds the SHA-256 of every curve file. The trusted comment is a `Statement`: table,
version, digest, state, and the head of the journal. So a signature holds of a version whose state
has been that one ever since, in a store whose journal contains that head. Whether a line with
the event `signed` stands in the journal does not matter: minisign writes none.
"""

import hashlib
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from pathlib import Path

from calib.base.bounded import TABLE, read_bounded
from calib.base.errors import DamagedTable, SignatureRefused
from calib.store.folders import RECORD, SIGNATURE, folder_of, signature_files
from calib.store.journal import SIGNED, Entry
from calib.store.minisign import (
    Signature,
    Statement,
    parse_signature,
    parse_statement,
    sign,
    verify,
)
from calib.store.minisign_keys import PublicKey, SecretKey
from calib.store.minisign_lines import read_small
from calib.store.snapshot import Snapshot
from calib.store.version import Stored

NEWEST = "get the newest copy of the store"


@dataclass(frozen=True)
class Signed:
    """A signature of a version: its file, the content of it, and what it says."""

    stored: Stored
    path: Path
    content: bytes
    key_id: str
    statement: Statement


def signed(now: Snapshot, stored: Stored, key: SecretKey) -> Signed:
    """Make the signature of a version as it is now; writes nothing.

    Raises DamagedTable when the record file is not what was stored.
    """
    statement = Statement(
        stored.name, stored.version, stored.state.word, stored.digest, now.journal.head
    )
    content = sign(key, _record(stored), statement.line)
    return Signed(stored, _path(stored, key.public), content, key.key_id, statement)


def held(now: Snapshot, stored: Stored, public: PublicKey) -> Signed:
    """The signature of a key that holds of a version as it is now.

    Raises SignatureRefused when there is none, or it is of another version, state or store.
    """
    refused = None
    for path, signature in _of_key(stored.path.parent, stored.version, public):
        try:
            return _holding(now, stored, public, path, signature)
        except SignatureRefused as error:
            refused = refused or error
    raise refused or _missing(stored, public)


def _of_key(home: Path, version: int, public: PublicKey) -> list[tuple[Path, Signature]]:
    """The signatures that bear the number of a key, with their files. Verifies nothing."""
    files = signature_files(home, version)
    return [(p, s) for p in files if (s := _read(p)) and s.number == public.number]


def was_signed(now: Snapshot, name: str, version: int, public: PublicKey) -> bool:
    """Whether a key has signed a version, as a file or the journal says; it may not hold any more.

    With the line in the journal a signature that was taken away is missed.
    """
    history = now.journal.of(name).get(version, ())
    told = any(entry.event == SIGNED and entry.key == public.key_id for entry in history)
    return told or bool(_of_key(now.folder / name, version, public))


def key_ids(stored: Stored) -> tuple[str, ...]:
    """The keys that the signature files of a version name. Verifies nothing."""
    files = signature_files(stored.path.parent, stored.version)
    return tuple(signature.key_id for path in files if (signature := _read(path)))


def anchored(now: Snapshot, public: PublicKey) -> None:
    """Raise SignatureRefused if the journal does not contain a head that the key signed.

    Looks at every signature of the store, of whatever version. One that does not hold over the
    record beside it shows nothing and is passed over.
    """
    for path in sorted(now.folder.glob(f"*/v*{SIGNATURE}")):
        record = path.parent / path.name.split(".")[0] / RECORD
        signature = _read(path)
        if not signature:
            continue
        try:
            comment = verify(public, read_bounded(record, TABLE), signature, path)
            statement = parse_statement(comment, path)
        except (SignatureRefused, OSError):
            continue
        _line(now, statement, path)


def _holding(
    now: Snapshot, stored: Stored, public: PublicKey, path: Path, signature: Signature
) -> Signed:
    # what it says it is of comes first: that tells more than that it does not hold here
    statement = parse_statement(signature.trusted_comment, path)
    signs = (statement.table, statement.version, statement.digest)
    if signs != (stored.name, stored.version, stored.digest):
        raise SignatureRefused(
            f"is of {statement.table}@{statement.version}, digest {statement.digest[:12]}",
            where=path,
            expected=f"{stored.id}, digest {stored.digest[:12]}",
        )
    verify(public, _record(stored), signature, path)
    _check_state(now, stored, statement, _line(now, statement, path))
    return Signed(stored, path, signature.file, public.key_id, statement)


def _line(now: Snapshot, statement: Statement, path: Path) -> int:
    """Number of the line of the journal that a signature covers as its head."""
    number = now.journal.line_of(statement.head)
    if not number:
        raise SignatureRefused(
            "covers a line that the journal does not contain: the journal was set back, or is "
            "that of another store",
            where=path,
            expected=f"a line with the hash {statement.head[:12]}...",
            do=f"{NEWEST}; if the journal was set back on purpose, delete this signature and "
            "sign again",
        )
    return number


def _check_state(now: Snapshot, stored: Stored, statement: Statement, line: int) -> None:
    """The version had the state that was signed, and has had no other one since."""
    history = now.journal.of(stored.name)[stored.version]
    then = [entry for entry in history if entry.number <= line]
    was = then[-1].state if then else "not stored"
    if was != statement.state:
        raise SignatureRefused(f"signed as {statement.state}, it was {was} then", where=stored.id)
    since = [entry for entry in history if entry.number > line]
    if any(entry.state != statement.state for entry in since):
        raise SignatureRefused(
            f"signed as {statement.state}, {_told(statement.state, since)}",
            where=stored.id,
            do=f"sign it as it is now, with `brake-cal tables sign {stored.id} --key SECRET`",
        )


def _told(first: str, since: list[Entry]) -> str:
    """The states after the ``first`` one in order, with the person of the newest."""
    states = [first, *(entry.state for entry in since)]
    words = [state for before, state in pairwise(states) if state != before]
    return f"{' and '.join(words)} since (by {since[-1].by}, {since[-1].at[:10]})"


def _missing(stored: Stored, public: PublicKey) -> SignatureRefused:
    files = signature_files(stored.path.parent, stored.version)
    for path in files:
        _parsed(path)  # one that cannot be read may be the one that is looked for
    others = ", ".join(key_ids(stored))
    return SignatureRefused(
        f"is signed by key {others}, not by key {public.key_id}"
        if others
        else f"has no signature of key {public.key_id}",
        where=stored.id,
        do=f"sign it with `brake-cal tables sign {stored.id} --key SECRET`",
    )


def _path(stored: Stored, public: PublicKey) -> Path:
    """The file of a key's signature: its own, else the simple name, else one with its number."""
    home = stored.path.parent
    mine = [path for path, _ in _of_key(home, stored.version, public)]
    simple = home / f"{folder_of(stored.version)}{SIGNATURE}"
    named = simple.with_name(f"{simple.stem}.{public.key_id}{SIGNATURE}")
    return mine[0] if mine else named if simple.exists() else simple


def _record(stored: Stored) -> bytes:
    """The bytes of the record file, which are those that were loaded."""
    data = read_bounded(stored.path / RECORD, TABLE)
    if hashlib.sha256(data).hexdigest() != stored.record:
        raise DamagedTable(f"{RECORD}: was changed just now", where=stored.id, do=NEWEST)
    return data


def _parsed(path: Path) -> Signature:
    return parse_signature(read_small(path, partial(SignatureRefused, where=path)), path)


def _read(path: Path) -> Signature | None:
    """The signature in a file; None where it cannot be read."""
    try:
        return _parsed(path)
    except SignatureRefused:
        return None
