"""The measurement equations: gradients against differences, values against closed forms."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.base.names import G
from calib.estimation.measurement import Given, axle_loads_now, braked, coasting, measurement
from calib.estimation.states import COUNT, States

L_F, L_R, H = 1.1556, 1.6494, 0.615
WEIGHT = 1744.0 * G
STRAIGHT = States(
    log_pad_ratio=0.0, log_stiffness=0.0, log_peak_ratio=0.0, load_shift=0.0, elastic_share=0.0,
    pitch_tempo=0.0, eta_zero=0.0, slip_zero=0.0, clock_offset=0.0, load_exponent=0.0,
    log_compliance=math.log(0.04), curvature_2=0.0, curvature_3=0.0, table_log_pad_ratio=0.0,
    log_tyre_ratio=0.0, radius_load=0.0, tyre_change=0.0,
    slip_delay=0.0,
)  # fmt: skip
"""A straight tyre of stiffness 25: every slip has a closed form."""


def block(z=0.3, level=0.9, pitch_deficit=0.02, pitch_slope=0.03, rear=1.0, rise=0.0):
    """One block of a stop of the reference car, with drag-like moments."""
    share = WEIGHT / (L_F + L_R)
    return Given(
        brake_f=0.73 * WEIGHT * z,
        brake_r=rear * 0.27 * WEIGHT * z,
        level=level,
        moment_f=60.0,
        moment_r=40.0,
        load_f=share * (L_R + z * H),
        load_r=share * (L_F - z * H),
        coasting_f=0.012,
        coasting_r=0.012,
        weight=WEIGHT,
        pitch_deficit=pitch_deficit,
        pitch_slope=pitch_slope,
        lag_gain=G * z / 20.0,
        static_f=share * L_R,
        static_r=share * L_F,
        rise=rise,
    )


STATES = st.builds(
    States,
    log_pad_ratio=st.floats(-0.5, 0.5),
    log_stiffness=st.floats(-0.6, 0.3),
    log_peak_ratio=st.floats(-0.7, 1.4),
    load_shift=st.floats(-0.03, 0.03),
    elastic_share=st.floats(-0.5, 1.2),
    pitch_tempo=st.floats(-0.5, 0.5),
    eta_zero=st.floats(-0.01, 0.01),
    slip_zero=st.floats(-0.01, 0.01),
    clock_offset=st.floats(-0.02, 0.02),
    load_exponent=st.floats(-0.05, 0.1),
    log_compliance=st.floats(-4.0, -2.5),
    curvature_2=st.floats(-0.2, 0.3),
    curvature_3=st.floats(0.0, 0.6),
    table_log_pad_ratio=st.floats(-0.2, 0.2),
    log_tyre_ratio=st.floats(-0.3, 0.3),
    radius_load=st.floats(-0.01, 0.02),
    tyre_change=st.floats(-0.1, 0.1),
    slip_delay=st.floats(-0.05, 0.2),
)
BLOCKS = st.builds(
    block,
    z=st.floats(0.03, 0.6),
    level=st.sampled_from([0.4, 1.0, 1.3]),
    pitch_deficit=st.floats(-0.05, 0.05),
    pitch_slope=st.floats(-0.1, 0.1),
    rear=st.sampled_from([0.0, 1.0]),
    rise=st.floats(-3e4, 3e4),
)


@pytest.mark.parametrize("equations", [braked, coasting])
@given(x=STATES, g=BLOCKS)
def test_gradients_are_those_of_central_differences(equations, x, g):
    program, at = measurement(equations), np.array(x)
    gradients = np.reshape(program(list(x), list(g))[1], (2, COUNT))
    for i, name in enumerate(States._fields):
        step = 1e-5 * np.eye(COUNT)[i]
        above, below = (program((at + s).tolist(), list(g))[0] for s in (step, -step))
        slopes = (np.array(above) - np.array(below)) / 2e-5
        assert gradients[:, i] == pytest.approx(slopes, rel=1e-5, abs=1e-7), name


@given(z=st.floats(0.05, 0.5), level=st.floats(0.4, 1.2), rho=st.floats(-0.4, 0.4))
def test_values_are_the_closed_form_of_a_straight_tyre(z, level, rho):
    """F = (brake + moment)/load, slip = F/25, eta = (1 - slip_r)/(1 - slip_f), written out."""
    x = STRAIGHT._replace(log_pad_ratio=rho, eta_zero=0.002, slip_zero=-0.001, clock_offset=0.005)
    g = block(z, level, 0.0)
    (eta, slip), *_ = measurement(braked)(list(x), list(g))
    total = level * (g.brake_f + g.brake_r)
    odds = g.brake_f / g.brake_r * math.exp(rho)
    slip_f = 0.04 * (total * odds / (1.0 + odds) + 60.0) / g.load_f
    slip_r = 0.04 * (total / (1.0 + odds) + 40.0) / g.load_r
    assert eta == pytest.approx(1.002 * (1.0 - slip_r) / (1.0 - slip_f))
    share = g.load_f / WEIGHT
    mean = share * slip_f + (1.0 - share) * slip_r
    assert slip == pytest.approx(mean - 0.001 + 0.005 * G * z / 20.0)


@given(
    z=st.floats(0.05, 0.5),
    ratio=st.floats(-0.3, 0.3),
    change=st.floats(-0.1, 0.1),
    fall=st.floats(0.0, 0.02),
)
def test_unlike_tyres_and_radii_under_load_are_the_closed_form(z, ratio, change, fall):
    """Stiffness 25 e^(-T/2) in front and 25 e^(T/2) behind; R = R_0 e^(-r (F_z/F_z0 - 1)).

    With R_0 in (19), (20): 1 - shown = omega R_0/v = (1 - slip) R_0/R.
    """
    x = STRAIGHT._replace(log_tyre_ratio=ratio, tyre_change=change, radius_load=fall)
    g = block(z, 1.0, 0.0)
    (eta, slip), *_ = measurement(braked)(list(x), list(g))
    stiff_f, stiff_r = (25.0 * math.exp(sign * 0.5 * (ratio + change)) for sign in (-1.0, 1.0))
    turned_f = 1.0 - (g.brake_f + 60.0) / g.load_f / stiff_f
    turned_r = 1.0 - (g.brake_r + 40.0) / g.load_r / stiff_r
    # load transfer z W h/L over the axle's load at rest
    turned_f *= math.exp(fall * z * H / L_R)
    turned_r *= math.exp(-fall * z * H / L_F)
    assert eta == pytest.approx(turned_r / turned_f)
    share = g.load_f / WEIGHT
    assert slip == pytest.approx(share * (1.0 - turned_f) + (1.0 - share) * (1.0 - turned_r))


@given(
    z=st.floats(0.05, 0.5),
    level=st.floats(0.4, 1.2),
    rho=st.floats(-0.4, 0.4),
    late=st.floats(-0.05, 0.1),
    rise=st.floats(-3e4, 3e4),
)
def test_slip_that_is_late_is_the_closed_form(z, level, rho, late, rise):
    """The force of a straight tyre is that of the pressure a while before, by axle."""
    x = STRAIGHT._replace(log_pad_ratio=rho, slip_delay=late)
    g = block(z, level, 0.0, rise=rise)._replace(moment_f=0.0, moment_r=0.0)
    (eta, slip), *_ = measurement(braked)(list(x), list(g))
    odds = g.brake_f / g.brake_r * math.exp(rho)
    built = level * (g.brake_f + g.brake_r - late * rise)
    slip_f = 0.04 * built * odds / (1.0 + odds) / g.load_f
    slip_r = 0.04 * built / (1.0 + odds) / g.load_r
    assert eta == pytest.approx((1.0 - slip_r) / (1.0 - slip_f))
    share = g.load_f / WEIGHT
    assert slip == pytest.approx(share * slip_f + (1.0 - share) * slip_r)


def test_a_motor_slips_its_own_axle_of_a_coasting_car():
    g = block(pitch_deficit=0.0)._replace(coasting_f=0.05)
    (eta, slip), *_ = measurement(coasting)(list(STRAIGHT), list(g))
    assert eta == pytest.approx((1.0 - 0.04 * 0.012) / (1.0 - 0.04 * 0.05))
    share = g.load_f / WEIGHT
    assert slip == pytest.approx(0.04 * (0.05 * share + 0.012 * (1.0 - share)))


def test_load_that_pitch_moves_late_lowers_the_front():
    """A lighter front axle slips more for the same brake."""
    x, program = list(STRAIGHT._replace(elastic_share=1.0)), measurement(braked)
    late, there = (program(x, list(block(pitch_deficit=d)))[0] for d in (0.02, 0.0))
    assert late[0] > there[0]
    ((front, rear),) = axle_loads_now()(x, list(block(pitch_deficit=0.02)))
    g = block()
    assert front == pytest.approx(g.load_f - 0.02 * WEIGHT)
    assert front + rear == pytest.approx(g.load_f + g.load_r)
    # a mode that is faster by e^0.1 has moved as much more as the slope says
    faster = list(STRAIGHT._replace(elastic_share=1.0, pitch_tempo=0.1))
    ((front, _),) = axle_loads_now()(faster, list(block(pitch_deficit=0.02, pitch_slope=-0.05)))
    assert front == pytest.approx(g.load_f - (0.02 - 0.005) * WEIGHT)
