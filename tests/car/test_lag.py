"""Linear responses against closed forms and against another program's solver."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import lsim

from calib.car.lag import low_pass, second_order

TIME = np.arange(500) * 0.01


def bumpy(seed=0):
    return np.cumsum(np.random.default_rng(seed).standard_normal(TIME.size))


@given(st.floats(0.5, 60.0), st.floats(0.0, 0.95))
def test_second_order_is_what_lsim_finds(frequency, damping):
    x = bumpy(1)
    system = ([frequency**2], [1.0, 2.0 * damping * frequency, frequency**2])
    _, y, _ = lsim(system, x - x[0], TIME)
    assert second_order(TIME, x, frequency, damping) == pytest.approx(y + x[0], abs=1e-6)


@given(st.floats(0.005, 1.0), st.floats(0.0, 0.6))
def test_low_pass_is_what_lsim_finds(lag, bend):
    x = bumpy(3)
    system = ([1.0], [bend * lag**2, lag, 1.0] if bend > 1e-6 else [lag, 1.0])
    _, y, _ = lsim(system, x - x[0], TIME)
    assert low_pass(TIME, x, lag, bend * lag**2) == pytest.approx(y + x[0], abs=2e-5 * np.ptp(x))
