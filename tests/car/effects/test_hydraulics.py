"""Effects of lines and calipers against closed solutions and recursions worked out here."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from calib.car.effects.hydraulics import hysteresis_loop, residual_clamp
from tests.support.effect_runs import made_history, pressures

PRESSURES = arrays(float, st.integers(1, 300), elements=st.floats(-1e5, 100e5))
WIDTH = st.floats(0.0, 0.5)
STUCK = {"residual_pressure": 2e5, "drain_time": 5.0}


@given(st.floats(0.0, 10e5), st.floats(0.0, 150e5))
def test_a_threshold_is_taken_off_the_pressure(threshold, p):
    history = made_history(1, p_mc=np.array([p]))
    for pressure_pair in pressures("brake_threshold_pressure", history, threshold=threshold):
        assert pressure_pair == pytest.approx([max(p - threshold, 0.0)], abs=1e-6)


@given(st.floats(1e3, 3e5), st.floats(0.0, 150e5), st.booleans())
def test_a_sensor_whose_zero_reads_too_low_is_a_threshold_below_zero(low, true, clipped):
    """A sensor that reads ``low`` too little, but not below zero, is corrected where it reads."""
    read = max(true - low, 0.0) if clipped else true - low
    history = made_history(1, p_mc=np.array([read]))
    for pressure_pair in pressures("brake_threshold_pressure", history, threshold=-low):
        assert -1e-6 <= pressure_pair[0] <= true + 1e-6
        if true == 0.0 or true > 2.0 * low:
            assert pressure_pair == pytest.approx([true], abs=1e-6)


@pytest.mark.parametrize(
    ("share", "front", "rear"),
    [(0.0, 2e5, 0.0), (0.25, 2e5, 1e5), (0.5, 2e5, 2e5), (1.0, 0.0, 2e5)],
)
def test_an_axle_has_its_share_of_the_threshold(share, front, rear):
    history = made_history(1, p_mc=np.array([30e5]))
    parameters = {"threshold": 2e5, "threshold_rear_share": share}
    pressure_pair = pressures("brake_threshold_pressure", history, **parameters)
    assert [float(p[0]) for p in pressure_pair] == pytest.approx([30e5 - front, 30e5 - rear])


@given(PRESSURES, WIDTH, st.floats(0.0, 5e5))
def test_hysteresis_is_its_recursion_and_does_not_change_its_input(p, relative, half):
    copy = p.copy()
    loading = [now - min(max(now, 0.0), half) for now in p]
    c = [loading[0]]
    for low, now in zip(loading[1:], p[1:], strict=True):
        c.append(max(low, min(now / (1.0 - relative) + half, c[-1])))
    assert np.array_equal(hysteresis_loop(p, relative, half), c)
    assert np.array_equal(p, copy)


@pytest.mark.parametrize("share", [0.0, 0.4, 1.0])
def test_the_width_of_the_loop_holds_at_20_bar(share):
    """The full width is a share of the line of release, or of 20 bar where it is fixed."""
    p = np.concatenate([np.linspace(0.0, 80e5, 801), np.linspace(80e5, 0.0, 801)])
    history = made_history(p.size, p_mc=p)
    front, _ = pressures("caliper_hysteresis", history, width=0.1, fixed_share=share)
    up, down = front[200], front[-201]
    assert down - up == pytest.approx(0.1 * share * 20e5 + 20e5 * (1 / (1 - 0.1 * (1 - share)) - 1))


@given(PRESSURES, st.floats(1e3, 20e5), st.floats(1.0, 60.0))
def test_the_residual_pressure_is_its_recursion(p, limit, drain):
    time = 5.0 + 0.3 * np.arange(p.size)
    residual, expected = 0.0, []
    for now in p:
        residual = max(residual * np.exp(-0.3 / drain), min(now, limit) if now > 1.5e5 else 0.0)
        expected.append(max(now, residual) if residual > 0.0 else now)
    clamp = residual_clamp(time, p, limit, drain)
    assert clamp == pytest.approx(np.array(expected), rel=1e-6, abs=1e-6)


@pytest.mark.parametrize(
    ("bias", "residual_bar"), [(0.0, (2.0, 2.0)), (1.0, (0.0, 2.0)), (-0.5, (2.0, 1.0))]
)
def test_one_axle_alone_may_keep_residual_pressure(bias, residual_bar):
    history = made_history(p_mc=np.where(np.arange(200) < 100, 20e5, 0.0))
    pressure_pair = pressures("residual_torque", history, **STUCK, rear_bias=bias)
    for pressure, bar in zip(pressure_pair, residual_bar, strict=True):
        assert pressure[199] == pytest.approx(bar * 1e5 * np.exp(-1.0 / 5.0))
