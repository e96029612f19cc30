"""Clocks that are known, and pressures that go with the deceleration or do not."""

import numpy as np
import pytest

from calib.line.fleet.rows import Command, columns_of
from calib.logs.channel_map import ChannelMap, Mapping
from calib.logs.read import read_log
from calib.logs.write import write_csv
from calib.plausibility.check import check
from calib.run.driving_record import sampling_of
from calib.run.run import Run, figures
from tests.support.made_runs import changed, made_run, ramp, stop
from tests.support.refusals import why_not

RUN = made_run(stop())


def test_rate_jitter_and_gaps_of_a_clock():
    even = sampling_of(np.arange(500) / 100.0)
    assert (even.rate, even.duration) == (pytest.approx(100.0), pytest.approx(4.99))
    assert (even.jitter, even.gaps) == (pytest.approx(0.0, abs=1e-12), ())
    steps = np.tile([0.004, 0.005, 0.006], 200)
    uneven = sampling_of(np.concatenate([[0.0], np.cumsum(steps)]))
    assert uneven.jitter == pytest.approx(0.001 * np.sqrt(2 / 3))
    time = np.arange(500) / 200
    assert sampling_of(np.delete(time, 300)).gaps == ()  # one lost sample
    time[300:] += 0.05
    clock = sampling_of(time)
    assert clock.jitter == pytest.approx(0.0, abs=1e-12)
    assert clock.gaps == ((pytest.approx(299 / 200), pytest.approx(0.055)),)


def test_the_figures_are_the_columns_of_a_batch():
    columns = [c.name for c in columns_of(Command.CHECK) if c.kind is float]
    assert list(figures(check(RUN).run)) == columns


def share(log):
    return Run(log).pressures["p_mc"].explained_in_time


@pytest.mark.parametrize("pressure", [ramp(), stop(), stop(level=8.0), stop(end=4.0)])
def test_the_pressure_of_the_run_explains_its_deceleration(pressure):
    assert share(made_run(pressure)) > 0.98


def test_pads_that_lose_a_third_and_lines_that_lag_are_no_mistake():
    t, p = RUN.time, RUN["p_mc"]
    faded = RUN["a_x"] * (1.0 - 0.33 * t / t[-1])
    assert share(changed(RUN, a_x=np.interp(t - 0.25, t, faded))) > 0.95
    assert share(changed(RUN, p_mc=np.maximum(p - 2e5, 0.0))) > 0.95
    glitch = RUN["a_x"].copy()
    glitch[700:703] = -80.0
    assert share(changed(RUN, a_x=glitch)) > 0.98


@pytest.mark.parametrize(
    "pressure",
    [lambda t: 0.0 * t, stop(start=4.0), lambda t: 25.0 * ((t > 1.5) & (np.sin(3.0 * t) > 0.0))],
    ids=["none", "later", "on and off"],
)
def test_the_pressure_of_another_run_does_not_explain_it(pressure):
    wrong = changed(RUN, p_mc=made_run(pressure)["p_mc"])
    assert share(wrong) < 0.85
    for purpose in ("fit", "validate", "diagnose"):
        assert set(why_not(wrong, purpose)) & {"pressure_late", "pressure_foreign"}


def test_a_late_pressure_is_refused_until_the_channel_map_puts_it_in_time(tmp_path):
    path, late = tmp_path / "late.csv", made_run(ramp(rate=12.0))
    write_csv(changed(late, p_mc=np.interp(late.time - 1.5, late.time, late["p_mc"])), path)
    for purpose in ("fit", "validate", "diagnose"):
        assert why_not(read_log(path), purpose)
    mapped = ChannelMap("map", {"p_mc": Mapping("p_mc", delay=1.5)})
    moved = read_log(path, mapped)
    assert why_not(moved, "fit") == []
    assert moved.time[-1] == pytest.approx(late.time[-1] - 1.5)  # after it the pressure is unknown
    assert moved["p_mc"] == pytest.approx(late["p_mc"][: moved.time.size], abs=1e3)
