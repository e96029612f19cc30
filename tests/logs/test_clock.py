"""Clocks as recorders, loggers and spreadsheets write them: read rightly, or refused by name."""

import numpy as np
import pytest

from calib.base.errors import LogError
from calib.logs.clock import check_running, on_line, step_of
from calib.logs.read import read_log
from tests.support.made_runs import made_run, stop

RUN = made_run(stop(), rate=100.0)
UNITS = {"p_mc": ("bar", 1e-5), "a_x": ("m/s^2", 1.0), "v": ("m/s", 1.0)} | {
    f"omega_{w}": ("rad/s", 1.0) for w in ("fl", "fr", "rl", "rr")
}


def write(folder, times, head="time [s]", channels=UNITS):
    """The run as CSV with these cells of time."""
    rows = [",".join([head, *(f"{name} [{UNITS[name][0]}]" for name in channels)])]
    values = [RUN[name] * UNITS[name][1] for name in channels]
    rows += [f"{t}," + ",".join(f"{x:.5f}" for x in row) for t, *row in zip(times, *values)]  # noqa: B905
    path = folder / "run.csv"
    path.write_text("\n".join([*rows, ""]))
    return path


def test_rows_of_several_clocks_are_put_on_one(tmp_path):
    """Pressure, wheels and v in rows of their own; straight lines between 10 ms err by 1e-3."""
    cells, start = [], 1.7e9
    for i, t in enumerate(RUN.time):
        p, a, v = RUN["p_mc"][i] * 1e-5, RUN["a_x"][i], RUN["v"][i]
        cells.append((t, f"{p:.5f},{a:.5f},,,,,"))
        wheels = ",".join(f"{RUN[f'omega_{w}'][i]:.5f}" for w in ("fl", "fr", "rl", "rr"))
        cells.append((t + 0.0021, f",,{wheels},"))
        if i % 5 == 0:
            cells.append((t + 0.0007, f",,,,,,{v:.5f}"))
    names = ("p_mc", "a_x", "omega_fl", "omega_fr", "omega_rl", "omega_rr", "v")
    rows = ["time [s]," + ",".join(f"{n} [{UNITS[n][0]}]" for n in names)]
    rows += [f"{start + t:.6f},{row}" for t, row in sorted(cells)]
    path = tmp_path / "run.csv"
    path.write_text("\n".join([*rows, ""]))
    log = read_log(path)
    elapsed = log.time - start
    assert log.sample_time == pytest.approx(0.01, rel=1e-3)
    assert np.all(np.diff(log.time) > 0.005)
    later = np.interp(elapsed - 0.0021, RUN.time, RUN["omega_fl"])
    np.testing.assert_allclose(log["omega_fl"], later, atol=2e-3)
    np.testing.assert_allclose(log["p_mc"], np.interp(elapsed, RUN.time, RUN["p_mc"]), atol=2e3)


@pytest.mark.parametrize("unit", ["sec", "s", "ms"])
def test_a_number_with_its_unit_is_a_time(tmp_path, unit):
    scale = 1e3 if unit == "ms" else 1.0
    path = write(tmp_path, [f"{scale * t:.4g} {unit}" for t in RUN.time], head="time")
    np.testing.assert_allclose(read_log(path).time, RUN.time - RUN.time[0], atol=1e-6)


def test_days_of_a_spreadsheet_are_a_unit(tmp_path):
    path = write(tmp_path, [f"{45000.5 + t / 86400.0:.11f}" for t in RUN.time], head="time [d]")
    time = read_log(path).time
    np.testing.assert_allclose(time - time[0], RUN.time - RUN.time[0], atol=2e-6)


def test_a_header_may_have_line_breaks_in_quotes(tmp_path):
    path = write(tmp_path, [f"{t:.3f}" for t in RUN.time])
    header, rows = path.read_text().split("\n", 1)
    broken = ",".join('"' + cell.replace(" [", "\n[") + '"' for cell in header.split(","))
    path.write_text(f"{broken}\n{rows}")
    assert read_log(path).time.size == RUN.time.size


def four_digits(t):
    """Milliseconds with four digits: 0.05 s after a second is .0050."""
    return f"{int(t)}.{round(1e3 * (t % 1.0)):04d}"


HANDED_OUT = np.ceil(RUN.time / 0.016) * 0.016
BURSTS = HANDED_OUT + 1.2e-4 * np.append(0, np.diff(HANDED_OUT) == 0.0)

ROWS = np.concatenate([np.r_[:100], np.r_[120:140], np.r_[100:120], np.r_[140 : RUN.time.size]])
OUT_OF_ORDER = RUN.time[ROWS]


def hhmmss(t):
    """Time of day [s] packed into one number, as a VBO file has it."""
    return f"{t // 3600.0 * 10000.0 + t // 60.0 % 60.0 * 100.0 + t % 60.0:.3f}"


