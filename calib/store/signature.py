"""Sign versions, and verify their signatures: tables/sedan/v0001.minisig.

minisign signs the record file, which holds the digest of every curve file. The trusted comment ends
with the head of the journal, which has the state of the version; the rest of it is for people. A
signature is valid while the journal contains that head and the version has the state it had then.
"""

import re
from dataclasses import dataclass, replace
from pathlib import Path

from calib.base.bounded import TABLE, read_bounded
from calib.base.digest import sha256
from calib.base.errors import DamagedTable, SignatureRefused
from calib.base.write import write_whole
from calib.store.folders import RECORD, SIGNATURE, signature_file
from calib.store.minisign import PublicKey, SecretKey, Signature, read_signature, verify
from calib.store.seen import SeenJournals, recall
from calib.store.snapshot import Snapshot, StoreEntry
from calib.store.state import RELEASED
from calib.store.store import Store
from calib.store.version import Stored

_HEAD = re.compile(r"brake-cal .*\bjournal=([0-9a-f]{64})")


@dataclass(frozen=True)
class _Signed:
    """A valid signature; ``note`` why no older copy of the store would be noticed, or ""."""

    stored: Stored
    path: Path
    key_id: str
    comment: str
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
            "trusted_comment": self.comment,
        }


def sign(store: Store, reference: str, key: SecretKey) -> _Signed:
    """Sign record, state and journal of ``name@version``; it replaces an older signature.

    Raises TableNotFound, DamagedTable, StoreError, and SignatureRefused as `require_signed`.
    """
    public = key.public
    _, memory = _looked_up(store, public)
    with store.changing(reference) as (now, stored):
        _check_anchors(now, public)
        comment = (
            f"brake-cal table={stored.name} version={stored.version} state={stored.state.word} "
            f"digest={stored.digest} journal={now.journal.head}"
        )
        path = signature_file(stored.path.parent, stored.version)
        write_whole(path, key.sign(_record(stored), comment))
    note = _keep(store.now(), public, memory)
    return _Signed(stored, path, public.key_id, comment, note)


def require_signed(stored: Stored, public: PublicKey, newest: bool = False) -> _Signed:
    """Return the valid signature of a version in its store, by a key.

    ``newest``: the version was chosen as the newest usable one. Then newer versions that were ever
    released must have one, too: somebody may reject one to bring back an older one, but cannot
    sign that.

    Raises SignatureRefused without a signature, for a state that was changed since, and for a
    journal that lacks a head that the key signed in this store or that this user has seen;
    DamagedTable when the version is not the one that was loaded.
    """
    now, memory = _looked_up(Store(stored.path.absolute().parent.parent), public)
    again = now.load(stored.name, stored.version)
    if again.record != stored.record:
        raise DamagedTable("was replaced while it was read", where=stored.id, do="run it again")
    signed = _valid(now, again, public)
    for version in now.journal.versions(stored.name) if newest else ():
        if version > stored.version and _must_be_signed(now, stored.name, version):
            _valid(now, now.load(stored.name, version), public)
    return replace(signed, note=_keep(now, public, memory))


def verify_signed(
    store: Store, public: PublicKey, name: str | None = None
) -> tuple[tuple[StoreEntry, ...], str]:
    """`Store.verify` with the signatures of a key, and a note as in `_Signed`.

    Every version that was ever released must have one, and one that there is must be valid. Raises
    as `Store.verify`, and as `require_signed` for the store as a whole.
    """
    now, memory = _looked_up(store, public)
    entries = store.verify(name, lambda entry: _with_signature(now, entry, public))
    return entries, _keep(now, public, memory) if all(one.sound for one in entries) else ""


def _looked_up(store: Store, public: PublicKey) -> tuple[Snapshot, SeenJournals]:
    """The store now, and the journals seen before. Raises SignatureRefused for an older copy."""
    memory = recall()
    now = store.now()
    memory.check(store.folder, now.journal, public.key_id)
    return now, memory


