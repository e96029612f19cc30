"""Without the extra, what needs it says so; what does not need it works."""

import sys

import pytest

from calib.errors import KeyFileError
from calib.signing.key_pair import generate
from calib.signing.public_key import read_public_key
from calib.signing.secret_key import read_secret_key
from calib.signing.sign import verify
from calib.signing.signature import parse_signature
from tests.signing.conftest import never

SAYS = r"keys are used with cryptography, which is not installed; pip install 'brake-cal\[sign\]'$"


@pytest.fixture
def without(monkeypatch):
    """An environment without cryptography."""
    for name in [m for m in sys.modules if m.split(".")[0] == "cryptography"]:
        monkeypatch.delitem(sys.modules, name)

    class Absent:
        @staticmethod
        def find_spec(name, path=None, target=None):
            if name.split(".")[0] == "cryptography":
                raise ModuleNotFoundError(f"No module named {name!r}", name=name)

    monkeypatch.setattr(sys, "meta_path", [Absent, *sys.meta_path])


def test_the_extra_is_named(without, golden, key, content, tmp_path):
    public = read_public_key(golden / "open.pub")
    uses = [
        lambda: read_secret_key(golden / "open.key", never),
        lambda: read_secret_key(golden / "small.key", lambda: "password"),
        lambda: generate(tmp_path / "car.key", tmp_path / "car.pub", ""),
        lambda: verify(public, b"", parse_signature(content)),
    ]
    for use in uses:
        with pytest.raises(KeyFileError, match=SAYS):
            use()
    assert list(tmp_path.iterdir()) == []


def test_a_key_and_a_signature_are_read_without_it(without, golden, content):
    key = read_public_key(golden / "open.pub")
    assert parse_signature(content).key_id == key.key_id


def test_an_error_inside_the_library_is_not_hidden(monkeypatch):
    class Broken:
        @staticmethod
        def find_spec(name, path=None, target=None):
            if name == "cryptography.exceptions":
                raise ModuleNotFoundError("No module named 'cffi'", name="cffi")

    monkeypatch.delitem(sys.modules, "cryptography.exceptions", raising=False)
    monkeypatch.setattr(sys, "meta_path", [Broken, *sys.meta_path])
    public = read_public_key("RWQf6LRCGA9i53mlYecO4IzT51TGPpvWucNSCh1CBM0QTaLn73Y7GFO3")
    with pytest.raises(ModuleNotFoundError, match="cffi"):
        verify(public, b"", parse_signature(sign_with(public)))


def sign_with(public) -> bytes:
    """A signature file of the key's number; it does not hold."""
    from calib.signing.signature import PREHASHED, Signature

    return Signature(PREHASHED, public.number, bytes(64), "", bytes(64), "").file
