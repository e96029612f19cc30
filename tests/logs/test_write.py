"""Writing a log and reading it back."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from calib.logs.log import Log
from calib.logs.read import read_log
from calib.logs.write import DECIMALS, write_csv, write_parquet
from calib.names import CHANNELS

ROWS = 50


def make_log(seed=3, scale=1.0):
    rng = np.random.default_rng(seed)
    channels = {name: scale * rng.normal(size=ROWS) for name in CHANNELS}
    channels["time"] = np.arange(ROWS) / 200
    truth = {name: rng.normal(size=ROWS) for name in ("true_Tb_fl", "true_mu_pad_r")}
    return Log("run", "here", "", channels, truth)


LOG = make_log()


def test_csv_has_canonical_units_and_decimals(tmp_path):
    log = replace(LOG, channels={**LOG.channels, "p_mc": np.full(ROWS, 12.5e5)})
    write_csv(log, tmp_path / "run.csv")
    header, first = (tmp_path / "run.csv").read_text().splitlines()[:2]
    assert header.startswith("time [s],p_mc [bar],a_x [m/s^2],omega_fl [rad/s]")
    assert header.endswith("true_Tb_fl [N*m],true_mu_pad_r [1]")
    assert first.startswith("0.000000,12.5000,")


def test_csv_is_the_same_to_the_printed_decimals(tmp_path):
    write_csv(LOG, tmp_path / "run.csv")
    back = read_log(tmp_path / "run.csv")
    for name, values in {**LOG.channels, **LOG.truth}.items():
        step = 10.0 ** -DECIMALS.get(name.split("_")[0], 3)
        step *= 1e5 if CHANNELS.get(name) and CHANNELS[name].unit == "bar" else 1.0
        found = {**back.channels, **back.truth}[name]
        np.testing.assert_allclose(found, values, rtol=0, atol=0.5001 * step)


def test_csv_written_twice_does_not_change(tmp_path):
    write_csv(LOG, tmp_path / "a.csv")
    write_csv(read_log(tmp_path / "a.csv"), tmp_path / "b.csv")
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()


values = arrays(float, ROWS, elements=st.floats(-1e7, 1e7))


@given(pressure=values, speed=values, torque=values)
def test_parquet_is_the_same(tmp_path_factory, pressure, speed, torque):
    """Values that a car can have: others are marked when they are read."""
    pressure, speed = 2e7 + pressure, 3e-7 * speed
    channels = {**LOG.channels, "p_mc": pressure, "v": speed}
    log = replace(LOG, channels=channels, truth={"true_Tb_fl": torque})
    path = tmp_path_factory.getbasetemp() / "round.parquet"
    write_parquet(log, path)
    back = read_log(path)
    assert list(back.channels) == list(log.channels)
    np.testing.assert_allclose(back["p_mc"], pressure, rtol=1e-15, atol=1e-9)
    np.testing.assert_array_equal(back["v"], speed)
    np.testing.assert_array_equal(back.truth["true_Tb_fl"], torque)


@pytest.mark.parametrize("write", [write_csv, write_parquet])
@pytest.mark.parametrize(
    "log",
    [
        replace(LOG, channels={**LOG.channels, "v": np.full(ROWS, np.nan)}),
        replace(LOG, truth={"true_colour": np.zeros(ROWS)}),
    ],
    ids=["not finite", "truth without unit"],
)
def test_a_refused_log_leaves_no_file(tmp_path, write, log):
    with pytest.raises(ValueError, match=r"finite|true_colour"):
        write(log, tmp_path / "run.file")
    assert list(tmp_path.iterdir()) == []
