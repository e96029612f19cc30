"""A file of another kind than its ending says is named as what it is."""

import pytest

from calib.errors import LogError
from calib.logs.formats import kind_of
from calib.logs.read import FORMATS, open_log, read_log
from tests.support.recordings import RAMP, SEDAN, write_dbc


@pytest.fixture
def bus_map(tmp_path):
    return write_dbc(tmp_path)


POINTER = b"""version https://git-lfs.github.com/spec/v1
oid sha256:4d7a214614ab2935c943f9e0ff69d22eadbb8f32b1258daaa5e2ca24d17e2393
size 123456
"""


@pytest.mark.parametrize("ending", [e for e in FORMATS if e != ".csv.gz"])
@pytest.mark.parametrize("read", [read_log, open_log])
def test_a_pointer_of_git_lfs_is_named_in_every_format(tmp_path, ending, read):
    path = tmp_path / f"run{ending}"
    path.write_bytes(POINTER)
    with pytest.raises(LogError, match=r"a pointer of git LFS.*git lfs pull"):
        read(path)


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
    assert "text of another kind?" in str(error.value)


@pytest.mark.parametrize("ending", [".log", ".asc"])
def test_text_without_a_last_end_of_line_is_not_called_cut_off(bus_map, tmp_path, ending):
    path = tmp_path / f"notes{ending}"
    path.write_text("We drove on wet tile and\nwent home")
    with pytest.raises(LogError) as error:
        read_log(path, bus_map)
    assert "cut off" not in str(error.value)


def test_a_table_that_is_cut_off_is_still_called_so(tmp_path):
    path = tmp_path / "run.csv"
    text = RAMP.read_text()
    path.write_text(text[: len(text) // 2])
    with pytest.raises(LogError, match="cut off"):
        read_log(path)


def test_our_own_logs_are_of_their_kind():
    assert read_log(SEDAN / "coast.csv").time.size == 2000


def test_a_table_that_begins_with_a_word_of_another_kind_is_a_table():
    assert kind_of(b"date time [s],v [m/s]\n0.0,20.5\n") is None
    assert kind_of(b"(time),v [m/s]\n0.0,20.5\n") is None
