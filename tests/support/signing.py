"""Keys that sign tables, what somebody without a key can do to a store, and what is refused."""

import shutil
from base64 import b64encode

import minisign
import pytest
from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey

from calib.base.errors import StoreError
from calib.store.journal import Journal, write_journal
from calib.store.minisign import SecretKey
from calib.store.signature import require_signed, verify_signed
from calib.store.state import StateDecision
from calib.store.store import Store


def secret_file(number: bytes, seed: bytes) -> bytes:
    """The file of a secret key without a password, as minisign 0.11 writes it."""
    point = Ed25519PrivateKey.from_private_bytes(seed).public_key().public_bytes_raw()
    content = b"Ed" + bytes(2) + b"B2" + bytes(48) + number + seed + point + bytes(32)
    return b"untrusted comment: a key of a test\n" + b64encode(content) + b"\n"


def secret_key(number: bytes, seed: bytes) -> SecretKey:
    return SecretKey(minisign.SecretKey.from_bytes(secret_file(number, seed)))


ADA = secret_key(b"adasline", bytes(range(32)))
EVE = secret_key(b"evesline", bytes(range(1, 33)))
NAMESAKE = secret_key(b"adasline", bytes(range(2, 34)))
"""Another key that bears the number of Ada's."""

RELEASE = StateDecision("released", "four stops agree", by="Ada")
REJECT = StateDecision("rejected", "front pads wet", by="Bob")
WITHDRAW = StateDecision("withdrawn", "pads recalled", by="Bob")


def set_back(store: Store, lines: int) -> None:
    """Cut the journal to its first lines, and write a head that agrees."""
    write_journal(store.folder, Journal(store.snapshot().journal.entries[:lines]))


def replaced_by(store: Store, other: Store) -> None:
    """Put another store in the place of a store, signatures and all."""
    shutil.rmtree(store.folder)
    shutil.copytree(other.folder, store.folder)


def used(store, reference="sedan@2", key=ADA):
    return require_signed(store.load(reference), key.public)


def refusal(store, reference="sedan@2", key=ADA):
    """Why a version is refused; `verify_signed` must refuse the store, too."""
    with pytest.raises(StoreError) as error:
        used(store, reference, key)
    assert error.value.exit_code == 4
    assert not passes(store, key)
    return str(error.value)


def passes(store, key=ADA):
    """Whether `tables verify --key` would end with 0."""
    try:
        return all(verdict.sound for verdict in verify_signed(store, key.public)[0])
    except StoreError:
        return False


def forget(seen_file):
    seen_file.unlink(missing_ok=True)
