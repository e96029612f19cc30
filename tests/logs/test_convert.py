"""What is written is read back equal: to the last bit, with every unit, by other readers too."""

import math
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from calib.errors import LogError
from calib.logs.channel_map_file import read_channel_map
from calib.logs.read import read_log
from calib.logs.whole import WholeColumn, WholeLog, read_whole
from calib.logs.write import ENDINGS, log_content
from tests.support.recordings import ramp, write_map, write_mdf

UNITS = (None, "bar", "kPa", "m/s^2", "°", "N*m", "made up", "1")
NAMES = st.text("abcXYZ äµ.-_/()[]#", min_size=1, max_size=12).map(str.strip).filter(bool)
NUMBERS = st.one_of(
    st.floats(allow_nan=False, allow_infinity=False, width=64), st.just(math.nan), st.just(-0.0)
)


@st.composite
def logs(draw):
    rows = draw(st.integers(3, 8))
    names = draw(st.lists(NAMES, min_size=1, max_size=4, unique=True))
    steps = draw(st.lists(st.floats(1e-3, 1.0), min_size=rows, max_size=rows))
    time = np.cumsum(steps)
    made = [WholeColumn("time", "s", time), WholeColumn("v", "m/s", time)]
    for name in names:
        values = draw(st.lists(NUMBERS, min_size=rows, max_size=rows))
        unit = draw(st.sampled_from(UNITS))
        made.append(WholeColumn(f"x{name}", unit, np.array(values)))
    return WholeLog("run", "here", "", tuple(made))


def write_log(log, path):
    path.write_bytes(log_content(log, path.suffix))


def bits(values):
    """The bits of numbers; every NaN is the same."""
    return np.where(np.isnan(values), np.nan, values).view(np.int64).tolist()


@pytest.mark.parametrize("ending", [".csv", ".parquet"])
@settings(max_examples=60)
@given(log=logs())
def test_a_table_is_read_back_to_the_last_bit(tmp_path_factory, ending, log):
    path = tmp_path_factory.mktemp("written") / f"run{ending}"
    write_log(log, path)
    back = read_whole(path)
    assert [(c.name, c.unit or None) for c in back.columns] == [
        (c.name, c.unit) for c in log.columns
    ]
    for ours, theirs in zip(log.columns, back.columns, strict=True):
        assert bits(ours.values) == bits(theirs.values)


@pytest.mark.parametrize("ending", [".csv", ".parquet"])
@pytest.mark.parametrize("name", ["x[]", "a [b]", "gear_deg", "v_m_s"])
def test_a_name_that_looks_like_one_with_a_unit_stays_whole(tmp_path, name, ending):
    time = np.array([1.0, 2.0, 3.0])
    columns = (WholeColumn("time", "s", time), WholeColumn(name, None, time))
    write_log(WholeLog("run", "here", "", columns), tmp_path / f"run{ending}")
    assert read_whole(tmp_path / f"run{ending}").columns[1].name == name


def test_every_format_is_the_same_log_in_si(tmp_path):
    chart = read_channel_map(write_map(tmp_path))
    source = write_mdf(tmp_path / "bench.mf4")
    ref, whole = read_log(source, chart), read_whole(source, chart)
    for ending in ENDINGS:
        write_log(whole, tmp_path / f"out{ending}")
        back = read_log(tmp_path / f"out{ending}")  # no map is needed any more
        assert list(back.channels) == list(ref.channels)
        for name, values in ref.channels.items():
            np.testing.assert_array_equal(back[name], values, err_msg=f"{ending} {name}")


def test_another_reader_sees_values_and_units_of_mdf(tmp_path):
    from asammdf import MDF

    whole = read_whole(Path(ramp().source))
    write_log(whole, tmp_path / "run.mf4")
    with MDF(tmp_path / "run.mf4") as mdf:
        assert mdf.version == "4.10"
        for column in whole.columns[1:]:
            signal = mdf.get(column.name)
            assert signal.unit == column.unit
            np.testing.assert_array_equal(signal.samples, column.values)
            np.testing.assert_array_equal(signal.timestamps, whole.time)


def test_another_reader_sees_values_and_units_of_parquet(tmp_path):
    whole = read_whole(Path(ramp().source))
    write_log(whole, tmp_path / "run.parquet")
    table = pq.read_table(tmp_path / "run.parquet")
    assert table.schema.field("p_mc").metadata[b"unit"] == b"bar"
    np.testing.assert_array_equal(table["p_mc"].to_numpy(), whole.columns[1].values)


def test_mdf_needs_a_clock(tmp_path):
    log = WholeLog("run", "here", "", (WholeColumn("x", "bar", np.zeros(3)),))
    with pytest.raises(LogError, match="no channel time with a unit"):
        write_log(log, tmp_path / "run.mf4")
    assert list(tmp_path.iterdir()) == []
