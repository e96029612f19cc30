"""The play against its recursion, its loop, and what makes it a play."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from calib.physics.effects.caliper_hysteresis import clamp
from tests.support.effect_runs import SEDAN, driven, made_history, pressures

PRESSURES = arrays(float, st.integers(1, 300), elements=st.floats(-1e5, 100e5))
WIDTH = st.floats(0.0, 0.5)


@given(PRESSURES, WIDTH)
def test_the_sweeps_are_the_recursion(p, width):
    c = [p[0]]
    for now in p[1:]:
        c.append(max(now, min(now / (1.0 - width), c[-1])))
    assert np.array_equal(clamp(p, width), c)


def test_a_loop_by_hand():
    """Up to 40 bar, held down to 36, down on the upper line, held up again, up on the lower."""
    p = np.array([0.0, 20.0, 40.0, 38.0, 36.0, 18.0, 9.0, 9.5, 10.0, 20.0, 0.0]) * 1e5
    c = np.array([0.0, 20.0, 40.0, 40.0, 40.0, 20.0, 10.0, 10.0, 10.0, 20.0, 0.0]) * 1e5
    assert clamp(p, 0.1) == pytest.approx(c)


@given(PRESSURES, WIDTH)
def test_the_input_is_left_alone_and_never_undercut(p, width):
    before = p.copy()
    assert np.all(clamp(p, width) >= p)
    assert np.array_equal(p, before)


@given(PRESSURES, WIDTH, st.integers(2, 4))
def test_the_rate_is_of_no_matter(p, width, slower):
    assert np.array_equal(clamp(np.repeat(p, slower), width)[::slower], clamp(p, width))


@given(st.floats(0.0, 0.5))
def test_rising_there_is_none_of_it(width):
    history = made_history(p_mc=np.linspace(0.0, 50e5, 200))
    for found in pressures("caliper_hysteresis", history, width=width):
        assert np.array_equal(found, history.p_mc)


def test_the_axles_have_it_each_for_itself():
    both = {
        "caliper_hysteresis": {"width": 0.1},
        "rear_proportioning": {"knee_slope": 0.0, "knee": 20e5},
    }
    log = driven(both, lambda t: 30e5 - 2.5e5 * t)  # the rear is held at the knee up to 4 s
    rear = log.truth["true_Tb_rl"] / (SEDAN.rear.pad_friction * SEDAN.rear.torque_gain)
    front = log.truth["true_Tb_fl"] / (SEDAN.front.pad_friction * SEDAN.front.torque_gain)
    assert rear == pytest.approx(20e5)
    assert front == pytest.approx(np.minimum(30e5, log["p_mc"] / 0.9))
