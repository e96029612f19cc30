"""Logs written and read back: their channels, and every column."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from calib.base.names import CHANNELS
from calib.logs.channel_map_file import read_channel_map
from calib.logs.log import Log
from calib.logs.read import read_log
from calib.logs.whole import WholeColumn, WholeLog, read_whole
from calib.logs.write import WRITERS, write_csv, write_parquet
from tests.support.recordings import write_map, write_mdf

RNG = np.random.default_rng(3)
VALUES = {name: RNG.normal(size=50) for name in CHANNELS} | {"time": np.arange(50) / 200}
TRUTH = {name: RNG.normal(size=50) for name in ("true_Tb_fl", "true_mu_pad_r")}
LOG = Log("run", "here", "", VALUES, TRUTH)


@pytest.mark.parametrize("write", [write_csv, write_parquet])
def test_a_log_is_the_same_to_the_decimals_of_its_format(tmp_path, write):
    path = tmp_path / f"run.{write.__name__[6:]}"
    write(LOG, path)
    if path.suffix == ".csv":
        header = path.read_text().splitlines()[0]
        assert header.startswith("time [s],p_mc [bar],a_x [m/s^2],omega_fl [rad/s]")
        assert header.endswith("true_Tb_fl [N*m],true_mu_pad_r [1]")
    copy = read_log(path)
    assert list(copy.channels) == list(LOG.channels)
    for name, values in {**LOG.channels, **LOG.truth}.items():
        step = 0.1 if CHANNELS.get(name) and CHANNELS[name].unit == "bar" else 1e-6
        tolerance = 0.5001 * step if path.suffix == ".csv" else 1e-9
        values_read = {**copy.channels, **copy.truth}[name]
        np.testing.assert_allclose(values_read, values, rtol=1e-15, atol=tolerance)


UNITS = (None, "bar", "kPa", "m/s^2", "°", "N*m", "columns up", "1")
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
    columns = [WholeColumn("time", "s", time), WholeColumn("v", "m/s", time)]
    for name in names:
        values = draw(st.lists(NUMBERS, min_size=rows, max_size=rows))
        unit = draw(st.sampled_from(UNITS))
        columns.append(WholeColumn(f"x{name}", unit, np.array(values)))
    return WholeLog("run", "here", "", tuple(columns))


def write_log(log, path):
    path.write_bytes(WRITERS[path.suffix](log))


def bits(values):
    """The bits of numbers; every NaN is the same."""
    return np.where(np.isnan(values), np.nan, values).view(np.int64).tolist()


@pytest.mark.parametrize("ending", [".csv", ".parquet"])
@settings(max_examples=25)
@given(log=logs())
def test_a_table_is_read_back_to_the_last_bit(tmp_path_factory, ending, log):
    path = tmp_path_factory.mktemp("written") / f"run{ending}"
    write_log(log, path)
    copy = read_whole(path)
    header = [(c.name, c.unit) for c in log.columns]
    assert [(c.name, c.unit or None) for c in copy.columns] == header
    for ours, theirs in zip(log.columns, copy.columns, strict=True):
        assert bits(ours.values) == bits(theirs.values)


def test_every_format_is_the_same_log_in_si(tmp_path):
    channel_map = read_channel_map(write_map(tmp_path))
    source = write_mdf(tmp_path / "bench.mf4")
    reference, whole = read_log(source, channel_map), read_whole(source, channel_map)
    for ending in list(WRITERS):
        write_log(whole, tmp_path / f"out{ending}")
        copy = read_log(tmp_path / f"out{ending}")  # no map is needed any more
        assert list(copy.channels) == list(reference.channels)
        for name, values in reference.channels.items():
            np.testing.assert_array_equal(copy[name], values, err_msg=f"{ending} {name}")
