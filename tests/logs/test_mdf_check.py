"""Cut files, samples that are missing, channels outside their records, MF4 of CAN loggers."""

import struct
from dataclasses import replace

import asammdf
import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from calib.base.errors import LogError
from calib.logs.mdf import open_mdf
from calib.logs.read import read_log
from tests.support.logger_mf4 import Row, logger_mf4
from tests.support.recordings import write_bus, write_dbc, write_map, write_mdf
from tests.support.refusals import refusal

ROWS = [Row(0.01 * i, 1, 256, struct.pack(">4H", *range(i, i + 4))) for i in range(200)]


def read_logger(folder, data):
    write_dbc(folder)
    path = folder / "run.mf4"
    path.write_bytes(data)
    recording = open_mdf(path, {"": (folder / "chassis.dbc",)})
    traces = recording.read([1, 4])
    recording.close()
    assert path.read_bytes() == data
    assert sorted(p.name for p in folder.iterdir()) == ["chassis.dbc", "map.toml", "run.mf4"]
    return recording, traces


NAMES = ["run.mf4", "packed.mf4", "run.mdf", "bus.mf4"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("mdf")
    write_map(path)
    write_mdf(path / "run.mf4")
    write_mdf(path / "packed.mf4", compression=2)
    write_mdf(path / "run.mdf", "3.30")
    write_bus(path / "bus.mf4")
    return path


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=40)
@given(name=st.sampled_from(NAMES), share=st.floats(0.0, 1.0, exclude_max=True))
@example(name="run.mdf", share=0.999999)  # one byte
def test_a_file_cut_anywhere_is_refused(folder, name, share):
    data = (folder / name).read_bytes()
    size = int(share * len(data))
    path = folder / f"cut_{name}"
    path.write_bytes(data[:size])
    message = refusal(open_mdf, path, {}, kind=LogError)
    assert size < 8 or name == "run.mdf" or "are missing" in message


@pytest.mark.parametrize("vlsd", [False, True])
def test_a_file_that_the_recorder_did_not_finish(tmp_path, vlsd):
    """Identifiers of 16 bits; frames received and sent are one message."""
    rows = [replace(row, sent=i % 3 == 0) for i, row in enumerate(ROWS)]
    for frames in (ROWS, rows):
        recording, (left, right) = read_logger(tmp_path, logger_mf4(frames, vlsd))
        assert recording.columns[1].full == "WHEELS.WhlFL"
        np.testing.assert_allclose(left.time, 0.01 * np.arange(200))
        np.testing.assert_allclose(left.values, 0.005 * np.arange(200))
        np.testing.assert_allclose(right.values, 0.005 * np.arange(3, 203))
        assert any(" 200 records" in note for note in recording.notes)


DATA = logger_mf4(ROWS)
COUNT = DATA.index(struct.pack("<QQHHLLL", 1, 0, 6, 0, 0, 20, 0)) + 8
"""Where the group of the received frames counts its records."""


def with_bytes(place, form, *values, data=DATA):
    packed = struct.pack(form, *values)
    place %= len(data)
    return data[:place] + packed + data[place + len(packed) :]


@pytest.mark.parametrize(
    ("data", "records", "left_out"),
    [
        *((DATA[:-cut], 200 - -(-cut // 21), left)
          for cut, left in ((1, 20), (20, 1), (21, 0), (22, 20))),
        (DATA + bytes(500), 200, 0),  # space that was reserved
        (with_bytes(COUNT, "<Q", 120), 200, 0),  # a recorder may count now and then
    ],
)  # fmt: skip
def test_records_that_are_not_whole_are_left_out_and_told(tmp_path, data, records, left_out):
    recording, (trace, _) = read_logger(tmp_path, data)
    assert trace.time.size == records
    left_out_notes = [note for note in recording.notes if "left out" in note]
    assert [f" {left_out} bytes" in note for note in left_out_notes] == [True] * (left_out > 0)


def place_of_channel(name):
    return DATA.index(b"##CN", DATA.index(name + b"\0"))


def too_far(name, byte):
    """A channel at a byte outside its record."""
    return with_bytes(place_of_channel(name) + 24 + 64 + 4, "<L", byte), str(place_of_channel(name))


REFUSED = {
    "empty": (b"", ""),
    "text": (b"time [s],p_mc [bar]\n" * 10, ""),
    "not finished, nothing in it": (b"UnFinMF 4.10    " + bytes(200), ""),
    "version 5": (b"MDF     5.00    " + bytes(200), "5.00"),
    "no block": (b"MDF     4.10    " + bytes(200), "byte 64"),
    "no block of version 3": (b"MDF     3.30    " + bytes(200), ""),
    "lost records": (with_bytes(COUNT, "<Q", 300), "200 of 300"),
    "damage among the records": (with_bytes(-21 * 50, "B", 77), f"byte {len(DATA) - 21 * 50}:"),
    "short block": (with_bytes(DATA.rindex(b"##DG") + 16, "<Q", 1), "shorter"),
    **{f"flags {flags}": (logger_mf4(ROWS, flags=flags), "") for flags in (0, 0x10, 0x35, 0x02)},
    **{f"{name} at {byte}": too_far(name, byte)
       for name in (b"Timestamp", b"CAN_DataFrame.ID") for byte in (20, 10**9)},
}  # fmt: skip


@pytest.mark.parametrize(("data", "says"), REFUSED.values(), ids=REFUSED)
def test_what_is_no_mdf_or_damaged(tmp_path, data, says):
    assert says in refusal(read_logger, tmp_path, data, kind=LogError)


@pytest.mark.parametrize("name", ["run.mf4", "packed.mf4", "run.mdf"])
def test_fewer_samples_than_the_group_counts(folder, name):
    """Its count is doubled, or so great that asammdf would fill the memory; the data stays."""
    with asammdf.MDF(folder / name) as mdf:
        record = mdf.groups[0].channel_group
        count, links = record.cycles_nr, getattr(record, "links_nr", 0)
    form, offset = ("<I", 22) if name == "run.mdf" else ("<Q", 24 + 8 * links + 8)
    data, place = (folder / name).read_bytes(), record.address + offset
    assert struct.unpack_from(form, data, place) == (count,)
    damaged = [with_bytes(place, form, 2 * count, data=data)]
    if name == "run.mf4":  # and a flag: its records differ in length
        damaged.append(with_bytes(place, "<QH", 10**15, 1, data=data))
    for data in damaged:
        (folder / f"few_{name}").write_bytes(data)
        refusal(read_log, folder / f"few_{name}", folder / "plain.toml", kind=LogError)


def test_a_ring_of_groups_in_version_3(folder):
    data = (folder / "run.mdf").read_bytes()
    (first,) = struct.unpack_from("<I", data, 68)
    (folder / "ring.mdf").write_bytes(with_bytes(first + 4, "<I", first, data=data))
    assert "second link" in refusal(open_mdf, folder / "ring.mdf", {}, kind=LogError)
