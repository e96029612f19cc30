"""Pressure traces: their corners, their clock, and what cannot be driven."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.base.errors import ModelError
from calib.model.manoeuvre import (
    LEAD_IN,
    NAMES,
    RISE,
    coast,
    manoeuvre,
    ramp,
    staircase,
    step,
    stop,
    wave,
)


@given(st.sampled_from(NAMES), st.floats(40.0, 1000.0), st.floats(5e5, 120e5))
def test_every_trace_is_an_even_clock_and_a_pressure_that_can_be_built(name, rate, pressure):
    m = manoeuvre(name, 25.0, None if name == "coast" else pressure, rate)
    assert m.name == name
    assert m.time[0] == 0.0
    assert np.diff(m.time) == pytest.approx(1.0 / rate, rel=1e-6)
    assert m.time.shape == m.pressure.shape
    assert np.all(m.pressure >= 0.0)
    assert np.all(np.abs(np.diff(m.pressure)) <= RISE / rate * (1.0 + 1e-6))
    if name != "coast":
        assert np.all(m.pressure[m.time <= LEAD_IN - 1.0 / rate] == 0.0)


def test_ramp_rises_by_its_slope_and_holds():
    m = ramp(33.0, 60e5, 200.0)
    assert np.interp([1.5, 2.5, 7.5, 13.5, 14.5], m.time, m.pressure) == pytest.approx(
        [0.0, 5e5, 30e5, 60e5, 60e5]
    )
    assert m.time[-1] == pytest.approx(14.5)


def test_step_is_up_at_once_and_stays():
    m = step(25.0, 40e5, hold=3.0)
    assert np.all(m.pressure[m.time > LEAD_IN + 0.1 + 1e-9] == 40e5)


def test_stop_rises_as_a_foot_does_and_coast_has_no_pressure():
    m = stop(25.0, 40e5)
    assert np.interp([1.5, 1.75, 2.0, 30.0], m.time, m.pressure) == pytest.approx(
        [0.0, 20e5, 40e5, 40e5]
    )
    assert np.all(coast(25.0).pressure == 0.0)


@pytest.mark.parametrize(
    ("name", "end"),
    [("ramp", 1.5 + 4.0 + 1.0), ("coast", 4.0), ("step", 1.5 + 0.075 + 4.0),
     ("stop", 1.5 + 0.375 + 4.0), ("staircase", 1.5 + 0.075 + 4.0)],
)  # fmt: skip
def test_a_duration_is_that_of_the_braking(name, end):
    m = manoeuvre(name, 25.0, None if name == "coast" else 30e5, duration=4.0)
    assert m.time[-1] == pytest.approx(end, abs=0.006)


def test_wave_has_its_mean_amplitude_and_frequency():
    m = wave(25.0, 20e5, amplitude=0.3, frequency=0.5, duration=20.0)
    late = m.pressure[m.time >= LEAD_IN + 20e5 / RISE]
    assert np.mean(late) == pytest.approx(20e5, rel=1e-3)
    assert np.ptp(late) == pytest.approx(2.0 * 0.3 * 20e5, rel=1e-3)
    upward = np.sum((late[1:] > 20e5 * (1 + 1e-9)) & (late[:-1] <= 20e5 * (1 + 1e-9)))
    assert upward == 10


def test_staircase_has_equal_steps():
    m = staircase(25.0, 40e5, steps=4, hold=2.0)
    levels, counts = np.unique(np.round(m.pressure), return_counts=True)
    assert list(levels[counts > 100]) == [0.0, 10e5, 20e5, 30e5, 40e5]


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("rmap", 25.0), "unknown manoeuvre"),
        (("coast", 25.0, 30e5), "takes no pressure"),
        (("ramp", 25.0, -1.0), "pressure"),
        (("ramp", 25.0, np.nan), "pressure"),
        (("ramp", 0.0), "first speed"),
        (("ramp", 25.0, None, 10.0), "40 to 1000 Hz"),
        (("coast", 25.0, None, 2000.0), "40 to 1000 Hz"),
        (("stop", 25.0, None, 200.0, 0.0), "duration 0 s"),
        (("stop", 25.0, None, 200.0, 1e9), "up to 600 s"),
    ],
)
def test_refuses_what_cannot_be_driven(arguments, says):
    with pytest.raises(ModelError, match=says):
        manoeuvre(*arguments)


def test_refuses_a_wave_below_nought():
    with pytest.raises(ModelError, match="amplitude"):
        wave(25.0, amplitude=1.0)
