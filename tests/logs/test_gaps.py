"""Short gaps are bridged where a channel is smooth, in every format; all others stay open."""

import numpy as np
import pandas as pd
import pytest

from calib.base.errors import LogError
from calib.logs.gaps import BRIDGE, fill, in_words
from calib.logs.read import read_log
from calib.logs.write import write_csv
from calib.run.check import check, to_dict
from tests.support.recordings import CHANNELS, UNITS, ramp, times, written

TIME = np.arange(0.0, 10.0, 0.02)
NOISE = np.random.default_rng(5).normal(size=TIME.size)
TOLERANCE = 1e-9


def lost(x, start, length, at=TIME):
    """``x`` of `TIME` without the samples after ``start`` [s] for ``length``, back on ``at``."""
    kept = (start + TOLERANCE >= TIME) | (start + length - TOLERANCE <= TIME)
    return fill("v", TIME[kept], x[kept], at)


@pytest.mark.parametrize("length", [0.08, 0.1, 0.2])
def test_a_smooth_channel_is_bridged_and_told(length):
    """A car that slows with 3 m/s^2: a straight line is exact."""
    speed = 30.0 - 3.0 * TIME
    filled = lost(speed, 5.0, length)
    np.testing.assert_allclose(filled.values, speed, atol=1e-9)
    (gap,) = filled.bridged
    assert (gap.channel, gap.start, gap.length) == ("v", pytest.approx(5.0), pytest.approx(length))
    assert in_words(filled) == (
        f"v: 1 gap was bridged with a straight line, the longest of {length:.3f} s at 5.000 s",
    )


def test_a_gap_beyond_the_bound_stays_open_with_its_place():
    filled = lost(30.0 - 3.0 * TIME, 5.0, BRIDGE + 0.02)
    inside = (TIME > 5.0 + TOLERANCE) & (TIME < 5.2 + 0.02 - TOLERANCE)
    np.testing.assert_array_equal(np.isnan(filled.values), inside)
    assert not filled.bridged
    assert "the first of 0.220 s at 5.000 s: only up to 0.2 s" in in_words(filled)[0]


@pytest.mark.parametrize(
    "x",
    [
        np.where(TIME < 5.05, 0.0, 50.0),  # a brake that is applied within the gap
        np.interp(TIME, [0.0, 5.02, 5.3, 10.0], [0.0, 0.0, 60.0, 60.0]),
        np.interp(TIME, [0.0, 4.95, 5.05, 5.15, 10.0], [0.0, 0.0, 60.0, 0.0, 0.0]),  # and released
    ],
)
def test_a_step_within_the_gap_is_not_bridged(x):
    filled = lost(x + 0.05 * NOISE, 5.0, 0.1)
    assert np.isnan(filled.values).any()
    assert len(filled.left_open) == 1


def test_noise_alone_is_no_step():
    """Of 100 noisy channels at a standstill nearly all are bridged: 3 sigma on either side."""
    rng = np.random.default_rng(8)
    count = sum(
        bool(lost(rng.normal(size=TIME.size), start, 0.1).bridged)
        for start in rng.choice(TIME[20:-20], 100)
    )
    assert count >= 97


def test_samples_at_one_time_show_no_slope():
    """Times of a damaged file, so near that the square of their distance is zero."""
    t = np.concatenate([np.arange(8) * 1e-300, 0.125 + 0.005 * np.arange(60)])
    x = np.arange(68.0)
    filled = fill("v", t, x, np.arange(0.0, 0.3, 0.005))
    assert not filled.bridged
    assert filled.left_open


def test_too_few_samples_beside_a_gap_show_nothing():
    filled = lost(30.0 - 3.0 * TIME, 0.04, 0.1)  # two samples before it
    assert len(filled.left_open) == 1


def without(values, time, start, length):
    gone = (time > start + TOLERANCE) & (time < start + length - TOLERANCE)
    return np.where(gone, np.nan, values)


def write_with_gap(folder, kind, channel, start, length):
    """The known ramp with a gap of one channel, in one of the formats, and its map."""
    log = ramp()
    if kind in (".csv", ".parquet"):
        path = folder / f"run{kind}"
        write_csv(log, path.with_suffix(".csv"))
        frame = pd.read_csv(path.with_suffix(".csv"))
        column = next(name for name in frame.columns if name.startswith(f"{channel} "))
        frame[column] = without(frame[column], log.time, start, length)
        frame.to_csv(path.with_suffix(".csv"), index=False)
        if kind == ".parquet":
            frame.to_parquet(path)
        return path, None
    from asammdf import MDF, Signal

    from tests.support.recordings import write_map

    at, values, path = times(), written(), folder / "run.mf4"
    with MDF(version="4.10") as mdf:
        for ours, theirs in CHANNELS.items():
            t = at[theirs]
            kept = ~np.isnan(without(t, t, start, length)) if ours == channel else t >= 0
            mdf.append([Signal(values[theirs][kept], t[kept], name=theirs, unit=UNITS[theirs])],
                       acq_name=theirs)  # fmt: skip
        mdf.save(path, overwrite=True)
    return path, write_map(folder)


@pytest.mark.parametrize("kind", [".csv", ".parquet", ".mf4"])
@pytest.mark.parametrize("channel", ["v", "p_mc"])
def test_every_format_alike(tmp_path, kind, channel):
    log = read_log(*write_with_gap(tmp_path, kind, channel, 3.0, 0.1))
    (gap,) = log.bridged
    assert (gap.channel, gap.length) == (channel, pytest.approx(0.1, abs=0.011))
    assert any(f"{channel}: 1 gap was bridged with a straight line" in n for n in log.notes)
    known = np.interp(log.time, ramp().time, ramp()[channel])
    assert np.abs(log[channel] - known).max() < 0.03 * np.ptp(known)
    assert to_dict(check(log))["bridged"][0]["channel"] == channel


@pytest.mark.parametrize("kind", [".csv", ".parquet", ".mf4"])
def test_a_long_gap_of_a_required_channel_is_refused_with_its_place(tmp_path, kind):
    with pytest.raises(LogError, match=r"p_mc: no value in .* at 3\.0\d\d s"):
        read_log(*write_with_gap(tmp_path, kind, "p_mc", 3.0, 0.5))
