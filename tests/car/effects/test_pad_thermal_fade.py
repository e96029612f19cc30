"""Fade against its line, and the simulation against a plant told the same friction."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.effect_runs import (
    SEDAN,
    apart,
    clock,
    driven,
    factors,
    made_history,
    on_the_plant,
)

FADE = {"fade_slope": 0.001, "fade_onset": 150.0}


def test_by_hand():
    history = made_history(4, temperature_f=np.array([20.0, 150.0, 250.0, 650.0]))
    front, rear = factors("pad_thermal_fade", history, **FADE)
    assert front == pytest.approx([1.0, 1.0, 0.9, 0.5])
    assert np.array_equal(rear, np.ones(4))


@given(st.floats(0.0, 0.005), st.floats(0.0, 500.0), st.floats(-20.0, 800.0))
def test_sample_by_sample(slope, onset, temperature):
    history = made_history(3, temperature_r=np.array([0.0, temperature, 0.0]))
    _, rear = factors("pad_thermal_fade", history, fade_slope=slope, fade_onset=onset)
    lost = slope * (temperature - onset) if temperature > onset else 0.0
    assert rear[1] == pytest.approx(1.0 - lost)


@pytest.mark.parametrize(("axle", "capacity"), [("f", 3700.0), ("r", 2300.0)])
def test_without_a_log_the_disc_is_heated_by_its_brake(axle, capacity):
    """Constant power: T = T_e + (100 - T_e) exp(-t/tau), T_e = 20 + P tau/C."""
    time, power = np.linspace(3.0, 43.0, 401), 12e3
    heat = {f"energy_{axle}": power * (time - 3.0), f"temperature_{axle}": None}
    history = replace(made_history(401, time=time), **heat)
    end = 20.0 + power * 300.0 / capacity
    T = end + (100.0 - end) * np.exp(-(time - 3.0) / 300.0)
    found = factors("pad_thermal_fade", history, **FADE)["fr".index(axle)]
    assert T[-1] > 150.0
    assert found == pytest.approx(1.0 - 0.001 * np.maximum(T - 150.0, 0.0), rel=1e-9)


def test_the_simulation_heats_its_own_discs_where_none_is_given():
    """Heat from the truth channels of the run itself, summed here step by step."""
    hot = {"fade_slope": 0.004, "fade_onset": 101.0}
    log = driven({"pad_thermal_fade": hot}, lambda t: 40e5, duration=3.0)
    power = log.truth["true_Tb_fl"] * log["omega_fl"]
    T, dt = [100.0], 0.005
    for a, b in pairwise(power):
        T.append(T[-1] + dt * (0.5 * (a + b) / 3700.0 - (T[-1] - 20.0) / 300.0))
    expected = SEDAN.front.pad_friction * (1.0 - 0.004 * np.maximum(np.array(T) - 101.0, 0.0))
    assert log.truth["true_mu_pad_f"] == pytest.approx(expected, abs=2e-5)
    assert expected[-1] < 0.97 * expected[0]


def test_follows_the_plant_with_hot_front_discs():
    def pads(t):
        return 0.38 * (1.0 - 0.001 * 40.0 * max(t - 1.0, 0.0)), SEDAN.rear.pad_friction

    heat = {"f": 110.0 + 40.0 * clock(4.0), "r": np.full(801, 60.0)}
    log = driven({"pad_thermal_fade": FADE}, temperature=heat)
    run = on_the_plant(pads=pads)
    assert apart(log, run, "true_Tb_fl") < 1e-6
    assert apart(log, run, "true_mu_pad_f") < 1e-12
    assert apart(log, run, "v") < 2e-3
    assert np.array_equal(log["T_disc_f"], heat["f"][: log.time.size])
    assert apart(driven({}), run, "v") > 0.2


def test_discs_that_begin_unlike_cool_and_fade_each_by_itself():
    """Front at 400 and rear at 200 degC, without braking: over the air, e^(-t/300 s) of it."""
    time = np.array([0.0, 150.0, 300.0])
    unlogged = {"temperature_f": None, "temperature_r": None, "start_heat": (400.0, 200.0)}
    history = made_history(3, time=time, energy_f=0.0 * time, energy_r=0.0 * time, **unlogged)
    front, rear = factors("pad_thermal_fade", history, **FADE)
    left = np.exp(-time / 300.0)
    assert front == pytest.approx(1.0 - 0.001 * np.maximum(20.0 + 380.0 * left - 150.0, 0.0))
    assert rear == pytest.approx(1.0 - 0.001 * np.maximum(20.0 + 180.0 * left - 150.0, 0.0))