REFUSED = {
    "ms that are s": ([f"{t:.3f}" for t in RUN.time], "time [ms]", "in s, not ms"),
    "s that are ms": ([f"{1e3 * t:.0f}" for t in RUN.time], "time [s]", "in ms, not s"),
    "four digits": ([four_digits(t) for t in RUN.time + 1e-6], "time [s]", "digits"),
    "bursts": ([f"{t:.5f}" for t in BURSTS], "time [s]", "adapter"),
    "a clock that is set forward": (
        [f"{t + 3600.0 * (t > 3.0):.3f}" for t in RUN.time], "time [s]", "jumps by 3600.01 s",
    ),
    "hhmmss": ([hhmmss(35997.0 + t) for t in RUN.time], "time [s]", "hhmmss"),
    "a clock that is set back": (
        [f"{t + 3600.0 * (t < 3.0):.3f}" for t in RUN.time], "time [s]", "add 3600.000000 s",
    ),
    "a counter of 32 bits": (
        [f"{(4.294e9 + 1e6 * t) % 2**32:.0f}" for t in RUN.time], "time [us]", "add 4294.967296 s",
    ),
    "rows out of order": ([f"{t:.3f}" for t in OUT_OF_ORDER], "time [s]", "sort the rows"),
    "a time that falls": ([f"{1e5 - t:.3f}" for t in RUN.time], "time [s]", "sign"),
    "too few digits": ([f"{t:.1f}" for t in RUN.time], "time [s]", "more digits"),
    "a time that stands": (["0.000"] * RUN.time.size, "time [s]", "clock that runs"),
}  # fmt: skip


@pytest.mark.parametrize("kind", REFUSED)
def test_a_clock_that_cannot_be_is_named_before_anything_else(tmp_path, kind):
    cells, head, names = REFUSED[kind]
    with pytest.raises(LogError) as error:
        read_log(write(tmp_path, cells, head))
    assert names in str(error.value)
    assert str(error.value.where).endswith("time")


def test_an_optional_channel_of_an_unknown_unit_is_left_out(tmp_path):
    path = write(tmp_path, [f"{t:.3f}" for t in RUN.time])
    path.write_text(path.read_text().replace("v [m/s]", "v [furlong/h]"))
    log = read_log(path)
    assert "v" not in log
    assert any("furlong" in note for note in log.notes)


@pytest.mark.parametrize("rate", [95.0, 150.0, 256.0, 300.0, 700.0])
@pytest.mark.parametrize("lost", [(), (300,), range(600, 1000)])
@pytest.mark.parametrize("written", [np.round, np.floor], ids=["rounded", "cut"])
def test_whole_milliseconds_are_put_on_their_line(rate, lost, written):
    true = 3.0 + np.delete(np.arange(2000), lost) / rate
    line, (note,) = on_line(written(1e3 * true) / 1e3)
    assert "in steps of 1 ms" in note
    assert np.median(np.diff(line)) == pytest.approx(1.0 / rate, rel=2e-5)
    shift = line - true
    assert np.ptp(shift) < 2e-4  # how late the clock is as a whole moves nothing


@pytest.mark.parametrize("start", [3600.0, 30000.0, 32760.0])  # the last one: the spacing doubles
@pytest.mark.parametrize("rate", [50.0, 100.0, 120.0])
def test_float32_seconds_of_the_day(start, rate):
    true = start + np.arange(2000) / rate
    line, _ = on_line(true.astype(np.float32).astype(np.float64))
    assert step_of(line) == pytest.approx(1.0 / rate, rel=2e-4)
    assert np.ptp(line - true) < 1e-3


@pytest.mark.parametrize("jitter", [0.5e-3, 2e-3])
def test_a_clock_that_jitters_stays_as_it_is(jitter):
    rng = np.random.default_rng(3)
    time = np.arange(2000) / 100 + rng.uniform(-jitter, jitter, 2000)
    assert on_line(time)[0] is time
    assert step_of(time) == pytest.approx(0.01, rel=3e-4)


def test_a_clock_that_changes_its_rate_stays_as_it_is():
    true = np.cumsum(np.where(np.arange(2000) < 1000, 1 / 150, 1 / 155))
    assert not on_line(np.round(true, 3))[1]


def test_a_gap_is_no_part_of_the_step():
    time = np.arange(500) / 200
    time[300:] += 2.0
    assert step_of(time) == pytest.approx(0.005)


def test_frames_out_of_order_stay_as_they_are():
    time = np.asarray([0.0, 0.010, 0.009, 0.02, 0.03, 0.04, 0.05, 0.06])
    check_running(time, "run")


@pytest.mark.parametrize(
    "time",
    [
        np.tile(np.arange(500.0), 2),
        np.tile([0.01, 0.002], 50),
        np.asarray([0.0, np.nan, 1.0]),
        np.asarray([0.0, 1.5e308, -1.5e308]),
    ],
    ids=["two runs", "to and fro", "no number", "bytes that are no times"],
)
def test_what_is_no_clock(time):
    with pytest.raises(LogError):
        check_running(time, "run")
