"""The ripple of averaged samples, and disc temperatures, against closed forms."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.car.history import constant_speed, disc_temperature


@given(st.integers(1, 5), st.floats(0.0, 2.5), st.floats(-3.0, 3.0))
def test_a_ripple_is_the_mean_of_its_samples(m, turn, phase):
    """The wheel turns by ``turn`` [rad] in m samples, whose mean is computed here."""
    angle = turn / m * np.arange(60 * m)
    means = np.sin(angle + phase).reshape(60, m).mean(axis=1)
    time = np.arange(60.0)
    mean = angle.reshape(60, m).mean(axis=1)
    history = replace(constant_speed(time, np.zeros(60), 20.0), angle_f=mean, averaged=m)
    assert history.ripple(phase) == pytest.approx(means, abs=1e-9)


C, TAU = 4000.0, 300.0
TIME = np.linspace(2.0, 32.0, 301)
ELAPSED = TIME - TIME[0]


@pytest.mark.parametrize("start", [20.0, 400.0])
@pytest.mark.parametrize("power", [0.0, 20e3])
def test_constant_power_gives_the_exponential(start, power):
    """T = T_e + (T_0 - T_e) exp(-t/tau), T_e = T_air + P tau/C."""
    end = 20.0 + power * TAU / C
    expected = end + (start - end) * np.exp(-ELAPSED / TAU)
    temperature = disc_temperature(TIME, power * ELAPSED, C, start)
    assert temperature == pytest.approx(expected, rel=1e-10)
