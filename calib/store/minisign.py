"""Keys and signatures as files of minisign, by py-minisign.

untrusted comment: anybody can change this text
algorithm 2, key number 8, signature of the data 64      as base64
trusted comment: signed with the signature
signature of the signature and the trusted comment 64    as base64
"""

import os
import re
from base64 import b64decode
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from calib.base.bounded import KEY, bytes_of
from calib.base.errors import BrakeCalError, KeyFileError, SignatureRefused
from calib.base.extras import need
from calib.base.names import PUBLIC_KEY
from calib.base.write import sync

_SIGNATURE = re.compile(
    rb"untrusted comment: [^\n]*\n([A-Za-z0-9+/]{99}=)\r?\n"
    rb"trusted comment: ([^\r\n]*)\r?\n[A-Za-z0-9+/]{86}==\r?\n"
)

_SENSITIVE = {"opslimit": 2**25, "memlimit": 2**30}  # cost of one password: 1 GiB, seconds
_MOST_WORK = 8 * _SENSITIVE["opslimit"]  # half a minute: more than any file of minisign has


@dataclass(frozen=True)
class PublicKey:
    """A public key; ``text`` is its base64, as for ``minisign -P``."""

    text: str

    @property
    def key_id(self) -> str:
        """The key number as minisign prints it."""
        return _key_id(self.text)

    @property
    def file(self) -> bytes:
        """The content of a public key file."""
        return f"untrusted comment: minisign public key {self.key_id}\n{self.text}\n".encode()


class SecretKey:
    """A secret key, ready to sign; its repr shows the key number only."""

    def __init__(self, key: Any) -> None:
        self._key = key
        self.public = PublicKey(key.get_public_key().to_base64().decode())

    def __repr__(self) -> str:
        return f"SecretKey({self.public.key_id})"

    def sign(self, data: bytes, trusted_comment: str) -> bytes:
        """The content of the signature file of ``data``. Raises KeyFileError for a damaged key."""
        with _refused(KeyFileError, "secret key"):
            signature = self._key.sign(
                data, trusted_comment=trusted_comment, untrusted_comment="signature from brake-cal"
            )
            self._key.get_public_key().verify(data, signature)
        return bytes(signature) + b"\n"


def read_public_key(source: Path | str) -> PublicKey:
    """Read a public key from a file, or from its base64. Raises KeyFileError."""
    kind = _library().PublicKey
    if PUBLIC_KEY.fullmatch(str(source)):
        read, content = kind.from_base64, str(source).encode()
    else:
        read, content = kind.from_bytes, _content(Path(source))
    with _refused(KeyFileError, source, "a public key of minisign"):
        return PublicKey(read(content).to_base64().decode())


def read_secret_key(path: Path, password: Callable[[], str]) -> SecretKey:
    """Read a secret key file; ``password`` is called if it is encrypted. Raises KeyFileError."""
    kind, content = _library().SecretKey, _content(path)
    with _refused(KeyFileError, path, "a secret key of minisign"):
        key = kind.from_bytes(content)
        if key.is_encrypted():
            if int.from_bytes(b64decode(key.to_base64())[38:46], "little") > _MOST_WORK:
                raise KeyFileError("asks for more work than any key of minisign", where=path)
            key.decrypt(password())
        return SecretKey(key)


def generate(secret: Path, public: Path, password: str) -> PublicKey:
    """Write a new key pair, the ``secret`` key for its owner alone; an empty password is none.

    On KeyFileError no file remains.
    """
    pair = _library().KeyPair.generate()
    key, public_key = pair.secret_key, PublicKey(pair.public_key.to_base64().decode())
    if password:
        with _refused(KeyFileError, secret):
            key.encrypt(password, **_SENSITIVE)
    files = (secret, bytes(key) + b"\n", 0o600), (public, public_key.file, 0o644)
    try:
        with ExitStack() as undo:
            for path, content, mode in files:
                with open(path, "xb", opener=partial(os.open, mode=mode)) as file:
                    undo.callback(path.unlink)
                    file.write(content)
                sync(path)
            undo.pop_all()
    except FileExistsError:
        do = "choose another name: a key is not replaced"
        raise KeyFileError("exists already", where=path, do=do) from None
    except OSError as error:
        raise KeyFileError(f"cannot be written ({error.strerror})", where=path) from None
    return public_key


class Signature(NamedTuple):
    """An unverified signature file of the key ``key_id``."""

    content: bytes
    key_id: str
    trusted_comment: str


def read_signature(path: Path) -> Signature:
    """Read a signature file without verifying it. Raises SignatureRefused if it is none."""
    expected = "a signature of minisign"
    content = bytes_of(path, KEY, SignatureRefused, expected)
    match = _SIGNATURE.fullmatch(content)
    if not match:
        raise SignatureRefused("is cut off or damaged", where=path, expected=expected)
    comment = match[2].decode(errors="backslashreplace")
    return Signature(content, _key_id(match[1]), comment)


def verify(public: PublicKey, data: bytes, signature: Signature, where: object) -> None:
    """Raise SignatureRefused unless the key made ``signature`` for ``data`` and its comment."""
    library = _library()
    with _refused(SignatureRefused, where):
        parsed = library.Signature.from_bytes(signature.content)
        library.PublicKey.from_base64(public.text).verify(data, parsed)


def _library() -> Any:
    return need("minisign", "sign", error=KeyFileError)


@contextmanager
def _refused(kind: type[BrakeCalError], where: object, expected: str = "") -> Iterator[None]:
    """Turn errors of the library into ``kind``; none shows a key or a password."""
    try:
        yield
    except UnicodeEncodeError:
        raise kind("the password is not text", where=where) from None
    except MemoryError:
        raise kind("needs 1 GiB of memory, which is not free", where=where) from None
    except _library().Error as error:
        raise kind(str(error), where=where, expected=expected) from None


def _content(path: Path) -> bytes:
    return bytes_of(path, KEY, KeyFileError, "a file of minisign")


def _key_id(word: str | bytes) -> str:
    """The key number in the base64 of a key or signature, as minisign prints it."""
    return f"{int.from_bytes(b64decode(word)[2:10], 'little'):X}"
