import os
import socket
from pathlib import Path

import pytest

from calib.base.bounded import POINTER, TOML, FileKind, bytes_of, read_bounded
from calib.base.errors import InputError, LogError, SettingsError

SMALL = FileKind("small", 0.001)


def test_a_regular_file_is_read_through_links(tmp_path):
    (tmp_path / "a").write_bytes(b"x" * 1000)
    (tmp_path / "b").symlink_to("a")
    assert read_bounded(tmp_path / "b", SMALL) == b"x" * 1000


def test_a_byte_more_is_refused_unless_the_variable_allows_it(tmp_path, monkeypatch):
    (tmp_path / "a").write_bytes(b"x" * 1001)
    with pytest.raises(OSError, match="BRAKE_CAL_MOST_SMALL"):
        read_bounded(tmp_path / "a", SMALL)
    monkeypatch.setenv("BRAKE_CAL_MOST_SMALL", "0.002")
    assert len(read_bounded(tmp_path / "a", SMALL)) == 1001


@pytest.mark.parametrize("written", ["many", "-1", "0", "nan", "inf"])
def test_a_variable_that_is_no_size_is_an_error(monkeypatch, written):
    monkeypatch.setenv("BRAKE_CAL_MOST_SMALL", written)
    with pytest.raises(SettingsError, match="is no size"):
        _ = SMALL.max_bytes


def test_a_file_whose_size_its_system_does_not_know():
    """Files of /proc have size 0."""
    assert os.stat("/proc/self/maps").st_size == 0
    with pytest.raises(OSError, match="more than"):
        read_bounded(Path("/proc/self/maps"), FileKind("small", 0.0001))


def listening(path):
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(os.path.relpath(path))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (os.mkfifo, "a pipe or a device"),
        (Path.mkdir, "directory"),
        (lambda path: path.symlink_to("/dev/zero"), "a pipe or a device"),
        (lambda path: path.symlink_to(path), "symbolic links"),
        (listening, "No such device or address"),
        (lambda path: None, "No such file"),
    ],
)
def test_nodes_that_are_no_files_are_refused(tmp_path, monkeypatch, make, message):
    monkeypatch.chdir(tmp_path)
    make(tmp_path / "a")
    with pytest.raises(OSError, match=message):
        read_bounded(tmp_path / "a", SMALL)


def test_a_missing_file_is_an_error_of_the_program(tmp_path):
    with pytest.raises(LogError, match="no such file; expected a log"):
        bytes_of(tmp_path / "a", SMALL, LogError, "a log")


def test_a_pointer_of_git_lfs_is_named(tmp_path):
    path = tmp_path / "car.toml"
    path.write_bytes(POINTER + b".github.com/spec/v1\noid sha256:ab\nsize 1\n")
    with pytest.raises(InputError, match=r"a pointer of git LFS.*expected a TOML.*git lfs pull"):
        bytes_of(path, TOML, InputError, "a TOML file")
