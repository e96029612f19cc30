"""Cut files, samples that are missing, channels outside their records, MF4 of CAN loggers."""

import struct

import asammdf
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from calib.base.errors import LogError
from calib.logs.channel_map import DatabaseFile, Databases
from calib.logs.mdf import open_mdf
from calib.logs.mdf_check import check_mdf
from calib.logs.read import read_log
from tests.support.logger_mf4 import Row, logger_mf4
from tests.support.recordings import write_bus, write_dbc, write_map, write_mdf
from tests.support.refusals import refusal

ROWS = [Row(0.01 * i, 1, 256, struct.pack(">4H", *range(i, i + 4))) for i in range(200)]


def opened(folder, data):
    write_dbc(folder)
    path = folder / "run.mf4"
    path.write_bytes(data)
    found = open_mdf(path, Databases((DatabaseFile(folder / "chassis.dbc"),)))
    traces = found.read([1, 4])
    found.close()
    assert path.read_bytes() == data
    assert sorted(p.name for p in folder.iterdir()) == ["chassis.dbc", "map.toml", "run.mf4"]
    return found, traces


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
def test_a_file_cut_anywhere_is_refused(folder, name, share):
    data = (folder / name).read_bytes()
    left = int(share * len(data))
    path = folder / f"cut_{name}"
    path.write_bytes(data[:left])
    with pytest.raises(LogError) as error:
        check_mdf(path)
    assert error.value.exit_code == 3
    if left >= 8:
        assert "are missing" in str(error.value)


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"", "not an MDF file"),
        (b"time [s],p_mc [bar]\n" * 10, "not an MDF file"),
        (b"UnFinMF 4.10    " + bytes(200), "did not finish the file"),
        (b"MDF     5.00    " + bytes(200), "MDF version '5.00'"),
        (b"MDF     4.10    " + bytes(200), "should be a block at byte 64"),
        (b"MDF     3.30    " + bytes(200), "should be a HD block at byte 64"),
    ],
)
def test_what_is_no_mdf(tmp_path, data, words):
    path = tmp_path / "run.mf4"
    path.write_bytes(data)
    with pytest.raises(LogError, match=words):
        check_mdf(path)


@pytest.mark.parametrize("vlsd", [False, True])
def test_frames_whose_identifier_has_16_bits(tmp_path, vlsd):
    found, (left, right) = opened(tmp_path, logger_mf4(ROWS, vlsd))
    np.testing.assert_allclose(left.time, 0.01 * np.arange(200))
    np.testing.assert_allclose(left.values, 0.005 * np.arange(200))
    np.testing.assert_allclose(right.values, 0.005 * np.arange(3, 203))
    assert any("did not finish the file: its 200 records were counted" in n for n in found.notes)
    assert not any("left out" in n for n in found.notes)


@pytest.mark.parametrize("vlsd", [False, True])
def test_frames_received_and_sent_are_one_message(tmp_path, vlsd):
    rows = [Row(r.time, 1, 256, r.data, sent=i % 3 == 0) for i, r in enumerate(ROWS)]
    found, (left, _) = opened(tmp_path, logger_mf4(rows, vlsd))
    assert found.columns[1].full == "WHEELS.WhlFL"
    np.testing.assert_allclose(left.time, 0.01 * np.arange(200))
    np.testing.assert_allclose(left.values, 0.005 * np.arange(200))


def test_two_buses_stay_apart(tmp_path):
    rows = [Row(r.time, bus, 256, r.data) for r in ROWS for bus in (1, 2)]
    found, _ = opened(tmp_path, logger_mf4(rows))
    assert {c.full for c in found.columns[1:]} >= {"1.WHEELS.WhlFL", "2.WHEELS.WhlFL"}


