"""A new pair of keys in two files."""

import os
import secrets
from pathlib import Path

from calib.errors import KeyFileError
from calib.signing.password import SENSITIVE, Cost, check_new_password
from calib.signing.public_key import PublicKey
from calib.signing.secret_key import SecretKey, locked_file, secret_file


def generate(secret: Path, public: Path, password: str, cost: Cost = SENSITIVE) -> PublicKey:
    """Make a key pair and write it as minisign does; an empty password means none.

    Parameters
    ----------
    secret : file of the secret key; only its owner can read it.
    public : file of the public key.
    password : hides the secret key; at most 1022 bytes in one line.
    cost : work and memory that each try of a password takes.

    Raises
    ------
    KeyFileError : a file exists already or cannot be written, the password cannot be typed into
        minisign, or there is not enough memory. No file is left then.
    """
    check_new_password(password)
    if secret.absolute() == public.absolute():
        raise KeyFileError("one file for both keys", where=secret, expected="two files")
    for path in (secret, public):
        if os.path.lexists(path):
            raise _exists(path)
    number, seed = secrets.token_bytes(8), secrets.token_bytes(32)
    content = (
        locked_file(number, seed, password, secrets.token_bytes(32), cost)
        if password
        else secret_file(number, seed)
    )
    key = SecretKey(number, seed).public
    _write_new(secret, content, 0o600)
    try:
        _write_new(public, key.file, 0o644)
    except KeyFileError:
        secret.unlink()
        raise
    return key


def _exists(path: Path) -> KeyFileError:
    return KeyFileError(
        "exists already", where=path, do="choose another name: a key is not replaced"
    )


def _write_new(path: Path, content: bytes, mode: int) -> None:
    """Write a file that must not exist; nothing of it is left if that fails."""
    try:
        handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, mode)
    except FileExistsError:
        raise _exists(path) from None
    except OSError as error:
        raise KeyFileError(f"cannot be written ({error.strerror})", where=path) from None
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
    except BaseException as error:
        path.unlink(missing_ok=True)
        if isinstance(error, OSError):
            raise KeyFileError(f"cannot be written ({error.strerror})", where=path) from None
        raise
