"""The disc against the closed forms of its equation, and against the heat that went into it."""

import numpy as np
import pytest

from calib.car.disc_temperature import Disc, disc_temperature

DISC = Disc(heat_capacity=4000.0, cooling_time=60.0)
TIME = np.linspace(2.0, 32.0, 301)
SINCE = TIME - TIME[0]


@pytest.mark.parametrize("start", [20.0, 400.0])
@pytest.mark.parametrize("power", [0.0, 20e3])
def test_constant_power_gives_the_exponential(start, power):
    """T = T_e + (T_0 - T_e) exp(-t/tau), T_e = T_air + P tau/C."""
    end = 25.0 + power * 60.0 / 4000.0
    expected = end + (start - end) * np.exp(-SINCE / 60.0)
    found = disc_temperature(TIME, np.full_like(TIME, power), DISC, start, 25.0)
    assert found == pytest.approx(expected, rel=1e-10)


def test_a_stop_at_constant_deceleration():
    """P = P_0 (1 - t/t_s): T - T_air = g (1 - t/t_s + tau/t_s) + c exp(-t/tau), g = P_0 tau/C."""
    peak, stop, tau = 40e3, 30.0, 60.0
    g = peak * tau / 4000.0
    settled = g * (1.0 - SINCE / stop + tau / stop)
    expected = 20.0 + settled + (80.0 - settled[0]) * np.exp(-SINCE / tau)
    found = disc_temperature(TIME, peak * (1.0 - SINCE / stop), DISC, 100.0, 20.0)
    assert found == pytest.approx(expected, rel=1e-10)