@pytest.mark.parametrize(("cut", "left"), [(1, 20), (20, 1), (21, 0), (22, 20)])
def test_a_record_that_is_not_whole_is_left_out_and_told(tmp_path, cut, left):
    found, (trace, _) = opened(tmp_path, logger_mf4(ROWS)[:-cut])
    assert trace.time.size == 200 - -(-cut // 21)
    told = [n for n in found.notes if "left out" in n]
    assert told == [] if left == 0 else f" {left} bytes of a last record" in told[0]


def test_space_that_was_reserved_is_no_record(tmp_path):
    found, (trace, _) = opened(tmp_path, logger_mf4(ROWS) + bytes(500))
    assert trace.time.size == 200
    assert not any("left out" in n for n in found.notes)


def test_counts_that_were_written_now_and_then(tmp_path):
    """A recorder may count from time to time: fewer than there are is no loss, more is one."""
    data = bytearray(logger_mf4(ROWS))
    place = data.index(struct.pack("<QQHHLLL", 1, 0, 6, 0, 0, 20, 0)) + 8
    struct.pack_into("<Q", data, place, 120)
    _, (trace, _) = opened(tmp_path, bytes(data))
    assert trace.time.size == 200
    struct.pack_into("<Q", data, place, 300)
    message = refusal(opened, tmp_path, bytes(data), kind=LogError)
    assert "200 of 300 records are there: 100 are missing" in message


def test_damage_among_the_records(tmp_path):
    data = bytearray(logger_mf4(ROWS))
    data[-21 * 50] = 77
    message = refusal(opened, tmp_path, bytes(data), kind=LogError)
    assert f"damaged near byte {len(data) - 21 * 50}: no group" in message


@pytest.mark.parametrize("flags", [0, 0x10, 0x35, 0x02])
def test_what_is_not_finished_here(tmp_path, flags):
    message = refusal(opened, tmp_path, logger_mf4(ROWS, flags=flags), kind=LogError)
    assert "did not finish the file (UnFinMF)" in message


def test_a_finished_file_that_lost_its_end_mark(tmp_path):
    """A whole file of asammdf, marked as unfinished: nothing changes but the mark."""
    path = tmp_path / "run.mf4"
    with asammdf.MDF(version="4.10") as mdf:
        time = np.arange(300) * 0.01
        mdf.append([asammdf.Signal(time**2, time, name="x", unit="m")])
        mdf.save(path)
    data = bytearray(path.read_bytes())
    data[:8] = b"UnFinMF "
    struct.pack_into("<H", data, 60, 5)
    path.write_bytes(data)
    found = open_mdf(path, Databases())
    np.testing.assert_array_equal(found.read([1])[0].values, time**2)
    assert "its 300 records" in found.notes[0]
    found.close()


@pytest.mark.parametrize(("name", "group"), [("run.mf4", 0), ("packed.mf4", 1), ("run.mdf", 1)])
def test_fewer_samples_than_the_group_counts(tmp_path, name, group):
    """Its count is doubled where it is written; the data stays."""
    version = "3.30" if name == "run.mdf" else "4.10"
    path = write_mdf(tmp_path / name, version, 2 if name == "packed.mf4" else 0)
    with asammdf.MDF(path) as mdf:
        record = mdf.groups[group].channel_group
        place, count = record.address, record.cycles_nr
        links = getattr(record, "links_nr", 0)
    form, offset = ("<I", 22) if name == "run.mdf" else ("<Q", 24 + 8 * links + 8)
    data = bytearray(path.read_bytes())
    assert struct.unpack_from(form, data, place + offset) == (count,)
    struct.pack_into(form, data, place + offset, 2 * count)
    path.write_bytes(data)
    with pytest.raises(LogError, match=r"missing") as error:
        read_log(path, write_map(tmp_path))
    if name != "run.mdf":
        assert f"data group {group} holds" in str(error.value)
        assert "(50 %)" in str(error.value)


def test_many_blocks(tmp_path):
    """asammdf splits what is longer than 4 MiB."""
    time = np.arange(600_000) * 1e-3
    with asammdf.MDF() as mdf:
        mdf.append([asammdf.Signal(time, time, name="x", unit="s")])
        path = mdf.save(tmp_path / "long.mf4")
    assert path.read_bytes().count(b"##DT") > 1
    check_mdf(path)


def test_a_group_with_channels_that_says_its_records_differ_in_length(tmp_path):
    """Its count is still asked, or asammdf makes room for all that it counts."""
    path = write_mdf(tmp_path / "run.mf4")
    with asammdf.MDF(path) as mdf:
        record = mdf.groups[0].channel_group
        place = record.address + 24 + 8 * record.links_nr
    data = bytearray(path.read_bytes())
    struct.pack_into("<QH", data, place + 8, 10**15, 1)
    path.write_bytes(data)
    with pytest.raises(LogError, match="data group 0 unpacks to"):
        check_mdf(path)


@pytest.mark.parametrize("name", [b"Timestamp", b"CAN_DataFrame.ID"])
@pytest.mark.parametrize("byte", [20, 2**32 - 1])
def test_a_channel_outside_its_record(tmp_path, name, byte):
    data = bytearray(logger_mf4(ROWS))
    channel = data.index(b"##CN", data.index(name + b"\0"))
    struct.pack_into("<L", data, channel + 24 + 64 + 4, byte)
    path = tmp_path / "a.mf4"
    path.write_bytes(data)
    message = refusal(check_mdf, path, kind=LogError, names="a.mf4")
    assert f"the channel at byte {channel} lies outside" in message
    assert "expected bits within 20 bytes" in message


def test_a_block_that_is_too_short(tmp_path):
    data = bytearray(logger_mf4(ROWS))
    group = data.rindex(b"##DG")
    struct.pack_into("<Q", data, group + 16, 1)
    (tmp_path / "a.mf4").write_bytes(data)
    assert "shorter than its kind" in refusal(check_mdf, tmp_path / "a.mf4", kind=LogError)
