"""A ripple as samples hold it that are means of others."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.car.history import constant_speed


@given(st.integers(1, 5), st.floats(0.0, 2.5), st.floats(-3.0, 3.0))
def test_a_ripple_is_the_mean_of_its_samples(m, turn, phase):
    """``turn`` [rad] in one step of m samples, against the mean itself."""
    angle = turn / m * np.arange(60 * m)
    means = np.sin(angle + phase).reshape(60, m).mean(axis=1)
    time = np.arange(60.0)
    mean = angle.reshape(60, m).mean(axis=1)
    history = replace(constant_speed(time, np.zeros(60), 20.0), angle_f=mean, averaged=m)
    assert history.ripple(phase) == pytest.approx(means, abs=1e-9)
