"""The signatures of a version, each in a file of its own, and whether a version may be trusted.

    tables/sedan/v0001.minisig         of the first key that signed
    tables/sedan/v0001.KEYID.minisig   of another one

A signature is minisign's, of the record file, which holds the SHA-256 of every curve file. Its
trusted comment is a `Statement`: it holds of a version whose state has been that one ever since, in
a store whose journal contains that head. Whether a line with the event `signed` stands in the
journal does not matter: minisign writes none.
"""

import hashlib
import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

from calib.base.bounded import TABLE, read_bounded
from calib.base.errors import DamagedTable, SignatureRefused
from calib.base.write import write_whole
from calib.store.folders import RECORD, SIGNATURE, folder_of, signature_files
from calib.store.journal import SIGNED, enter
from calib.store.minisign import PublicKey, SecretKey, Signature, read_signature, verify
from calib.store.seen import SeenJournals, recall
from calib.store.snapshot import Snapshot, StoreEntry
from calib.store.state import STATES, StateDecision
from calib.store.store import Store
from calib.store.version import Stored

_NEWEST = "get the newest copy of the store"
_STATEMENT = re.compile(
    r"brake-cal table=([A-Za-z0-9._-]{1,100}) version=([1-9][0-9]{0,5}) "
    rf"state=({'|'.join(STATES)}) digest=([0-9a-f]{{64}}) journal=([0-9a-f]{{64}})"
)


class Statement(NamedTuple):
    """That a version had a state when it was signed; ``head`` hash of the journal's newest line."""

    table: str
    version: int
    state: str
    digest: str
    head: str

    @property
    def line(self) -> str:
        """The statement as a trusted comment."""
        return (
            f"brake-cal table={self.table} version={self.version} state={self.state} "
            f"digest={self.digest} journal={self.head}"
        )


def parse_statement(line: str, where: object = None) -> Statement:
    """The statement in a trusted comment.

    Raises SignatureRefused for every line that is not the one spelling of a statement.
    """
    found = _STATEMENT.fullmatch(line)
    if not found:
        raise SignatureRefused("its trusted comment is not that of a table", where=where)
    table, version, *rest = found.groups()
    return Statement(table, int(version), *rest)


@dataclass(frozen=True)
class _Signed:
    """A signature of a version that holds.

    ``note`` says why an older copy of the store would go unnoticed, or "".
    """

    stored: Stored
    path: Path
    key_id: str
    statement: Statement
    note: str = ""

    def to_dict(self) -> dict[str, object]:
        """The JSON document of a signature."""
        return {
            "table": self.stored.id,
            "digest": self.stored.digest,
            "state": self.stored.state.word,
            "key_id": self.key_id,
            "record": self.stored.path / RECORD,
            "signature": self.path,
            "trusted_comment": self.statement.line,
        }


def sign(store: Store, reference: str, key: SecretKey, by: str = "") -> _Signed:
    """Sign the record and the state of ``name@version``, and enter that in the journal.

    It covers the head of the journal before that line, and takes the place of an older signature of
    the key. The file comes first: it says nothing that is not so, entered or not; if it is not
    entered, it is put back as it was.

    Raises TableNotFound, DamagedTable; StoreError when the store cannot be written;
    SignatureRefused as `require_signed` for what is wrong with the journal.
    """
    memory, public = recall(), key.public
    memory.check(store.folder, store.now().journal, public.key_id)
    with store.changing(reference) as (now, stored):
        _check_anchors(now, public)
        state, head = stored.state.word, now.journal.head
        statement = Statement(stored.name, stored.version, state, stored.digest, head)
        path = _path(stored, public)
        before = path.read_bytes() if path.exists() else None
        write_whole(path, key.sign(_record(stored), statement.line))

        def put_back() -> None:
            path.unlink() if before is None else write_whole(path, before)

        of = (stored.name, stored.version, SIGNED, StateDecision(state, by=by))
        enter(store.folder, now.journal.added(*of, key=public.key_id), put_back)
    note = _keep(store.now(), public, memory)
    return _Signed(stored, path, public.key_id, statement, note)


