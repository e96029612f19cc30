"""The look-ups: what holds in every table, and that the plant's own curve lies in the band."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.base.names import G
from calib.fitting.curves import find_peak, ramp_path, readable_up_to
from calib.fitting.ensemble import SlipPrediction
from calib.fitting.fit import fit
from calib.table.curves import EXTRAPOLATED, INTERPOLATED, MEASURED
from calib.table.invariants import violations
from tests.support.drawn_cars import one_car
from tests.support.plant import brush, magic
from tests.support.reference_car import CAR, IDEAL, noisy, ramp, true_eta, true_forces, with_ratio

L_F, L_R, H = 1.1556, 1.6494, 0.615
"""Table II [m]."""

PLANTS = {
    "magic formula": IDEAL,
    "brush": replace(IDEAL, tyre=brush(25.0, 1.1)),
    "with E term": replace(IDEAL, tyre=magic(28.0, 0.9, curvature=-0.5)),
    "body that pitches": replace(IDEAL, pitch_frequency=1.3),
    "rear 8 % better": with_ratio(IDEAL, 1.0 / 1.08),
}


@pytest.fixture(scope="module")
def clean():
    return {name: ramp(plant) for name, plant in PLANTS.items()}


@pytest.fixture(scope="module")
def tables(clean):
    return {name: fit(CAR, [noisy(log, 0)]) for name, log in clean.items()}


@pytest.fixture(scope="module")
def gentle():
    """A table of a ramp to 0.33 g, short of any peak of eta."""
    return fit(CAR, [noisy(ramp(IDEAL, slope=3e5), 0)])


def test_18_holds_in_every_row(tables):
    for table in tables.values():
        p = table.paper
        front, rear = L_R + p.z * H, L_F - p.z * H  # (6), (7) over M g/L
        for f1, f2 in ((p.f1, p.f2), (p.f1_lower, p.f2_upper), (p.f1_upper, p.f2_lower)):
            assert np.max(np.abs(f1 + rear / front * f2)) < 1e-9


def test_every_table_is_sound_and_its_curves_are_one(tables, gentle):
    """D = f1 - f2, from (11) and (12)."""
    for table in (*tables.values(), gentle):
        assert violations(table) == ()
        d, p, t = table.difference, table.paper, table.tyre
        assert np.array_equal(p.eta, d.eta)
        assert p.f1 - p.f2 == pytest.approx(d.D, abs=1e-12)
        assert all(np.all(np.diff(axis) > 0.0) for axis in (p.z, t.force))
        assert d.eta[0] == 1.0
        assert not any(x[0] for x in (d.D, d.lower, d.upper, p.f1, p.f2, p.z, t.slip, t.force))


def difference_per_ratio(z):
    """d D/d ln(pad ratio) at z: D = z (phi/l_f - (1 - phi)/l_r), d phi/d rho = phi (1 - phi)."""
    gain = 28.84 * 130.9 / (11.34 * 124.0)
    phi = gain / (1.0 + gain)
    front = (L_R + z * H) / (L_F + L_R)
    return z * phi * (1.0 - phi) * (1.0 / front + 1.0 / (1.0 - front))


@pytest.mark.parametrize("name", PLANTS)
def test_band_holds_the_true_difference(clean, tables, name):
    """True D over true eta along the ramp, from forces and slips that no sensor sees."""
    log = clean[name]
    eta = true_eta(log, PLANTS[name])
    F_f, F_r = true_forces(log)
    top = int(np.argmax(eta)) + 1
    table, d = tables[name], tables[name].difference
    rows = (d.flag == MEASURED) & (d.eta <= eta[top - 1])
    assert rows.sum() > 30
    true = np.interp(d.eta[rows], eta[:top], (F_f - F_r)[:top])
    is_inside = (d.lower[rows] <= true) & (true <= d.upper[rows])
    assert np.mean(is_inside) >= 0.9
    # the band is no wider than needed: D to 26 % at half of the range, with the drift of the zero,
    # and the part of the pads' ratio, which tyres that differ imitate
    middle = d.eta.size // 2
    apart = difference_per_ratio(table.paper.z[middle]) * table.calibration.pad_log_ratio.sigma
    bound = 2.0 * math.hypot(0.26 * d.D[middle], 1.96 * apart)
    assert d.upper[middle] - d.lower[middle] < bound
    assert table.calibration.pad_log_ratio.sigma < 1.0 / math.hypot(1 / 0.15, 1 / 0.1) * 1.25


def test_band_holds_the_true_tyre(tables):
    """A wrong stiffness is wrong in every row, so 95 % can be counted only over several runs."""
    shares_inside = []
    for name in ("magic formula", "brush", "with E term"):
        force, t = PLANTS[name].tyre, tables[name].tyre
        rows = (t.flag == MEASURED) & (t.slip > 0.0)
        true = np.array([force(s, 1.0, 1.0, 1.0) for s in t.slip[rows]])
        shares_inside.append(np.mean((t.lower[rows] <= true) & (true <= t.upper[rows])))
        assert t.force[rows] == pytest.approx(true, rel=0.1)
    assert np.mean(shares_inside) >= 0.9


@pytest.mark.parametrize("name", ["magic formula", "brush", "with E term", "rear 8 % better"])
def test_peak_is_found_where_the_plant_has_it(clean, tables, name):
    log = clean[name]
    top = int(np.argmax(true_eta(log, PLANTS[name])))
    z = -log["a_x"][top] / G
    q = tables[name].quality
    assert q["eta_peak_is_real"] == 1.0
    assert q["eta_peak_deceleration"] == pytest.approx(z, abs=0.03)
    # beyond it eta has two values of f1, and just before it eta cannot be read backwards
    assert 0.85 * z < tables[name].paper.z[-1] < z


def turning(z, peak):
    """A path whose draws have eta as a parabola with these peaks (n,) [1]."""
    eta = 1.0 + 0.005 * (1.0 - (z / peak[:, None] - 1.0) ** 2)
    axles = np.stack([eta, eta])
    return SlipPrediction(z, eta - 1.0, eta - 1.0, axles, axles, eta > 0.0)


def test_a_fall_that_some_draws_do_not_have_is_no_peak():
    """All draws turn at 0.5, or two in a hundred beyond the ramp."""
    z = np.linspace(0.0, 0.6, 61)
    sure, vague = turning(z, np.full(100, 0.5)), turning(z, np.repeat([0.5, 0.8], [98, 2]))
    assert find_peak(sure) == (pytest.approx(0.5), pytest.approx(1.005), True)
    assert find_peak(vague) == (pytest.approx(0.5), pytest.approx(1.005, abs=1e-3), False)
    # a tenth of the first slope is left at 0.9 of the way to the top of a parabola
    assert readable_up_to(sure) == pytest.approx(0.45, abs=0.01)


@given(
    z=st.floats(0.01, 0.5),
    compliance=st.floats(0.02, 0.08),
    log_ratio=st.floats(-0.2, 0.2),
    tau=st.floats(-0.2, 0.2),
    r=st.floats(-0.005, 0.01),
)
def test_forces_along_the_ridge_balance(z, compliance, log_ratio, tau, r):
    """(17), and (9) with what stops the wheels themselves; a brush far below its peak is linear."""
    tyres = {f"compliance_{a}": compliance * np.exp(x * tau) for a, x in (("f", 0.5), ("r", -0.5))}
    e = one_car(peak=1e3, log_pad_ratio=log_ratio, radius_load=r, **tyres)
    p = ramp_path(CAR, e, np.array([z]))
    F_f, F_r = p.forces[:, 0, 0]
    share = CAR.mass * G / (L_F + L_R)
    loads = share * (L_R + z * H), share * (L_F - z * H)
    forces = F_f * loads[0], F_r * loads[1]
    assert sum(forces) == pytest.approx(CAR.mass * G * z)
    brakes = [
        force + 2.0 * inertia * G * z / 0.322**2
        for force, inertia in zip(forces, (1.20, 1.10), strict=True)
    ]
    nominal = 28.84 * 130.9 / (11.34 * 124.0)
    assert brakes[0] / brakes[1] == pytest.approx(nominal * np.exp(log_ratio))
    # a stiffer rear tyre slips less, and a loaded wheel of a smaller radius turns faster
    turning = []
    for F, slip, load, load_at_rest, half in (
        (F_f, p.slips[0, 0, 0], L_R + z * H, L_R, 0.5),
        (F_r, p.slips[1, 0, 0], L_F - z * H, L_F, -0.5),
    ):
        assert slip == pytest.approx(compliance * np.exp(half * tau) * F, rel=2e-3)
        turning.append((1.0 - slip) * np.exp(r * (load / load_at_rest - 1.0)))
    assert 1.0 + p.eta_rise[0, 0] == pytest.approx(turning[1] / turning[0])


def test_flags_follow_the_counts(tables, gentle):
    for table in (*tables.values(), gentle):
        for curve in (table.difference, table.paper, table.tyre):
            measured = np.flatnonzero(curve.count >= 3)
            assert np.array_equal(np.flatnonzero(curve.flag == MEASURED), measured)
            beyond = np.arange(curve.count.size) > measured[-1]
            assert np.array_equal(curve.flag == EXTRAPOLATED, beyond)
            assert set(curve.flag) <= {MEASURED, INTERPOLATED, EXTRAPOLATED}
