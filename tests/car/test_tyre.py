"""The compliance against its inverse, its slope against differences, its shape against a brush."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq

from calib.car.tyre import PARAMETERS, AxleTyres, Tyre
from tests.support.plant import brush

forces = st.floats(-0.1, 1.0)
loads = st.floats(0.3, 1.7)


@st.composite
def tyres(draw) -> Tyre:
    return Tyre(
        log_compliance=draw(st.floats(-4.5, -2.5)),
        curvature_2=draw(st.floats(0.0, 0.5)),
        curvature_3=draw(st.floats(0.0, 0.8)),
        load_exponent=draw(st.floats(-0.2, 0.3)),
        log_stiffness=draw(st.floats(-1.0, 1.0)),
        peak_ratio=draw(st.floats(0.5, 3.0)),
    )


def test_parameters_are_the_first_fields():
    assert Tyre(**dict(zip(PARAMETERS, (1.0, 2.0, 3.0, 4.0), strict=True))) == Tyre(1, 2, 3, 4)


@given(tyres(), forces, loads)
def test_inverse_found_by_bisection_gives_the_force_back(tyre, force, load):
    slip = float(tyre.slip(np.asarray(force), load))
    found = brentq(lambda F: float(tyre.slip(np.asarray(F), load)) - slip, -0.15, 1.1, xtol=1e-13)
    assert found == pytest.approx(force, abs=1e-9)


@given(tyres(), forces, loads)
def test_slope_is_the_central_difference(tyre, force, load):
    h = 1e-4  # a cubic leaves an error of h^2 and no more
    up, down = (tyre.slip(np.asarray(force + d), load) for d in (h, -h))
    assert tyre.slope(np.asarray(force), load) == pytest.approx((up - down) / (2 * h), rel=1e-5)


@given(tyres(), forces, loads)
def test_a_surface_shrinks_the_curve_along_both_axes(tyre, force, load):
    """Pacejka's similarity: F(slip) = F_0(w slip)/w, and the stiffness apart from it."""
    w, s = tyre.peak_ratio, tyre.log_stiffness
    own = replace(tyre, log_stiffness=0.0, peak_ratio=1.0)
    assert tyre.slip(np.asarray(force), load) == pytest.approx(
        np.exp(-s) * own.slip(np.asarray(w * force), load) / w, rel=1e-9, abs=1e-15
    )


@given(st.floats(0.6, 1.2), st.floats(0.01, 0.25))
def test_takes_the_shape_of_a_brush_at_small_forces(peak, used):
    """3 mu/K (1 - (1 - x)^(1/3)) = F/K (1 + x/3 + 5 x^2/27 + 10 x^3/81 + ...), x = F/mu."""
    road = brush(stiffness=25.0, peak=peak)
    tyre = Tyre(-np.log(25.0), 1.0 / 3.0, 5.0 / 27.0, 0.0, peak_ratio=1.0 / peak)
    slip = float(tyre.slip(np.asarray(used * peak), 1.0))
    assert road(slip, 1.0, 1.0, 1.0) == pytest.approx(used * peak, rel=0.2 * used**3)


FORCES, LOADS, REST = (np.array([0.5]), np.array([0.25])), (12e3, 4e3), (10e3, 6e3)
"""Front and rear: normalised forces [1], loads [N] of a braked car, and at rest."""


def test_stiffer_rear_tyres_slip_less_and_the_front_ones_as_much_more():
    tyre = Tyre(np.log(0.04), 0.0, 0.0, 0.0)
    loads = tuple(np.array([x]) for x in LOADS)
    front, rear = AxleTyres(tyre, log_ratio=np.log(1.21)).slips(FORCES, loads, REST)
    assert front[0] == pytest.approx(0.04 * 0.5 * 1.1)
    assert rear[0] == pytest.approx(0.04 * 0.25 / 1.1)


def test_a_loaded_wheel_turns_faster_than_its_slip_lets_expect():
    """Front 20 % more load, rear a third less: radii of exp(-0.2 r) and exp(+r/3) of those at rest.

    v = R omega/(1 - slip), so the slip against the radius at rest is 1 - (1 - slip) R0/R.
    """
    tyre, r = Tyre(np.log(0.04), 0.0, 0.0, 0.0), 0.01
    loads = tuple(np.array([x]) for x in LOADS)
    front, rear = AxleTyres(tyre, radius_load=r).slips(FORCES, loads, REST)
    assert front[0] == pytest.approx(1.0 - 0.98 * np.exp(0.2 * r))
    assert rear[0] == pytest.approx(1.0 - 0.99 * np.exp(-r / 3.0))


def test_what_the_axles_show_comes_back_to_the_common_curve():
    """At half the weight on an axle, equal tyres and one radius: slip = 0.04 F here."""
    tyre = Tyre(np.log(0.04), 0.0, 0.0, 0.3)
    tyres = AxleTyres(tyre, log_ratio=0.2, radius_load=0.01)
    loads = tuple(np.array([x]) for x in LOADS)
    front, rear = tyres.on_the_curve(tyres.slips(FORCES, loads, REST), loads, REST)
    assert front[0] == pytest.approx(0.04 * 0.5)
    assert rear[0] == pytest.approx(0.04 * 0.25)