def require_signed(stored: Stored, public: PublicKey, newest: bool = False) -> _Signed:
    """The signature of a key that holds of a version in its store.

    ``newest``: the version was chosen as the newest one that may be used. Then each newer one that
    the key has signed must have a signature that holds, too: whoever can write the store can
    reject a version, so that an older one takes its place, but cannot sign that.

    Raises SignatureRefused when there is none, when the state was changed since, when the journal
    does not contain what the key signed anywhere in the store, or is older than what this user has
    seen with this key; DamagedTable when the version is not what was loaded.
    """
    store = Store(stored.path.absolute().parent.parent)
    memory = recall()
    now = store.now()
    memory.check(store.folder, now.journal, public.key_id)
    again = now.load(stored.name, stored.version)
    if again.record != stored.record:
        raise DamagedTable("was replaced while it was read", where=stored.id, do="run it again")
    found = _held(now, again, public)
    for version in now.journal.of(stored.name) if newest else ():
        if version > stored.version and _was_signed(now, stored.name, version, public):
            _held(now, now.load(stored.name, version), public)
    return replace(found, note=_keep(now, public, memory))


def verify_signed(
    store: Store, public: PublicKey, name: str | None = None
) -> tuple[tuple[StoreEntry, ...], str]:
    """`Store.verify` with the signatures of a key, and a note as in `_Signed`.

    Every released version must have one, and each that the key has ever signed. Raises as
    `require_signed` for what is wrong with the store as a whole, and as `Store.verify`.
    """
    memory = recall()
    now = store.now()
    memory.check(store.folder, now.journal, public.key_id)
    found = store.verify(name, lambda entry: _with_signature(now, entry, public))
    return found, _keep(now, public, memory) if all(one.sound for one in found) else ""


def key_ids(stored: Stored) -> tuple[str, ...]:
    """The keys that the signature files of a version name. Verifies nothing."""
    return tuple(one.key_id for _, one in _signatures(stored.path.parent, stored.version))


def _signatures(
    home: Path, version: int, key: PublicKey | None = None
) -> Iterator[tuple[Path, Signature]]:
    """The signature files of a version, of a key or of all, that can be read."""
    for path in signature_files(home, version):
        try:
            found = read_signature(path)
        except SignatureRefused:
            continue
        if key is None or key.number == found.number:
            yield path, found


def _was_signed(now: Snapshot, name: str, version: int, public: PublicKey) -> bool:
    """Whether a key has signed a version, as a file or the journal says; it may not hold any more.

    With the line in the journal a signature that was taken away is missed.
    """
    history = now.journal.of(name).get(version, ())
    signed = (entry.document for entry in history if entry.event == SIGNED)
    told = any(line["key"] == public.key_id for line in signed)
    return told or any(_signatures(now.folder / name, version, public))


def _with_signature(now: Snapshot, entry: StoreEntry, public: PublicKey) -> StoreEntry:
    wanted = entry.state.released or _was_signed(now, entry.name, entry.version, public)
    if entry.stored is None or not wanted:
        return entry
    try:
        return replace(entry, signed=_held(now, entry.stored, public).statement.state)
    except SignatureRefused as error:
        flaw = error.what if error.where == entry.id else f"{error.where}: {error.what}"
        return replace(entry, violations=(*entry.violations, flaw))


def _held(now: Snapshot, stored: Stored, public: PublicKey) -> _Signed:
    """The signature of a key that holds of a version as it is now.

    Raises SignatureRefused when there is none, or it is of another version, state or store.
    """
    refused: SignatureRefused | None = None
    for path, signature in _signatures(stored.path.parent, stored.version, public):
        try:
            said = _checked(now, stored, public, path, signature)
            return _Signed(stored, path, public.key_id, said)
        except SignatureRefused as error:
            refused = refused or error
    for path in () if refused else signature_files(stored.path.parent, stored.version):
        read_signature(path)  # one that cannot be read may be the one that is looked for
    others = f", but of {', '.join(key_ids(stored))}" * bool(key_ids(stored))
    raise refused or _refused(stored, f"has no signature of key {public.key_id}{others}")


