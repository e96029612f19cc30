"""A channel outside its record is refused before asammdf reads there (it ends the program)."""

import struct

import pytest

from calib.errors import LogError
from calib.logs.mdf.channels import check_channels
from tests.support.logger_mf4 import Row, logger_mf4
from tests.support.recordings import write_bus, write_mdf
from tests.support.refusals import refusal

ROWS = [Row(0.01 * i, 1, 256, bytes(8)) for i in range(20)]


@pytest.mark.parametrize("vlsd", [False, True])
def test_a_whole_file(tmp_path, vlsd):
    (tmp_path / "a.mf4").write_bytes(logger_mf4(ROWS, vlsd))
    check_channels(tmp_path / "a.mf4")
    check_channels(write_bus(tmp_path / "bus.mf4"))
    check_channels(write_mdf(tmp_path / "run.mf4"))


@pytest.mark.parametrize("name", [b"Timestamp", b"CAN_DataFrame.ID", b"CAN_DataFrame.DataBytes"])
@pytest.mark.parametrize("byte", [20, 1000, 2**32 - 1])
def test_a_channel_outside_its_record(tmp_path, name, byte):
    data = bytearray(logger_mf4(ROWS))
    channel = data.index(b"##CN", data.index(name + b"\0"))
    struct.pack_into("<L", data, channel + 24 + 64 + 4, byte)
    path = tmp_path / "a.mf4"
    path.write_bytes(data)
    message = refusal(check_channels, path, kind=LogError, names="a.mf4")
    assert f"the channel at byte {channel} lies outside" in message
    assert "expected bits within 20 bytes" in message


def test_a_block_that_is_too_short(tmp_path):
    data = bytearray(logger_mf4(ROWS))
    group = data.rindex(b"##DG")
    struct.pack_into("<Q", data, group + 16, 1)
    (tmp_path / "a.mf4").write_bytes(data)
    assert "shorter than its kind" in refusal(check_channels, tmp_path / "a.mf4", kind=LogError)
