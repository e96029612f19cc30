"""Short gaps are bridged where a channel is smooth, in every format; all others stay open."""

import numpy as np
import pandas as pd
import pytest

from calib.base.errors import LogError
from calib.logs.gaps import BRIDGE, fill, in_words
from calib.logs.read import read_log
from calib.logs.write import write_csv
from calib.plausibility.check import check, to_dict
from tests.support.recordings import CHANNELS, UNITS, ramp, times, write_map, written

TIME = np.arange(0.0, 10.0, 0.02)
NOISE = np.random.default_rng(5).normal(size=TIME.size)
TOLERANCE = 1e-9


def fill_gap(x, start, length, times=TIME):
    """Samples ``x`` at `TIME` with a gap from ``start`` [s] for ``length``, filled at ``times``."""
    is_present = (start + TOLERANCE >= TIME) | (start + length - TOLERANCE <= TIME)
    return fill("v", TIME[is_present], x[is_present], times)


@pytest.mark.parametrize("length", [0.08, 0.1, 0.2])
def test_a_smooth_channel_is_bridged_and_told(length):
    """A car that slows with 3 m/s^2: a straight line is exact."""
    speed = 30.0 - 3.0 * TIME
    filled = fill_gap(speed, 5.0, length)
    np.testing.assert_allclose(filled.values, speed, atol=1e-9)
    (gap,) = filled.bridged
    assert (gap.channel, gap.start, gap.length) == ("v", pytest.approx(5.0), pytest.approx(length))
    assert f"{length:.3f} s at 5.000 s" in in_words(filled)[0]


def test_a_gap_beyond_the_bound_stays_open_with_its_place():
    filled = fill_gap(30.0 - 3.0 * TIME, 5.0, BRIDGE + 0.02)
    inside = (TIME > 5.0 + TOLERANCE) & (TIME < 5.2 + 0.02 - TOLERANCE)
    np.testing.assert_array_equal(np.isnan(filled.values), inside)
    assert not filled.bridged
    assert "0.220 s at 5.000 s" in in_words(filled)[0]


@pytest.mark.parametrize(
    "x",
    [
        np.where(TIME < 5.05, 0.0, 50.0),  # a brake that is applied within the gap
        np.interp(TIME, [0.0, 5.02, 5.3, 10.0], [0.0, 0.0, 60.0, 60.0]),
        np.interp(TIME, [0.0, 4.95, 5.05, 5.15, 10.0], [0.0, 0.0, 60.0, 0.0, 0.0]),  # and released
    ],
)
def test_a_step_within_the_gap_is_not_bridged(x):
    filled = fill_gap(x + 0.05 * NOISE, 5.0, 0.1)
    assert np.isnan(filled.values).any()
    assert len(filled.left_open) == 1


def test_noise_alone_is_no_step():
    """Of 100 noisy channels at a standstill nearly all are bridged: 3 sigma on either side."""
    rng = np.random.default_rng(8)
    count = sum(
        bool(fill_gap(rng.normal(size=TIME.size), start, 0.1).bridged)
        for start in rng.choice(TIME[20:-20], 100)
    )
    assert count >= 97


def test_too_few_samples_beside_a_gap_show_nothing():
    """Two before it; or at times of a damaged file, where the square of a distance is zero."""
    t = np.concatenate([np.arange(8) * 1e-300, 0.125 + 0.005 * np.arange(60)])
    same_time = fill("v", t, np.arange(68.0), np.arange(0.0, 0.3, 0.005))
    for filled in (fill_gap(30.0 - 3.0 * TIME, 0.04, 0.1), same_time):
        assert not filled.bridged
        assert filled.left_open


def write_with_gap(folder, kind, channel, start, length):
    """The known ramp with a gap of one channel, in one of the formats, and its map."""

    def is_lost(time):
        return (time > start + TOLERANCE) & (time < start + length - TOLERANCE)

    path = folder / f"run{kind}"
    if kind != ".mf4":
        table = folder / "run.csv"
        write_csv(ramp(), table)
        frame = pd.read_csv(table)
        column = next(name for name in frame.columns if name.startswith(f"{channel} "))
        frame.loc[is_lost(ramp().time), column] = np.nan
        frame.to_csv(table, index=False) if kind == ".csv" else frame.to_parquet(path)
        return path, None
    from asammdf import MDF, Signal

    with MDF(version="4.10") as mdf:
        for ours, name in CHANNELS.items():
            t, values = times()[name], written()[name]
            is_present = ~is_lost(t) if ours == channel else t >= 0
            mdf.append([Signal(values[is_present], t[is_present], name=name, unit=UNITS[name])],
                       acq_name=name)  # fmt: skip
        mdf.save(path, overwrite=True)
    return path, write_map(folder)


@pytest.mark.parametrize("kind", [".csv", ".parquet", ".mf4"])
def test_every_format_alike(tmp_path, kind):
    """A short gap of a channel is bridged and told; a long one is refused with its place."""
    log = read_log(*write_with_gap(tmp_path, kind, "p_mc", 3.0, 0.1))
    (gap,) = log.bridged
    assert (gap.channel, gap.length) == ("p_mc", pytest.approx(0.1, abs=0.011))
    expected = np.interp(log.time, ramp().time, ramp()["p_mc"])
    assert np.abs(log["p_mc"] - expected).max() < 0.03 * np.ptp(expected)
    assert to_dict(check(log))["bridged"][0]["channel"] == "p_mc"
    with pytest.raises(LogError, match=r"3\.0\d\d s"):
        read_log(*write_with_gap(tmp_path, kind, "p_mc", 3.0, 0.5))