def _refused(stored: Stored, what: str) -> SignatureRefused:
    do = f"sign it as it is now, with `brake-cal tables sign {stored.id} --key SECRET`"
    return SignatureRefused(what, where=stored.id, do=do)


def _checked(
    now: Snapshot, stored: Stored, public: PublicKey, path: Path, signature: Signature
) -> Statement:
    """The statement of a signature, after it was verified and compared with version and journal."""
    # what it says it is of comes first: that tells more than that it does not hold here
    said = parse_statement(signature.trusted_comment, path)
    if (said.table, said.version, said.digest) != (stored.name, stored.version, stored.digest):
        raise SignatureRefused(
            f"is of {said.table}@{said.version}, digest {said.digest[:12]}",
            where=path,
            expected=f"{stored.id}, digest {stored.digest[:12]}",
        )
    verify(public, _record(stored), signature, path)
    line = _line(now, said, path)
    history = now.journal.of(stored.name)[stored.version]
    then = [entry.state for entry in history if entry.number <= line]
    if then[-1:] != [said.state]:
        raise _refused(stored, f"signed as {said.state}, which it was not then")
    changed = [e for e in history if e.number > line and e.state != said.state]
    if changed:
        last = changed[-1].document
        since = f"{last['state']} since (by {last['by']}, {last['at'][:10]})"
        raise _refused(stored, f"signed as {said.state}, {since}")
    return said


def _check_anchors(now: Snapshot, public: PublicKey) -> None:
    """Raise SignatureRefused if the journal does not contain a head that the key signed.

    Looks at every signature of the store, of whatever version. One that does not hold over the
    record beside it shows nothing and is passed over.
    """
    for path in sorted(now.folder.glob(f"*/v*{SIGNATURE}")):
        record = path.parent / path.name.split(".")[0] / RECORD
        try:
            signature = read_signature(path)
            verify(public, read_bounded(record, TABLE), signature, path)
            statement = parse_statement(signature.trusted_comment, path)
        except (SignatureRefused, OSError):
            continue
        _line(now, statement, path)


def _line(now: Snapshot, statement: Statement, path: Path) -> int:
    """Number of the line of the journal that a signature covers as its head."""
    number = next((e.number for e in now.journal.entries if e.hash == statement.head), 0)
    if not number:
        raise SignatureRefused(
            "covers a line that the journal does not contain: the journal was set back, or is "
            "that of another store",
            where=path,
            expected=f"a line with the hash {statement.head[:12]}...",
            do=f"{_NEWEST}; if the journal was set back on purpose, delete this signature and "
            "sign again",
        )
    return number


def _path(stored: Stored, public: PublicKey) -> Path:
    """The file of a key's signature: its own, else the simple name, else one with its number."""
    home = stored.path.parent
    simple = home / f"{folder_of(stored.version)}{SIGNATURE}"
    named = simple.with_name(f"{simple.stem}.{public.key_id}{SIGNATURE}")
    mine = next((path for path, _ in _signatures(home, stored.version, public)), None)
    return mine or (named if simple.exists() else simple)


def _record(stored: Stored) -> bytes:
    """The bytes of the record file, which are those that were loaded."""
    data = read_bounded(stored.path / RECORD, TABLE)
    if hashlib.sha256(data).hexdigest() != stored.record:
        raise DamagedTable(f"{RECORD}: was changed just now", where=stored.id)
    return data


def _keep(now: Snapshot, public: PublicKey, memory: SeenJournals) -> str:
    """Look at the signatures of the whole store, and keep what was seen; returns a note."""
    _check_anchors(now, public)
    return memory.keep(now.folder, now.journal, public.key_id)
