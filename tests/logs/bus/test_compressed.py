"""Packed logs of bus frames: the same channels, and messages that name the packed file."""

import gzip
import tempfile

import numpy as np
import pytest

from calib.errors import LogError
from calib.logs.read import read_log
from tests.support.recordings import messages, write_bus
from tests.support.refusals import refusal
from tests.support.trc import trc


@pytest.fixture(scope="module")
def folder(bus):
    for ending in ("blf", "asc", "log"):
        write_bus(bus / f"whole.{ending}", 1.7e9)
    (bus / "whole.trc").write_text(trc("2.1", messages()))
    for ending in ("blf", "asc", "log", "trc"):
        plain = (bus / f"whole.{ending}").read_bytes()
        (bus / f"run.{ending}.gz").write_bytes(gzip.compress(plain))
        (bus / f"cut.{ending}.gz").write_bytes(gzip.compress(plain[: len(plain) // 2 + 7]))
    return bus


@pytest.fixture
def temporary(tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    return tmp_path


@pytest.mark.parametrize("ending", ["blf", "asc", "log", "trc"])
def test_the_channels_are_those_of_the_plain_log(folder, temporary, ending):
    path = folder / f"run.{ending}.gz"
    log, plain = (read_log(p, folder / "map.toml") for p in (path, folder / f"whole.{ending}"))
    assert (log.name, log.source) == ("run", str(path))
    assert log.digest != plain.digest
    assert log.notes == plain.notes
    for name in plain.channels:
        np.testing.assert_array_equal(log[name], plain[name])
    assert list(temporary.iterdir()) == []


@pytest.mark.parametrize("ending", ["blf", "asc", "log", "trc"])
def test_a_plain_log_that_was_cut_before_it_was_packed(folder, temporary, ending):
    path = folder / f"cut.{ending}.gz"
    message = refusal(read_log, path, folder / "map.toml", kind=LogError, names=path.name)
    assert "missing" in message or "cut off" in message
    assert str(temporary) not in message
    assert list(temporary.iterdir()) == []


@pytest.mark.parametrize("share", [0.0, 0.3, 0.9, 0.999])
def test_a_packed_log_that_was_cut(folder, share):
    data = (folder / "run.blf.gz").read_bytes()
    path = folder / "half.blf.gz"
    path.write_bytes(data[: int(share * len(data))])
    message = refusal(read_log, path, folder / "map.toml", kind=LogError, names=path.name)
    assert "cut off" in message or "not gzip" in message or "not a BLF" in message
