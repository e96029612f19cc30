"""Speed dependence against a deceleration in closed form."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.effect_runs import SEDAN, driven, factors, made_history, without_inertia


@given(st.floats(-0.02, 0.02), st.floats(0.0, 60.0))
def test_a_line_through_one_at_20_m_s_on_both_axles(slope, v):
    history = made_history(2, v=np.array([20.0, v]))
    for factor in factors("pad_speed_dependence", history, speed_slope=slope):
        assert factor == pytest.approx([1.0, 1.0 + slope * (v - 20.0)])


@pytest.mark.parametrize("slope", [-0.01, 0.01])
def test_speed_falls_as_an_exponential(slope):
    """dv/dt = -a (1 + k (v - 20)) from 30 m/s; a from the run without the effect."""
    car = without_inertia(SEDAN)
    a = -driven({}, car=car)["a_x"][0]
    log = driven({"pad_speed_dependence": {"speed_slope": slope}}, duration=3.0, car=car)
    limit = 20.0 - 1.0 / slope  # where the friction would be gone
    expected = limit + (30.0 - limit) * np.exp(-a * slope * log.time)
    assert log["v"] == pytest.approx(expected, abs=1e-4)
