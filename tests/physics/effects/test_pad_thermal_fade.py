"""Fade against its line, and the simulation against a plant told the same friction."""

from dataclasses import replace

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


def test_nothing_is_known_without_a_temperature():
    history = replace(made_history(), temperature_f=None, temperature_r=None)
    for factor in factors("pad_thermal_fade", history, **FADE):
        assert np.array_equal(factor, np.ones(200))


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
