"""The three look-ups against a straight tyre in closed form, and the tyre curve against itself."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.car.forces import axle_loads, speed_ratio, split
from calib.car.tyre import PARAMETERS, Tyre
from calib.estimation.lookup import LOOKUPS, tyre
from calib.table.table import TyrePosterior
from tests.support.tables import VEHICLE, C, K, made_table


def table_of(*parameters, top=0.27):
    """The made table with this tyre, known exactly; ``top`` the greatest force it was seen at."""
    table = made_table(rows=41)
    covariance = ((0.0,) * 4,) * 4
    force = np.linspace(0.0, top, 41)
    return replace(
        table,
        posterior=TyrePosterior(PARAMETERS, parameters, covariance),
        tyre=replace(table.tyre, slip=force / C, force=force),
    )


STRAIGHT = table_of(-np.log(C), 0.0, 0.0, 0.0, top=0.5)


def on_the_ramp(x):
    """Eta and z where eta - 1 is x, and D = C (slip_f - slip_r) there, exactly.

    With F = C slip, (22) is eta - 1 = (slip_f - slip_r)/(1 - slip_f) and slip_f = (z + D w)/C,
    where w is the rear share of the load: D = x (C - z)/(1 + x w).
    """
    z = K * x
    w = (1.1556 - 0.615 * z) / 2.805
    return 1.0 + x, z, x * (C - z) / (1.0 + x * w)


@pytest.mark.parametrize("name", LOOKUPS)
def test_all_three_read_the_straight_tyre(name):
    eta, z, D = on_the_ramp(np.linspace(1e-4, 0.0045, 30))
    found = LOOKUPS[name](STRAIGHT, z, eta, z)
    # D = C (eta - 1) of two of them leaves out 1 - slip_f: at most z/C = 1 % of D here
    assert found.F_f - found.F_r == pytest.approx(D, rel=0.012)
    load_f, load_r = axle_loads(VEHICLE, z)
    total = (found.F_f * load_f + found.F_r * load_r) / VEHICLE.weight
    # f1 and f2 are straight between rows, by which (18) is off by f1'' step^2/8 between them
    assert total == pytest.approx(z, abs=1.5e-6 if name == "paper" else 1e-12)
    assert np.all(found.inside)


@pytest.mark.parametrize("name", LOOKUPS)
def test_known_effects_shift_the_level_and_not_the_difference(name):
    eta, z, _ = on_the_ramp(np.linspace(1e-4, 0.004, 9))
    plain, shifted = (LOOKUPS[name](STRAIGHT, z, eta, level) for level in (z, z - 0.02))
    assert shifted.F_f - plain.F_f == pytest.approx(-0.02, abs=1e-4)
    assert shifted.F_r - plain.F_r == pytest.approx(-0.02, abs=1e-4)


@given(
    st.floats(-4.0, -2.8),
    st.floats(0.0, 0.4),
    st.floats(0.0, 0.8),
    st.floats(-0.1, 0.2),
    st.floats(0.02, 0.7),
    st.floats(-0.15, 0.15),
)
def test_tyre_inverts_its_own_eta(c, b2, b3, q, z, D):
    curve, half = Tyre(c, b2, b3, q), 0.5 * VEHICLE.weight
    at = np.asarray([z])
    F_f, F_r = split(VEHICLE, at, np.asarray([D]))
    load_f, load_r = axle_loads(VEHICLE, at)
    eta = speed_ratio(curve.slip(F_f, load_f / half), curve.slip(F_r, load_r / half))
    found = tyre(table_of(c, b2, b3, q, top=1.0), at, eta, at)
    assert found.F_f - found.F_r == pytest.approx(D, abs=1e-9)
    assert bool(found.inside[0]) == (F_r[0] > -0.05)


@pytest.mark.parametrize("older", [True, False])
def test_tyre_reads_unlike_tyres_and_radii_under_load(older):
    """Stiffness C e^(-T/2) in front and C e^(T/2) behind; R = R_0 e^(-r (F_z/F_z0 - 1)).

    The load moved is W z h/L: over the loads at rest, z h/l_r in front and -z h/l_f behind. An
    ``older`` table names neither and means tyres alike.
    """
    ratio, fall = (0.0, 0.0) if older else (0.12, 0.006)
    names = (*PARAMETERS, "log_tyre_ratio", "radius_load")
    known = TyrePosterior(names, (-np.log(C), 0.0, 0.0, 0.0, ratio, fall), ((0.0,) * 6,) * 6)
    table = STRAIGHT if older else replace(STRAIGHT, posterior=known)
    z, D = np.linspace(0.05, 0.4, 15), np.linspace(-0.05, 0.06, 15)
    rear = (1.1556 - 0.615 * z) / 2.805
    F_f, F_r = z + rear * D, z - (1.0 - rear) * D
    turned_f = (1.0 - F_f / (C * np.exp(-0.5 * ratio))) * np.exp(fall * 0.615 * z / 1.6494)
    turned_r = (1.0 - F_r / (C * np.exp(0.5 * ratio))) * np.exp(-fall * 0.615 * z / 1.1556)
    found = tyre(table, z, turned_r / turned_f, z)
    assert found.F_f - found.F_r == pytest.approx(D, abs=1e-9)
    assert np.all(found.inside)


def test_tyre_knows_both_branches():
    """Eta of a car with fixed brakes rises, turns and falls; D follows, z tells the branches."""
    share, z = 0.729, np.linspace(0.02, 0.8, 200)
    load_f, load_r = axle_loads(VEHICLE, z)
    W, half = VEHICLE.weight, 0.5 * VEHICLE.weight
    F_f, F_r = share * W * z / load_f, (1.0 - share) * W * z / load_r
    curve = Tyre(-3.2, 0.1, 0.4, 0.05)
    eta = speed_ratio(curve.slip(F_f, load_f / half), curve.slip(F_r, load_r / half))
    assert 50 < np.argmax(eta) < 150
    found = tyre(table_of(-3.2, 0.1, 0.4, 0.05, top=1.0), z, eta, z)
    assert found.F_f - found.F_r == pytest.approx(F_f - F_r, abs=1e-9)


@pytest.mark.parametrize("name", ["paper", "difference"])
def test_beyond_the_curve_is_flagged_and_read_at_its_end(name):
    eta = np.array([0.999, 1.0, 1.005, 1.006])
    z = np.full(4, 0.3)
    found = LOOKUPS[name](STRAIGHT, z, eta, z)
    assert list(found.inside) == [False, True, True, False]
    assert found.F_f[0] == found.F_f[1]
    assert found.F_f[3] == found.F_f[2]


def test_inside_means_that_the_forces_give_the_eta_that_was_read():
    """Also on a curve that turns over, where Newton's steps may end anywhere."""
    rng = np.random.default_rng(0)
    half = 0.5 * VEHICLE.weight
    for b2, b3 in ((0.05, 0.4), (0.1, 1.0), (-0.2, 0.2), (-0.41, 0.004), (-0.54, 0.05)):
        z, eta = rng.uniform(0.0, 0.95, 2000), 1.0 + 0.01 * rng.normal(size=2000)
        found = tyre(table_of(-3.2, b2, b3, 0.03, top=1.0), z, eta, z)
        load_f, load_r = (load / half for load in axle_loads(VEHICLE, z))
        curve = Tyre(-3.2, b2, b3, 0.03)
        back = speed_ratio(curve.slip(found.F_f, load_f), curve.slip(found.F_r, load_r))
        assert back[found.inside] == pytest.approx(eta[found.inside], abs=1e-6)
        assert np.mean(found.inside) > 0.2


def test_a_force_beyond_what_was_seen_is_flagged():
    z = np.array([0.1, 0.3, 0.48, 0.52])
    found = tyre(STRAIGHT, z, np.ones(4), z)
    assert list(found.inside) == [True, True, True, False]
    assert not np.any(tyre(STRAIGHT, z, np.full(4, 1.03), z).inside)
