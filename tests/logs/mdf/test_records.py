"""A group that counts more samples than there is data for."""

import struct

import asammdf
import numpy as np
import pytest

from calib.errors import LogError
from calib.logs.mdf.records import check_records
from calib.logs.read import read_log
from tests.support.recordings import write_map, write_mdf


@pytest.mark.parametrize("name", ["run.mf4", "packed.mf4", "run.mdf"])
@pytest.mark.parametrize("group", [0, 1])
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


@pytest.mark.parametrize("compression", [0, 1, 2])
def test_a_whole_file_is_whole(tmp_path, compression):
    check_records(write_mdf(tmp_path / "run.mf4", compression=compression))


def test_many_blocks(tmp_path):
    """asammdf splits what is longer than 4 MiB."""
    time = np.arange(600_000) * 1e-3
    with asammdf.MDF() as mdf:
        mdf.append([asammdf.Signal(time, time, name="x", unit="s")])
        path = mdf.save(tmp_path / "long.mf4")
    assert path.read_bytes().count(b"##DT") > 1
    check_records(path)


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
        check_records(path)
