"""The play against its recursion, its loop, and what makes it a play."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from calib.car.effects.caliper_hysteresis import Play, clamp, pressure
from tests.support.effect_runs import (
    SEDAN,
    apart,
    driven,
    made_history,
    on_the_plant,
    pressures,
)

PRESSURES = arrays(float, st.integers(1, 300), elements=st.floats(-1e5, 100e5))
WIDTH = st.floats(0.0, 0.5)


@given(PRESSURES, WIDTH)
def test_the_sweeps_are_the_recursion(p, width):
    c = [p[0]]
    for now in p[1:]:
        c.append(max(now, min(now / (1.0 - width), c[-1])))
    assert np.array_equal(clamp(p, Play(width)), c)


def test_a_loop_by_hand():
    """Up to 40 bar, held down to 36, down on the upper line, held up again, up on the lower."""
    p = np.array([0.0, 20.0, 40.0, 38.0, 36.0, 18.0, 9.0, 9.5, 10.0, 20.0, 0.0]) * 1e5
    c = np.array([0.0, 20.0, 40.0, 40.0, 40.0, 20.0, 10.0, 10.0, 10.0, 20.0, 0.0]) * 1e5
    assert clamp(p, Play(0.1)) == pytest.approx(c)


@given(PRESSURES, WIDTH)
def test_the_input_is_left_alone_and_never_undercut(p, width):
    before = p.copy()
    assert np.all(clamp(p, Play(width)) >= p)
    assert np.array_equal(p, before)


@given(PRESSURES, WIDTH, st.integers(2, 4))
def test_the_rate_is_of_no_matter(p, width, slower):
    assert np.array_equal(clamp(np.repeat(p, slower), Play(width))[::slower], clamp(p, Play(width)))


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


def test_a_fixed_loop_by_hand():
    """Half a width of 2 bar: bites late, comes back late, keeps 2 bar when the pedal is free."""
    p = np.array([0.0, 1.0, 3.0, 20.0, 18.0, 16.0, 10.0, 12.0, 14.0, 20.0, 1.0, 0.0]) * 1e5
    c = np.array([0.0, 0.0, 1.0, 18.0, 18.0, 18.0, 12.0, 12.0, 12.0, 18.0, 3.0, 2.0]) * 1e5
    assert clamp(p, Play(0.0, 2e5)) == pytest.approx(c)


@given(PRESSURES, WIDTH, st.floats(0.0, 5e5))
def test_both_widths_together_are_the_recursion(p, relative, half):
    loading = [now - min(max(now, 0.0), half) for now in p]
    c = [loading[0]]
    for low, now in zip(loading[1:], p[1:], strict=True):
        c.append(max(low, min(now / (1.0 - relative) + half, c[-1])))
    assert np.array_equal(clamp(p, Play(relative, half)), c)


@pytest.mark.parametrize("share", [0.0, 0.4, 1.0])
def test_the_width_is_told_at_20_bar(share):
    """Full width of the loop over the releasing line, or over 20 bar where it is fixed."""
    p = np.concatenate([np.linspace(0.0, 80e5, 801), np.linspace(80e5, 0.0, 801)])
    history = made_history(p.size, p_mc=p)
    front, _ = pressures("caliper_hysteresis", history, width=0.1, fixed_share=share)
    up, down = front[200], front[-201]
    assert down - up == pytest.approx(0.1 * share * 20e5 + 20e5 * (1 / (1 - 0.1 * (1 - share)) - 1))


def test_an_older_file_without_a_share_has_a_width_that_grows_with_the_pressure():
    history = made_history(p_mc=20e5 + 15e5 * np.cos(0.02 * np.arange(200)))
    old = pressure({"width": 0.1}, history, history.p_mc, history.p_mc)
    new = pressure({"width": 0.1, "fixed_share": 0.0}, history, history.p_mc, history.p_mc)
    assert np.array_equal(old[0], new[0])


def test_a_fixed_play_follows_the_plant_told_the_same_clamp():
    def pedal(t):
        return 6e5 * min(t, 4.0 - t)  # up to 12 bar and back in 4 s

    def clamped(t):
        rising, falling = max(6e5 * t - 1e5, 0.0), 6e5 * (4.0 - t) + 1e5
        return rising if t < 2.0 else min(11e5, falling)

    width = {"caliper_hysteresis": {"width": 0.1, "fixed_share": 1.0}}
    log, run = driven(width, pedal), on_the_plant(clamped)
    assert apart(log, run, "v") < 3e-3
    assert apart(driven({}, pedal), run, "v") > 0.05
