"""Sign versions, and verify their signatures, such as tables/sedan/v0001.minisig.

A signature covers the record file, which holds the digests of all curves. The trusted comment of
the signature ends with the head of the journal when it was signed. So it covers the state of the
version, too. A signature is valid while the journal contains that head and the version still has
that state. A store is an older copy if its journal lacks a head that the key has signed, or that
this user has seen, see `calib.store.seen`.
"""

import re
from dataclasses import dataclass, replace
from pathlib import Path

from calib.base.bounded import TABLE, read_bounded
from calib.base.digest import sha256
from calib.base.errors import DamagedTable, SignatureRefused
from calib.base.write import write_whole
from calib.store.folders import RECORD, SIGNATURE_SUFFIX, signature_file
from calib.store.minisign import PublicKey, SecretKey, Signature, read_signature, verify
from calib.store.seen import SeenJournals, recall
from calib.store.snapshot import Snapshot, StoreEntry
from calib.store.state import RELEASED
from calib.store.store import Store
from calib.store.version import Stored

_HEAD = re.compile(r"brake-cal .*\bjournal=([0-9a-f]{64})")


@dataclass(frozen=True)
class _Signed:
    """A version with a valid signature in the file ``path``."""

    stored: Stored
    path: Path
    key_id: str
    comment: str
    note: str = ""  # why an older copy of the store will not be noticed

    def to_dict(self) -> dict[str, object]:
        """Return the JSON document of a signature."""
        return {
            "table": self.stored.id,
            "digest": self.stored.digest,
            "state": self.stored.state.word,
            "key_id": self.key_id,
            "record": self.stored.path / RECORD,
            "signature": self.path,
            "trusted_comment": self.comment,
        }


def sign(store: Store, reference: str, key: SecretKey) -> _Signed:
    """Sign record and state of ``name@version``, and replace an older signature.

    Raises as `Store.judge`, and SignatureRefused for an older copy of the store.
    """
    public = key.public
    _, seen_journals = _require_newest(store, public)
    with store.changing(reference) as (snapshot, stored):
        _check_signed_heads(snapshot, public)
        comment = (
            f"brake-cal table={stored.name} version={stored.version} state={stored.state.word} "
            f"digest={stored.digest} journal={snapshot.journal.head}"
        )
        path = signature_file(stored.path.parent, stored.version)
        write_whole(path, key.sign(_record_bytes(stored), comment))
    note = _remember(store.snapshot(), public, seen_journals)
    return _Signed(stored, path, public.key_id, comment, note)


def require_signed(stored: Stored, public: PublicKey, newest: bool = False) -> _Signed:
    """Return a version with its valid signature by the key ``public``.

    If the version was chosen as the ``newest`` usable one, newer versions that were ever released
    must have a valid signature, too: nobody without the key can reject them to bring back this one.

    Raises SignatureRefused for a signature that is missing or not valid, and for an older copy of
    the store; DamagedTable if the version is another than was loaded.
    """
    snapshot, seen_journals = _require_newest(Store(stored.path.absolute().parent.parent), public)
    reloaded = snapshot.load(stored.name, stored.version)
    if reloaded.record_digest != stored.record_digest:
        raise DamagedTable("was replaced while it was read", where=stored.id, do="run it again")
    signed = _verified(snapshot, reloaded, public)
    if newest:
        for version in snapshot.journal.versions(stored.name):
            if version > stored.version and _was_released(snapshot, stored.name, version):
                _verified(snapshot, snapshot.load(stored.name, version), public)
    return replace(signed, note=_remember(snapshot, public, seen_journals))


def verify_signed(
    store: Store, public: PublicKey, name: str | None = None
) -> tuple[tuple[StoreEntry, ...], str]:
    """Return the entries of `Store.verify` with signatures, and a note as in `_Signed`.

    Every version that was ever released must have a signature by the key ``public``, and every
    signature by this key must be valid. Raises also SignatureRefused for an older copy.
    """
    snapshot, seen_journals = _require_newest(store, public)
    entries = store.verify(name, lambda entry: _with_signature(snapshot, entry, public))
    is_sound = all(entry.sound for entry in entries)
    return entries, _remember(snapshot, public, seen_journals) if is_sound else ""


def signer(stored: Stored) -> str | None:
    """Return the key in the signature file of a version, unverified; None without such a file."""
    try:
        return read_signature(signature_file(stored.path.parent, stored.version)).key_id
    except SignatureRefused:
        return None


