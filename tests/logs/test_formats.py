"""What a file is, and how each ending is opened."""

import sys
from pathlib import Path

import numpy as np
import pytest

from calib.base.errors import LogError
from calib.logs.formats import refuse_other_kind
from calib.logs.read import FORMATS, read_log
from tests.support.recordings import RAMP, ramp, write_bus, write_dbc, write_map, write_mdf
from tests.support.refusals import refusal

POINTER = b"""version https://git-lfs.github.com/spec/v1
oid sha256:4d7a214614ab2935c943f9e0ff69d22eadbb8f32b1258daaa5e2ca24d17e2393
size 123456
"""


@pytest.mark.parametrize(
    ("ending", "data", "says"),
    [
        *((ending, POINTER, "git lfs pull") for ending in FORMATS if ending != ".csv.gz"),
        (".csv", b"PAR1\x15\x04", ".parquet"),
        (".blf", b"MDF     4.10    ", ".mf4"),
        (".mf4", b"LOGG\x90\0\0\0", ".blf"),
        (".csv", b"PK\x03\x04\x14\0", "zip"),
        (".parquet", b"\n<!DOCTYPE HTML><html>", "web page"),
        (".txt", b'\xef\xbb\xbf{"a": 1,\n"b": 2}\n', "JSON"),
        (".vbo", b"<?xml version='1.0'?>", "XML"),
        (".csv", b"(1700000000.000400) can0 101#0000D4FF\n", ".log"),
        (".csv", b"date Thu Nov 2 2023\nbase hex  timestamps absolute\n", "ASC"),
        (".csv", b";$FILEVERSION=2.1\n;$STARTTIME=45232.5\n", "TRC"),
        (".csv", b"File created on 02/11/2023\n\n[header]\n", "VBO"),
        (".csv", RAMP.read_bytes()[:50_000], "cut off"),
    ],
)
def test_another_kind_is_named(tmp_path, ending, data, says):
    path = tmp_path / f"run{ending}"
    path.write_bytes(data)
    assert says in refusal(read_log, path, kind=LogError)


def test_a_table_that_begins_with_a_word_of_another_kind_is_a_table():
    refuse_other_kind(b"date time [s],v [m/s]\n0.0,20.5\n", ".csv", "run.csv")
    refuse_other_kind(b"(time),v [m/s]\n0.0,20.5\n", ".csv", "run.csv")
    refuse_other_kind(b"Logger: unit 7\ntime [s],v [m/s]\n", ".csv", "run.csv")
    refuse_other_kind(b"MATLAB export\ntime [s],v [m/s]\n", ".csv", "run.csv")


@pytest.mark.parametrize(
    ("name", "missing", "extra"),
    [("run.mf4", "asammdf", "mdf"), ("bus.mf4", "cantools", "mdf"), ("bus.blf", "can", "can")],
)
def test_what_to_install_is_one_line(tmp_path, brake_cal, monkeypatch, name, missing, extra):
    path, map_file = write(tmp_path, name)
    monkeypatch.setitem(sys.modules, missing, None)
    ran = brake_cal("check", path, "--map", map_file)
    assert (ran.code, len(ran.err.splitlines())) == (3, 1)
    assert f"brake-cal[{extra}]" in ran.err


def write(folder: Path, name: str) -> tuple[Path, Path]:
    """A file of the run and its channel map."""
    path = folder / name
    if "bus" in name:
        return write_bus(path, 0.0 if path.suffix == ".mf4" else 1.7e9), write_dbc(folder)
    version = "4.10" if path.suffix == ".mf4" else "3.30"
    return write_mdf(path, version, 2 if "packed" in name else 0), write_map(folder)


@pytest.mark.smoke
@pytest.mark.parametrize(
    "name", ["run.mf4", "packed.mf4", "run.mdf", "run.dat", "bus.blf", "bus.asc", "bus.log"]
)
def test_the_samples_are_those_of_the_csv(tmp_path, name):
    """Wheels keep their samples to the resolution of the bus; the rest is theirs in between."""
    log, run = read_log(*write(tmp_path, name)), ramp()
    assert run.time[0] <= log.time[0] < log.time[-1] <= run.time[-1]
    for wheel in ("omega_fl", "omega_fr", "omega_rl", "omega_rr"):
        expected = np.interp(log.time, run.time, run[wheel])
        np.testing.assert_allclose(log[wheel], expected, atol=0.0026)
    even = np.isclose(np.round(log.time * 100) / 100, log.time, atol=1e-6)
    p = np.interp(log.time[even], run.time, run["p_mc"])
    np.testing.assert_allclose(log["p_mc"][even], p, atol=600.0)
