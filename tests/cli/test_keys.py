"""`brake-cal tables key`: passwords from a pipe and from a real terminal."""

import io
import json
import os
import pty
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from calib.base.errors import KeyFileError
from calib.store.minisign import read_public_key, read_secret_key

ROOT = Path(__file__).parents[2]


@pytest.fixture
def files(tmp_path):
    return tmp_path / "line.key", tmp_path / "line.pub"


@pytest.fixture
def cheap(monkeypatch):
    """Keys whose password takes little time."""
    monkeypatch.setattr("calib.store.minisign.SENSITIVE", {"opslimit": 2**15, "memlimit": 2**24})


@pytest.fixture
def make(brake_cal, files, monkeypatch):
    """Run the command with ``typed`` on stdin."""

    def run(*options, typed=b""):
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(typed), encoding="utf-8"))
        return brake_cal("tables", "key", "--secret", files[0], "--public", files[1], *options)

    return run


def never():
    raise AssertionError("the key has no password")


def test_without_a_password(make, files):
    ran = make("--no-password")
    assert (ran.code, ran.err) == (0, "")
    key = read_secret_key(files[0], never)
    assert key.public == read_public_key(files[1])
    assert f"key {key.key_id}\n" in ran.out
    assert "without a password" in ran.out
    assert key.public.text in ran.out


@pytest.mark.parametrize("password", ["Bremse ü", " a b "])
def test_the_password_is_two_lines_of_a_pipe(make, files, cheap, password):
    ran = make(typed=f"{password}\n{password}\r\n".encode("utf-8", "surrogateescape"))
    assert ran.code == 0
    assert "protected by the password" in ran.out
    assert read_secret_key(files[0], lambda: password).public == read_public_key(files[1])
    with pytest.raises(KeyFileError):
        read_secret_key(files[0], lambda: password + ".")


def test_an_empty_password_means_none(make, files):
    ran = make(typed=b"\n\n")
    assert (ran.code, "without a password" in ran.out) == (0, True)
    assert read_secret_key(files[0], never).public == read_public_key(files[1])


@pytest.mark.parametrize(
    ("typed", "says"),
    [
        (b"Bremse 1\nBremse 2\n", "the two passwords differ; nothing was made"),
        (b"Bremse 1\n", "no password was typed"),
        (b"", "no password was typed"),
    ],
)
def test_passwords_that_differ_and_that_are_missing(make, files, typed, says):
    ran = make(typed=typed)
    assert (ran.code, ran.result) == (2, "")
    assert says in ran.err
    assert "Bremse" not in ran.err
    assert not files[0].exists()
    assert not files[1].exists()


def test_an_existing_key_is_kept(make, files):
    assert make("--no-password").code == 0
    before = [path.read_bytes() for path in files]
    ran = make("--no-password")
    assert (ran.code, ran.result) == (3, "")
    assert ran.err == (
        f"error: {files[0]}: exists already; choose another name: a key is not replaced\n"
    )
    assert [path.read_bytes() for path in files] == before


def test_json(make, files, document):
    ran = make("--no-password", "--json")
    key = read_public_key(files[1])
    assert document(ran) == {
        "schema": 1,
        "key_id": key.key_id,
        "public_key": key.text,
        "secret": str(files[0]),
        "public": str(files[1]),
        "password": False,
    }


def test_nothing_secret_is_printed(make, files, cheap):
    ran = make("--json", typed=b"Bremse 1\nBremse 1\n")
    assert json.loads(ran.out)["password"] is True
    word = files[0].read_text().split("\n")[1]
    for said in (ran.out, ran.err):
        assert "Bremse" not in said
        assert not any(word[i : i + 12] in said for i in range(len(word) - 12))


def test_a_terminal_does_not_show_what_is_typed(tmp_path):
    """A child on a terminal of its own; what appears there is read until the child ends."""
    command = [sys.executable, "-m", "cli.main", "tables", "key"]
    command += ["--secret", str(tmp_path / "line.key"), "--public", str(tmp_path / "line.pub")]
    child, terminal = pty.fork()
    if child == 0:
        os.chdir(ROOT)
        os.execv(command[0], command)
    shown = b""
    for prompt in (b"(empty: none): ", b"once more: "):
        while prompt not in shown:
            shown += os.read(terminal, 1000)
        os.write(terminal, b"Bremse 1\n")
    while True:
        try:
            more = os.read(terminal, 1000)
        except OSError:  # the child has closed the terminal
            break
        if not more:
            break
        shown += more
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    assert b"Bremse" not in shown
    assert b"protected by the password" in shown
    read_public_key(tmp_path / "line.pub")


@pytest.mark.skipif(shutil.which("minisign") is None, reason="minisign is not installed")
def test_minisign_signs_with_the_key(make, files, tmp_path):
    assert make("--no-password").code == 0
    (tmp_path / "table.dcm").write_bytes(b"KONSERVIERUNG_FORMAT 2.0\n")
    for way in (("-S", "-s", files[0]), ("-V", "-p", files[1])):
        line = ["minisign", *map(str, way), "-m", str(tmp_path / "table.dcm")]
        assert subprocess.run(line, capture_output=True, check=False).returncode == 0
