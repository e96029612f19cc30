from pathlib import Path

import pytest

from calib.signing.keys import PublicKey, SecretKey, read_public_key, read_secret_key
from tests.signing.golden.make import HERE


def never() -> str:
    raise AssertionError("no password is needed")


@pytest.fixture(scope="session")
def golden() -> Path:
    """The folder of the files that Debian's minisign made."""
    return HERE


@pytest.fixture(scope="session")
def key(golden: Path) -> SecretKey:
    return read_secret_key(golden / "open.key", never)


@pytest.fixture(scope="session")
def public(golden: Path) -> PublicKey:
    return read_public_key(golden / "open.pub")


@pytest.fixture(scope="session")
def content(golden: Path) -> bytes:
    """A signature file."""
    return (golden / "open.minisig").read_bytes()
