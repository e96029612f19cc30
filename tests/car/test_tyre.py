"""The closed forms of the tyre against the formula and its derivative, and forms of the curve."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.car.tyre import MagicFormula
from calib.car.tyre_forms import FORMS, NEAR_PEAK, inverse_forms

tyres = st.builds(
    MagicFormula,
    stiffness=st.floats(5.0, 60.0),
    peak=st.floats(0.1, 1.2),
    shape=st.floats(1.1, 1.95),
    load_exponent=st.floats(-0.5, 0.5),
    bend=st.floats(0.0, 0.8),
    peak_exponent=st.floats(-0.2, 0.2),
)
loads = st.floats(0.3, 1.7)


@given(tyres, loads, st.floats(-0.999, 0.999))
def test_slip_and_force_are_inverse_on_the_rising_branch(tyre, load, fraction):
    force = np.array([fraction * tyre.peak_at(load)])
    assert tyre.force(tyre.slip_at_force(force, load)[0], load) == pytest.approx(
        force, rel=1e-9, abs=1e-12
    )


@given(tyres, loads, st.floats(-0.3, 0.3))
def test_slope_is_the_derivative_of_the_force(tyre, load, slip):
    h = 1e-8
    low, high = tyre.force(np.array([slip - h, slip + h]), load)
    slope = tyre.slope(np.array([slip]), load)[0]
    assert (high - low) / (2.0 * h) == pytest.approx(slope, rel=1e-5, abs=1e-5)


@given(tyres, loads)
def test_the_peak_is_where_the_slope_vanishes(tyre, load):
    peak = tyre.slip_at(1.0, load)
    assert tyre.force(peak, load) == pytest.approx(tyre.peak_at(load), rel=1e-12)
    assert abs(tyre.slope(peak, load)) < 1e-9 * tyre.stiffness


def test_force_at_a_slip_worked_by_hand():
    """K = 33, mu = 1, C = 1.65 give B = 20; at lambda = 0.05, B lambda = 1 and atan is pi/4."""
    tyre = MagicFormula(33.0, 1.0, 1.65)
    assert tyre.force(np.array([0.05]))[0] == pytest.approx(math.sin(1.65 * math.pi / 4.0))


@given(st.floats(0.3, 1.2), st.floats(1.1, 1.9))
def test_a_bend_of_a_third_of_the_shape_begins_as_a_brush(peak, shape):
    """Brush with parabolic pressure: F = mu (1 - (1 - K s/(3 mu))^3), to second order."""
    tyre = MagicFormula(25.0, peak, shape, bend=shape / 3.0)
    slip = np.array([0.02, 0.01]) * peak / tyre.stiffness
    brush = peak * (1.0 - (1.0 - tyre.stiffness * slip / (3.0 * peak)) ** 3)
    without_bend = replace(tyre, bend=0.0).force(slip)
    with_bend = tyre.force(slip)
    assert np.abs(with_bend - brush) / slip == pytest.approx(0.0, abs=4e-4 * tyre.stiffness)
    assert np.all((without_bend - brush) / slip > 3e-3 * tyre.stiffness)


def test_the_wheel_slip_leads_by_the_relaxation_length():
    """The linear tyre of ch. 7: sigma ds'/dt + v s' = v s."""
    time, v = np.linspace(0.0, 2.0, 401), np.full(401, 15.0)
    carried = 0.01 * time**2
    slip = MagicFormula(25.0, 0.9, relaxation=0.3).wheel_slip(carried, v, time)
    assert slip[1:-1] == pytest.approx((carried + 0.3 / 15.0 * 0.02 * time)[1:-1], abs=1e-9)
    assert MagicFormula(25.0, 0.9).wheel_slip(carried, v, time) is carried


def magic(shape):
    """Pacejka, Tyre and Vehicle Dynamics, ch. 4, without curvature; slope 1 at the origin."""
    return lambda x: np.sin(shape * np.arctan(x / shape))


FORWARD = {
    # parabolic pressure: Pacejka, ch. 3
    "brush": lambda x: 1.0 - (1.0 - x / 3.0) ** 3,
    # Burckhardt, Fahrwerktechnik: Radschlupf-Regelsysteme, without the fall after the peak
    "exponential": lambda x: 1.0 - np.exp(-x),
    # Dugoff, Fancher, Segel 1970: straight up to half of the peak
    "dugoff": lambda x: np.where(x < 0.5, x, 1.0 - 0.25 / x),
    "magic_sharp": magic(1.65),
    "magic_round": magic(1.25),
}

SHARES = np.linspace(0.005, NEAR_PEAK, 200)


def inverse(form, share):
    return inverse_forms(np.asarray(share))[..., FORMS.index(form)]


@pytest.mark.parametrize("form", FORMS)
def test_forward_of_the_inverse_is_the_force(form):
    assert FORWARD[form](inverse(form, SHARES)) == pytest.approx(SHARES, abs=1e-12)
