"""Keys and signatures as files of minisign, made and verified by the package py-minisign.

A signature file has four lines; numbers are bytes before base64:

    untrusted comment: anybody can change this text
    <algorithm 2, key number 8, signature of the data 64>
    trusted comment: this text is signed, too
    <signature of the first signature and the trusted comment 64>

A public key is <algorithm 2, key number 8, key 32>, in base64 as well.
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

# cost of one try of a password, as in minisign: work of some seconds, memory of 1 GiB [bytes]
_SCRYPT = {"opslimit": 2**25, "memlimit": 2**30}
_MAX_OPSLIMIT = 8 * _SCRYPT["opslimit"]  # of a key that is read: half a minute
_OPSLIMIT = slice(38, 46)  # bytes in a secret key, after three algorithms of 2 and a salt of 32


@dataclass(frozen=True)
class PublicKey:
    """A public key; ``text`` is its base64, as for ``minisign -P``."""

    text: str

    @property
    def key_id(self) -> str:
        """The key number, in hexadecimal as minisign prints it."""
        return _key_id(self.text)

    @property
    def file(self) -> bytes:
        """The content of a public key file."""
        return f"untrusted comment: minisign public key {self.key_id}\n{self.text}\n".encode()


class SecretKey:
    """A secret key that is ready to sign."""

    def __init__(self, key: Any) -> None:
        self._key = key
        self.public = PublicKey(key.get_public_key().to_base64().decode())

    def sign(self, data: bytes, trusted_comment: str) -> bytes:
        """Return the content of a signature file. Raises KeyFileError for a damaged key."""
        with _library_errors_as(KeyFileError, "secret key"):
            signature = self._key.sign(
                data, trusted_comment=trusted_comment, untrusted_comment="signature from brake-cal"
            )
            self._key.get_public_key().verify(data, signature)  # fails for a damaged key
        return bytes(signature) + b"\n"


def read_public_key(source: Path | str) -> PublicKey:
    """Read a public key from a file, or from its base64. Raises KeyFileError."""
    key_class = _library().PublicKey
    if PUBLIC_KEY.fullmatch(str(source)):
        read, content = key_class.from_base64, str(source).encode()
    else:
        read, content = key_class.from_bytes, _content(Path(source))
    with _library_errors_as(KeyFileError, source, "a public key of minisign"):
        return PublicKey(read(content).to_base64().decode())


def read_secret_key(path: Path, password: Callable[[], str]) -> SecretKey:
    """Read a secret key; ``password`` is called if the key is encrypted. Raises KeyFileError."""
    key_class, content = _library().SecretKey, _content(path)
    with _library_errors_as(KeyFileError, path, "a secret key of minisign"):
        key = key_class.from_bytes(content)
        if key.is_encrypted():
            opslimit = int.from_bytes(b64decode(key.to_base64())[_OPSLIMIT], "little")
            if opslimit > _MAX_OPSLIMIT:
                raise KeyFileError("asks for more work than any key of minisign", where=path)
            key.decrypt(password())
        return SecretKey(key)


def generate(secret: Path, public: Path, password: str) -> PublicKey:
    """Write the two files of a new key pair. Raises KeyFileError, and then leaves no file.

    Only the user may read the file ``secret``. An empty ``password`` leaves it unencrypted.
    """
    pair = _library().KeyPair.generate()
    key, public_key = pair.secret_key, PublicKey(pair.public_key.to_base64().decode())
    if password:
        with _library_errors_as(KeyFileError, secret):
            key.encrypt(password, **_SCRYPT)
    files = (secret, bytes(key) + b"\n", 0o600), (public, public_key.file, 0o644)
    try:
        with ExitStack() as undo:  # deletes the new files unless both are complete
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
    """A signature file, not verified: its ``content``, key number and comment."""

    content: bytes
    key_id: str
    trusted_comment: str


def read_signature(path: Path) -> Signature:
    """Read a signature file without verifying it. Raises SignatureRefused for any other file."""
    expected = "a signature of minisign"
    content = bytes_of(path, KEY, SignatureRefused, expected)
    match = _SIGNATURE.fullmatch(content)
    if not match:
        raise SignatureRefused("is cut off or damaged", where=path, expected=expected)
    return Signature(content, _key_id(match[1]), match[2].decode(errors="backslashreplace"))


def verify(public: PublicKey, data: bytes, signature: Signature, where: object) -> None:
    """Raise SignatureRefused at ``where`` unless ``public`` has signed ``data``."""
    with _library_errors_as(SignatureRefused, where):
        parsed = _library().Signature.from_bytes(signature.content)
        _library().PublicKey.from_base64(public.text).verify(data, parsed)


def _library() -> Any:
    return need("minisign", "sign", error=KeyFileError)


@contextmanager
def _library_errors_as(
    error_class: type[BrakeCalError], where: object, expected: str = ""
) -> Iterator[None]:
    """Raise the errors of py-minisign as ``error_class``, without a key or password in them."""
    try:
        yield
    except UnicodeEncodeError:
        raise error_class("the password is not text", where=where) from None
    except MemoryError:
        raise error_class("needs 1 GiB of memory, which is not free", where=where) from None
    except _library().Error as error:
        raise error_class(str(error), where=where, expected=expected) from None


def _content(path: Path) -> bytes:
    return bytes_of(path, KEY, KeyFileError, "a file of minisign")


def _key_id(text: str | bytes) -> str:
    """Return the key number in the base64 ``text`` of a public key or a signature."""
    return f"{int.from_bytes(b64decode(text)[2:10], 'little'):X}"
