"""New key pairs: what is written, and that nothing is ever replaced."""

import os
import stat

import pytest

from calib.errors import KeyFileError
from calib.signing.key_pair import generate
from calib.signing.password import Cost
from calib.signing.public_key import read_public_key
from calib.signing.secret_key import read_secret_key
from calib.signing.sign import sign, verify
from calib.signing.signature import parse_signature
from tests.signing.conftest import never

CHEAP = Cost(2**15, 2**24)


@pytest.fixture
def files(tmp_path):
    return tmp_path / "car.key", tmp_path / "car.pub"


@pytest.mark.parametrize("password", ["", "Bremse 8"])
def test_a_new_pair_signs_and_verifies(files, password):
    secret, public = files
    made = generate(secret, public, password, CHEAP)
    key = read_secret_key(secret, (lambda: password) if password else never)
    assert made == key.public == read_public_key(public)
    signature = parse_signature(sign(key, b"data", "comment"))
    assert verify(made, b"data", signature) == "comment"


def test_only_the_owner_reads_the_secret_key(files):
    old = os.umask(0)
    try:
        generate(*files, "")
    finally:
        os.umask(old)
    assert [stat.S_IMODE(path.stat().st_mode) for path in files] == [0o600, 0o644]


def test_every_pair_is_new(tmp_path):
    made = [generate(tmp_path / f"{i}.key", tmp_path / f"{i}.pub", "") for i in range(20)]
    assert len({key.number for key in made}) == len({key.point for key in made}) == 20


@pytest.mark.parametrize("existing", [0, 1])
def test_an_existing_file_is_not_replaced(files, existing):
    files[existing].write_text("precious")
    with pytest.raises(KeyFileError, match="exists already") as refusal:
        generate(*files, "")
    assert str(files[existing]) in str(refusal.value)
    assert files[existing].read_text() == "precious"
    assert not files[1 - existing].exists()


@pytest.mark.parametrize("existing", [0, 1])
def test_a_file_that_comes_into_being_meanwhile_is_not_replaced(files, monkeypatch, existing):
    files[existing].write_text("precious")
    monkeypatch.setattr(os.path, "lexists", lambda _: False)
    with pytest.raises(KeyFileError, match="exists already"):
        generate(*files, "")
    assert files[existing].read_text() == "precious"
    assert not files[1 - existing].exists()


def test_a_link_to_nowhere_is_not_followed(files):
    files[0].symlink_to(files[0].with_name("elsewhere"))
    with pytest.raises(KeyFileError, match="exists already"):
        generate(*files, "")
    assert [path.name for path in files[0].parent.iterdir()] == ["car.key"]


def test_one_file_for_both_is_refused(files):
    with pytest.raises(KeyFileError, match="one file for both keys"):
        generate(files[0], files[0], "")
    assert not files[0].exists()


def test_a_folder_that_is_missing_leaves_nothing(tmp_path):
    with pytest.raises(KeyFileError, match=r"car\.pub: cannot be written"):
        generate(tmp_path / "car.key", tmp_path / "none" / "car.pub", "")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("write", [1, 2])
def test_a_full_disk_leaves_nothing(files, monkeypatch, write):
    done = []

    def full(handle):
        done.append(handle)
        if len(done) == write:
            raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(KeyFileError, match=r"cannot be written \(No space left on device\)"):
        generate(*files, "")
    assert list(files[0].parent.iterdir()) == []


def test_a_password_that_minisign_cannot_read_leaves_nothing(files):
    with pytest.raises(KeyFileError, match="line end"):
        generate(*files, "two\nlines", CHEAP)
    assert list(files[0].parent.iterdir()) == []
