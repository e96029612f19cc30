"""What a file is, and how each ending is opened."""

import gzip
import tempfile
from pathlib import Path

import numpy as np
import pytest

from calib.base.errors import LogError
from calib.logs.formats import TABLES, ending_of, kind_of, stem_of
from calib.logs.read import FORMATS, read_log
from tests.support.recordings import (
    RAMP,
    messages,
    ramp,
    write_bus,
    write_dbc,
    write_map,
    write_mdf,
)
from tests.support.refusals import refusal
from tests.support.trc import trc

POINTER = b"""version https://git-lfs.github.com/spec/v1
oid sha256:4d7a214614ab2935c943f9e0ff69d22eadbb8f32b1258daaa5e2ca24d17e2393
size 123456
"""


@pytest.mark.parametrize("ending", [e for e in FORMATS if e != ".csv.gz"])
def test_a_pointer_of_git_lfs_is_named_in_every_format(tmp_path, ending):
    path = tmp_path / f"run{ending}"
    path.write_bytes(POINTER)
    with pytest.raises(LogError, match="git lfs pull"):
        read_log(path)


@pytest.mark.parametrize(
    ("ending", "data", "says"),
    [
        (".csv", b"PAR1\x15\x04", r"a Parquet file, not a \.csv file.*rename it to \.parquet"),
        (".blf", b"MDF     4.10    ", r"an MDF file.*rename it to \.mf4"),
        (".mf4", b"LOGG\x90\0\0\0", r"a BLF file.*rename it to \.blf"),
        (".csv", b"PK\x03\x04\x14\0", "a zip archive or a workbook"),
        (".parquet", b"\n<!DOCTYPE HTML><html>", "a web page"),
        (".txt", b'\xef\xbb\xbf{"a": 1,\n"b": 2}\n', "a JSON file"),
        (".vbo", b"<?xml version='1.0'?>", "an XML file"),
        (".csv", b"(1700000000.000400) can0 101#0000D4FF\n", r"a candump log.*rename it to \.log"),
        (".csv", b"date Thu Nov 2 2023\nbase hex  timestamps absolute\n", "a Vector ASC log"),
        (".csv", b";$FILEVERSION=2.1\n;$STARTTIME=45232.5\n", "a PEAK TRC log"),
        (".csv", b"File created on 02/11/2023\n\n[header]\n", "a VBO log"),
    ],
)
def test_another_kind_is_named(tmp_path, ending, data, says):
    path = tmp_path / f"run{ending}"
    path.write_bytes(data)
    with pytest.raises(LogError, match=says):
        read_log(path)


def test_text_of_another_kind_is_not_called_cut_off(tmp_path):
    path = tmp_path / "notes.csv"
    rows = ["time [s],v [m/s],a_x [g]", *["0.1,20.5,0.2"] * 500]
    lines = [*rows, *["We drove on wet tile, and"] * 30, "went home"]
    path.write_text("\n".join([*lines, ""]))
    with pytest.raises(LogError) as error:
        read_log(path)
    assert "cut off" not in str(error.value)


@pytest.mark.parametrize("ending", [".log", ".asc"])
def test_text_without_a_last_end_of_line_is_not_called_cut_off(tmp_path, ending):
    path = tmp_path / f"notes{ending}"
    path.write_text("We drove on wet tile and\nwent home")
    with pytest.raises(LogError) as error:
        read_log(path, write_dbc(tmp_path))
    assert "cut off" not in str(error.value)


def test_a_table_that_is_cut_off_is_still_called_so(tmp_path):
    path = tmp_path / "run.csv"
    text = RAMP.read_text()
    path.write_text(text[: len(text) // 2])
    with pytest.raises(LogError, match="cut off"):
        read_log(path)


def test_a_table_that_begins_with_a_word_of_another_kind_is_a_table():
    assert kind_of(b"date time [s],v [m/s]\n0.0,20.5\n") is None
    assert kind_of(b"(time),v [m/s]\n0.0,20.5\n") is None


@pytest.mark.parametrize(
    ("name", "ending", "stem"),
    [
        ("ramp.csv", ".csv", "ramp"),
        ("ramp.csv.gz", ".csv.gz", "ramp"),
        ("ramp.2.CSV.GZ", ".csv.gz", "ramp.2"),
        ("ramp.v1.parquet", ".parquet", "ramp.v1"),
        ("RUN.VBO", ".vbo", "RUN"),
        ("ramp", "", "ramp"),
        ("ramp.gz", ".gz", "ramp"),
    ],
)
def test_ending_and_stem(name, ending, stem):
    path = Path("runs.2024") / name
    assert ending_of(path) == ending
    assert stem_of(path) == stem
    assert ending in TABLES or ending in ("", ".gz")


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


@pytest.mark.parametrize("ending", ["blf", "trc"])
def test_a_plain_log_that_was_cut_before_it_was_packed(folder, temporary, ending):
    path = folder / f"cut.{ending}.gz"
    message = refusal(read_log, path, folder / "map.toml", kind=LogError, names=path.name)
    assert "missing" in message or "cut off" in message
    assert str(temporary) not in message
    assert list(temporary.iterdir()) == []


@pytest.mark.parametrize("share", [0.0, 0.9])
def test_a_packed_log_that_was_cut(folder, share):
    data = (folder / "run.blf.gz").read_bytes()
    path = folder / "half.blf.gz"
    path.write_bytes(data[: int(share * len(data))])
    message = refusal(read_log, path, folder / "map.toml", kind=LogError, names=path.name)
    assert "cut off" in message or "not gzip" in message or "not a BLF" in message


def write(folder: Path, name: str) -> tuple[Path, Path]:
    """A file of the run and its channel map."""
    path = folder / name
    if "bus" in name:
        return write_bus(path, 0.0 if path.suffix == ".mf4" else 1.7e9), write_dbc(folder)
    version = "4.10" if path.suffix == ".mf4" else "3.30"
    return write_mdf(path, version, 2 if "packed" in name else 0), write_map(folder)


@pytest.mark.smoke
@pytest.mark.parametrize(
    "name",
    ["run.mf4", "packed.mf4", "run.mdf", "run.dat", "bus.blf", "bus.asc", "bus.log"],
)
def test_the_samples_are_those_of_the_csv(tmp_path, name):
    """Wheels keep their samples to the resolution of the bus; the rest is theirs in between."""
    log, run = read_log(*write(tmp_path, name)), ramp()
    assert run.time[0] <= log.time[0] < log.time[-1] <= run.time[-1]
    for wheel in ("omega_fl", "omega_fr", "omega_rl", "omega_rr"):
        known = np.interp(log.time, run.time, run[wheel])
        np.testing.assert_allclose(log[wheel], known, atol=0.0026)
    even = np.isclose(np.round(log.time * 100) / 100, log.time, atol=1e-6)
    p = np.interp(log.time[even], run.time, run["p_mc"])
    np.testing.assert_allclose(log["p_mc"][even], p, atol=600.0)
