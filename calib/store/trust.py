"""May a version be trusted: signatures, and what this user has seen of the store."""

from dataclasses import dataclass, replace

from calib.base.errors import DamagedTable, SignatureRefused, StoreError
from calib.store.folders import NEW, folder_of
from calib.store.minisign_keys import PublicKey, SecretKey
from calib.store.seen import SeenJournals, recall
from calib.store.signature import Signed, anchored, held, was_signed
from calib.store.snapshot import Snapshot
from calib.store.store import Store, StoreVerdict
from calib.store.version import Stored


@dataclass(frozen=True)
class Trusted:
    """A signature that holds; ``note`` says why older copies of the store go unnoticed, or ""."""

    signed: Signed
    note: str


@dataclass(frozen=True)
class TrustVerdict:
    """Result of `verify_signed`.

    ``verdicts`` as `Store.verify`, with what is wrong with signatures; ``signed`` the state in the
    signature of each version that has one that holds; ``note`` as in `Trusted`.
    """

    verdicts: tuple[StoreVerdict, ...]
    signed: dict[str, str]
    note: str


def require_signed(stored: Stored, public: PublicKey, newest: bool = False) -> Trusted:
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
    again = _at_home(now, stored)
    found = held(now, again, public)
    if newest:
        _check_newer(now, again, public)
    return Trusted(found, _trust(now, public, memory))


def sign(store: Store, reference: str, key: SecretKey, by: str = "") -> Trusted:
    """`Store.sign`, of a store that is not older than what this user has seen with the key."""
    memory = recall()
    memory.check(store.folder, store.now().journal, key.key_id)
    made = store.sign(reference, key, by)
    return Trusted(made, _trust(store.now(), key.public, memory))


def verify_signed(store: Store, public: PublicKey, name: str | None = None) -> TrustVerdict:
    """`Store.verify`, and the signatures of a key: every released version must have one.

    So must each version that the key has ever signed, whatever its state. Raises as
    `require_signed` for what is wrong with the store as a whole, and as `Store.verify`.
    """
    memory = recall()
    verdicts, now = store.verify(name), store.now()
    memory.check(store.folder, now.journal, public.key_id)
    looked = [(verdict, *_looked(now, verdict.id, public)) for verdict in verdicts]
    found = tuple(
        replace(verdict, violations=(*verdict.violations, flaw) if flaw else verdict.violations)
        for verdict, _, flaw in looked
    )
    signed = {verdict.id: state for verdict, state, _ in looked if state}
    sound = all(verdict.sound for verdict in found)
    return TrustVerdict(found, signed, _trust(now, public, memory) if sound else "")


def _looked(now: Snapshot, version: str, public: PublicKey) -> tuple[str, str]:
    """The state in the signature of a version, "" without one; and what is wrong with it."""
    name, _, number = version.partition("@")
    try:
        stored = now.load(name, int(number))
    except StoreError:
        return "", ""  # `Store.verify` says why
    if not stored.state.released and not was_signed(now, name, stored.version, public):
        return "", ""
    try:
        return held(now, stored, public).statement.state, ""
    except SignatureRefused as error:
        return "", error.what if error.where == stored.id else f"{error.where}: {error.what}"


def _check_newer(now: Snapshot, stored: Stored, public: PublicKey) -> None:
    for version in now.journal.of(stored.name):
        if version > stored.version and was_signed(now, stored.name, version, public):
            held(now, now.load(stored.name, version), public)


def _trust(now: Snapshot, public: PublicKey, memory: SeenJournals) -> str:
    """Look at the signatures of the whole store, and keep what was seen; returns a note."""
    anchored(now, public)
    return memory.keep(now.folder, now.journal, public.key_id)


def _at_home(now: Snapshot, stored: Stored) -> Stored:
    """The version in its place in the store, which must be what was loaded."""
    path = stored.path
    home = (path.parent.name, path.name.removeprefix(NEW))
    if home != (stored.name, folder_of(stored.version)):
        raise SignatureRefused(
            "is not in its place in a store, so that no signature and no journal tells of it",
            where=path,
            expected=f"{stored.id} by its name, with --store",
        )
    again = now.load(stored.name, stored.version)
    if again.record != stored.record:
        raise DamagedTable("was replaced while it was read", where=stored.id, do="run it again")
    return again
