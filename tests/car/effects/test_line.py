"""The line against the solutions of its equations, at any clock."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.effect_runs import made_history, pressures

SWING = {"response_time": 0.08, "line_damping": 0.4}


@given(st.floats(-0.05, 0.5))
def test_a_straight_pressure_is_delayed_exactly(delay):
    history = made_history(p_mc=3e5 + 8e5 * np.arange(200) * 0.01)
    for found in pressures("hydraulic_delay", history, delay=delay):
        assert found == pytest.approx(np.clip(history.p_mc - 8e5 * delay, 3e5, history.p_mc[-1]))


@pytest.mark.parametrize("lag", [1e-9, 0.003, 0.4])
def test_a_lag_sample_by_sample_on_an_uneven_clock(lag):
    """Each step from the closed solution for a straight piece of input."""
    rng = np.random.default_rng(3)
    time = np.cumsum(rng.uniform(0.002, 0.05, 200))
    p = 10e5 + 5e5 * rng.standard_normal(200)
    history = made_history(200, time=time, p_mc=p)
    front, rear = pressures("hydraulic_lag", history, time_constant=lag)
    y = [p[0]]
    for dt, a, b in zip(np.diff(time), p[:-1], p[1:], strict=True):
        rate = (b - a) / dt
        y.append(b - rate * lag + (y[-1] - a + rate * lag) * np.exp(-dt / lag))
    assert front == pytest.approx(np.array(y), rel=1e-9)
    assert np.array_equal(front, rear)


@pytest.mark.parametrize(
    ("name", "strength", "others"),
    [
        ("hydraulic_lag", "time_constant", {}),
        ("hydraulic_oscillation", "response_time", {"line_damping": 0.4}),
    ],
)
def test_it_goes_over_into_nothing(name, strength, others):
    history = made_history()
    none, _ = pressures(name, history, **{strength: 0.0}, **others)
    short, _ = pressures(name, history, **{strength: 1e-6}, **others)
    assert none is history.p_mc
    assert short == pytest.approx(none, abs=1e-5 * 40e5)


@given(st.floats(0.0, 1.0), st.floats(0.0, 150e5), st.floats(0.0, 200e5))
def test_the_valve_has_a_knee_on_the_rear_alone(slope, knee, p):
    history = made_history(2, p_mc=np.array([0.0, p]))
    front, rear = pressures("rear_proportioning", history, knee_slope=slope, knee=knee)
    assert front is history.p_mc
    assert rear == pytest.approx([0.0, p if p < knee else knee + slope * (p - knee)], abs=1e-6)
