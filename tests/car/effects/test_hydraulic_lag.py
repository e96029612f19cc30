"""Lag against the solutions of its equation, at any clock."""

import numpy as np
import pytest

from tests.support.effect_runs import SEDAN, apart, driven, made_history, on_the_plant, pressures

GAIN = SEDAN.front.pad_friction * SEDAN.front.torque_gain


def test_a_ramp_is_behind_by_the_time_constant():
    log = driven({"hydraulic_lag": {"time_constant": 0.15}}, lambda t: 6e5 * t)
    behind = log["p_mc"] - log.truth["true_Tb_fl"] / GAIN
    assert behind == pytest.approx(6e5 * 0.15 * (1.0 - np.exp(-log.time / 0.15)), abs=1.0)


def test_a_step_is_two_thirds_there_after_one_time_constant():
    history = made_history(400, p_mc=np.where(np.arange(400) >= 100, 20e5, 0.0))
    front, rear = pressures("hydraulic_lag", history, time_constant=0.2)
    assert front[120] == pytest.approx(20e5 * (1.0 - np.exp(-1.0)), rel=0.02)
    assert np.array_equal(front, rear)
    assert np.all(front[:100] == 0.0)


@pytest.mark.parametrize("lag", [1e-9, 0.003, 0.4])
def test_sample_by_sample_on_an_uneven_clock(lag):
    """Each step from the closed solution for a straight piece of input."""
    rng = np.random.default_rng(3)
    time = np.cumsum(rng.uniform(0.002, 0.05, 200))
    p = 10e5 + 5e5 * rng.standard_normal(200)
    front, _ = pressures("hydraulic_lag", made_history(200, time=time, p_mc=p), time_constant=lag)
    y = [p[0]]
    for dt, a, b in zip(np.diff(time), p[:-1], p[1:], strict=True):
        rate = (b - a) / dt
        y.append(b - rate * lag + (y[-1] - a + rate * lag) * np.exp(-dt / lag))
    assert front == pytest.approx(np.array(y), rel=1e-9)


def test_goes_over_into_nothing():
    history = made_history()
    none = pressures("hydraulic_lag", history, time_constant=0.0)[0]
    short = pressures("hydraulic_lag", history, time_constant=1e-6)[0]
    assert none is history.p_mc
    assert short == pytest.approx(none, abs=1e-6 * 40e5)


def test_follows_the_plant_under_the_lagging_pressure():
    def lagging(t):
        return 6e5 * (t - 0.15 * (1.0 - np.exp(-t / 0.15)))

    log = driven({"hydraulic_lag": {"time_constant": 0.15}}, lambda t: 6e5 * t)
    run = on_the_plant(lagging)
    assert apart(log, run, "v") < 2e-3
    assert apart(driven({}, lambda t: 6e5 * t), run, "v") > 0.2