def _require_newest(store: Store, public: PublicKey) -> tuple[Snapshot, SeenJournals]:
    """Return the store and the seen journals. Raises SignatureRefused for an older copy."""
    seen_journals = recall()
    snapshot = store.snapshot()
    seen_journals.check(store.folder, snapshot.journal, public.key_id)
    return snapshot, seen_journals


def _remember(snapshot: Snapshot, public: PublicKey, seen_journals: SeenJournals) -> str:
    """Keep the head of a journal that contains all signed heads; return a note as in `_Signed`."""
    _check_signed_heads(snapshot, public)
    return seen_journals.keep(snapshot.folder, snapshot.journal, public.key_id)


def _check_signed_heads(snapshot: Snapshot, public: PublicKey) -> None:
    """Raise SignatureRefused if the journal lacks the head of a valid signature in the store."""
    for path in sorted(snapshot.folder.glob(f"*/v*{SIGNATURE_SUFFIX}")):
        record = path.parent / path.name.split(".")[0] / RECORD
        try:
            signature = read_signature(path)
            verify(public, read_bounded(record, TABLE), signature, path)
        except (SignatureRefused, OSError):
            continue  # by another key, or damaged: `verify_signed` reports that
        if _HEAD.fullmatch(signature.trusted_comment):
            _signed_line(snapshot, signature, path)  # raises if the line is not there


def _was_released(snapshot: Snapshot, name: str, version: int) -> bool:
    history = snapshot.journal.versions(name).get(version, ())
    return any(entry.state == RELEASED for entry in history)


def _with_signature(snapshot: Snapshot, entry: StoreEntry, public: PublicKey) -> StoreEntry:
    """Return the entry with its signed state, or with a violation for an invalid signature."""
    if entry.stored is None:
        return entry
    was_released = _was_released(snapshot, entry.name, entry.version)
    if not was_released and signer(entry.stored) != public.key_id:
        return entry
    try:
        signed = _verified(snapshot, entry.stored, public)
    except SignatureRefused as error:
        flaw = error.problem if error.where == entry.id else f"{error.where}: {error.problem}"
        return replace(entry, violations=(*entry.violations, flaw))
    return replace(entry, signed=signed.stored.state.word)


def _verified(snapshot: Snapshot, stored: Stored, public: PublicKey) -> _Signed:
    """Return a version with its valid signature. Raises SignatureRefused, DamagedTable."""
    path = signature_file(stored.path.parent, stored.version)
    if not path.exists():
        raise _refusal(stored, "has no signature")
    signature = read_signature(path)
    if signature.key_id != public.key_id:
        raise _refusal(stored, f"is signed by key {signature.key_id}, not by {public.key_id}")
    verify(public, _record_bytes(stored), signature, path)
    line = _signed_line(snapshot, signature, path)
    history = snapshot.journal.versions(stored.name)[stored.version]
    signed_states = [entry.state for entry in history if entry.number <= line]
    if not signed_states:
        raise _refusal(stored, "was signed before it was stored")
    state = signed_states[-1]
    changes = [entry for entry in history if entry.number > line and entry.state != state]
    if changes:
        last = changes[-1].document
        since = f"{last['state']} since (by {last['by']}, {last['at'][:10]})"
        raise _refusal(stored, f"signed as {state}, {since}")
    return _Signed(stored, path, public.key_id, signature.trusted_comment)


def _refusal(stored: Stored, flaw: str) -> SignatureRefused:
    do = f"sign it as it is now, with `brake-cal tables sign {stored.id} --key SECRET`"
    return SignatureRefused(flaw, where=stored.id, do=do)


def _signed_line(snapshot: Snapshot, signature: Signature, path: Path) -> int:
    """Return the number of the journal's line whose hash was signed. Raises SignatureRefused."""
    head = _HEAD.fullmatch(signature.trusted_comment)
    if not head:
        raise SignatureRefused("its trusted comment names no head of a journal", where=path)
    for entry in snapshot.journal.entries:
        if entry.hash == head[1]:
            return entry.number
    flaw = "covers a line that is not in the journal: it was set back, or is of another store"
    do = "get the newest copy of the store; if the journal was set back on purpose, delete this "
    do += "signature and sign again"
    raise SignatureRefused(flaw, where=path, expected=f"the line {head[1][:12]}...", do=do)


def _record_bytes(stored: Stored) -> bytes:
    data = read_bounded(stored.path / RECORD, TABLE)
    if sha256(data) != stored.record_digest:
        raise DamagedTable(f"{RECORD}: was changed just now", where=stored.id)
    return data