def signer(stored: Stored) -> str | None:
    """The key in the signature file of a version, unverified; None without a readable one."""
    try:
        return read_signature(signature_file(stored.path.parent, stored.version)).key_id
    except SignatureRefused:
        return None


def _must_be_signed(now: Snapshot, name: str, version: int) -> bool:
    """Whether a version was ever released: then its state, whatever it is now, must be signed."""
    history = now.journal.versions(name).get(version, ())
    return any(entry.state == RELEASED for entry in history)


def _with_signature(now: Snapshot, entry: StoreEntry, public: PublicKey) -> StoreEntry:
    must = _must_be_signed(now, entry.name, entry.version)
    if entry.stored is None or not (must or signer(entry.stored) == public.key_id):
        return entry
    try:
        return replace(entry, signed=_valid(now, entry.stored, public).stored.state.word)
    except SignatureRefused as error:
        flaw = error.problem if error.where == entry.id else f"{error.where}: {error.problem}"
        return replace(entry, violations=(*entry.violations, flaw))


def _valid(now: Snapshot, stored: Stored, public: PublicKey) -> _Signed:
    path = signature_file(stored.path.parent, stored.version)
    if not path.exists():
        raise _refused(stored, "has no signature")
    signature = read_signature(path)
    if signature.key_id != public.key_id:
        raise _refused(stored, f"is signed by key {signature.key_id}, not by {public.key_id}")
    verify(public, _record(stored), signature, path)
    line = _line(now, signature, path)
    history = now.journal.versions(stored.name)[stored.version]
    then = [entry.state for entry in history if entry.number <= line]
    if not then:
        raise _refused(stored, "was signed before it was stored")
    changed = [e for e in history if e.number > line and e.state != then[-1]]
    if changed:
        last = changed[-1].document
        since = f"{last['state']} since (by {last['by']}, {last['at'][:10]})"
        raise _refused(stored, f"signed as {then[-1]}, {since}")
    return _Signed(stored, path, public.key_id, signature.trusted_comment)


def _refused(stored: Stored, flaw: str) -> SignatureRefused:
    do = f"sign it as it is now, with `brake-cal tables sign {stored.id} --key SECRET`"
    return SignatureRefused(flaw, where=stored.id, do=do)


def _check_anchors(now: Snapshot, public: PublicKey) -> None:
    """Raise SignatureRefused if the journal lacks a head of any valid signature in the store."""
    for path in sorted(now.folder.glob(f"*/v*{SIGNATURE}")):
        record = path.parent / path.name.split(".")[0] / RECORD
        try:
            signature = read_signature(path)
            verify(public, read_bounded(record, TABLE), signature, path)
        except (SignatureRefused, OSError):
            continue
        if _HEAD.fullmatch(signature.trusted_comment):
            _line(now, signature, path)


def _line(now: Snapshot, signature: Signature, path: Path) -> int:
    """Number of the line of the journal that is the head in a signature."""
    head = _HEAD.fullmatch(signature.trusted_comment)
    if not head:
        raise SignatureRefused("its trusted comment names no head of a journal", where=path)
    for entry in now.journal.entries:
        if entry.hash == head[1]:
            return entry.number
    raise SignatureRefused(
        "covers a line that the journal does not contain: the journal was set back, or is that of "
        "another store",
        where=path,
        expected=f"a line with the hash {head[1][:12]}...",
        do="get the newest copy of the store; if the journal was set back on purpose, delete this "
        "signature and sign again",
    )


def _record(stored: Stored) -> bytes:
    """The bytes of the record file. Raises DamagedTable if they changed since loading."""
    data = read_bounded(stored.path / RECORD, TABLE)
    if sha256(data) != stored.record:
        raise DamagedTable(f"{RECORD}: was changed just now", where=stored.id)
    return data


def _keep(now: Snapshot, public: PublicKey, memory: SeenJournals) -> str:
    """Check the signatures of the whole store, and keep its head as seen; return a note."""
    _check_anchors(now, public)
    return memory.keep(now.folder, now.journal, public.key_id)
