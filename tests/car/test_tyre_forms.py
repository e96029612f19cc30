"""The closed inverses of the tyre forms against their forward formulas from the literature."""

import numpy as np
import pytest

from calib.car.tyre_forms import FORMS, NEAR_PEAK, inverse_forms


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

USE = np.linspace(0.005, NEAR_PEAK, 200)


def inverse(form, use):
    return inverse_forms(np.asarray(use))[..., FORMS.index(form)]


@pytest.mark.parametrize("form", FORMS)
def test_forward_of_the_inverse_is_the_force(form):
    assert FORWARD[form](inverse(form, USE)) == pytest.approx(USE, abs=1e-12)


@pytest.mark.parametrize("form", FORMS)
def test_stiffness_is_one_at_the_origin(form):
    small = np.array([1e-6, 1e-5, 1e-4])
    assert inverse(form, 0.0) == 0.0
    assert inverse(form, small) / small == pytest.approx(1.0, abs=1e-4)


@pytest.mark.parametrize("form", FORMS)
def test_slip_rises_with_force_and_ever_faster(form):
    x = inverse(form, USE)
    assert np.all(np.diff(x) > 0.0)
    assert np.all(np.diff(x, 2) > -1e-12)


def test_near_the_peak_the_forms_are_apart_and_below_a_third_they_agree():
    low, high = inverse_forms(np.array([0.2, 0.9]))
    assert np.ptp(low) / low.mean() < 0.12
    assert np.ptp(high) / high.mean() > 0.5


def test_what_is_above_the_peak_counts_as_near_it():
    assert inverse_forms(np.array(1.3)) == pytest.approx(inverse_forms(np.array(NEAR_PEAK)))


def test_a_mean_of_forms_is_a_tyre():
    """Weights that add up to 1 keep the slope at the origin, and slip rises with force."""
    weights = np.array([0.4, 0.3, 0.1, 0.1, 0.1])
    x = inverse_forms(USE) @ weights
    assert x[0] / USE[0] == pytest.approx(1.0, abs=0.01)
    assert np.all(np.diff(x) > 0.0)
