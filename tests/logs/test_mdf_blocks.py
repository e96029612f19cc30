"""A cut MDF file is refused, wherever it was cut, with the number of bytes that are missing."""

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from calib.base.errors import LogError
from calib.logs.mdf_records import check_mdf
from calib.logs.read import read_log
from tests.support.recordings import write_bus, write_map, write_mdf

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


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=60)
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


@pytest.mark.parametrize("name", NAMES)
def test_a_whole_file_is_whole(folder, name):
    check_mdf(folder / name)


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


def test_an_unfinished_file(folder):
    data = (folder / "run.mf4").read_bytes()
    path = folder / "open.mf4"
    path.write_bytes(b"UnFinMF " + data[8:])
    with pytest.raises(LogError, match="did not finish"):
        read_log(path, folder / "plain.toml")
