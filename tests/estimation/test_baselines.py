"""The methods beside the estimate: shown, or left out with a note; none of them stops a run."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from calib.car.effects.effects import Effects
from calib.estimation.baselines import METHODS, as_written, gain, mean_gain
from calib.estimation.estimator import estimate
from calib.estimation.validate import validate
from calib.fitting.fit import fit
from calib.run.axle_signals import Signals, signals
from calib.run.brake_response import brake_balance
from tests.support.reference_car import CAR, IDEAL, REAL, noisy, ramp, stop, with_pads, without
from tests.support.tables import VEHICLE, C, K, made_table

G = 9.80665
UNSTABLE = {name for name in METHODS if name.startswith("gradient")}


@pytest.fixture(scope="module")
def ideal():
    return fit(CAR, [ramp(IDEAL)])


def test_a_law_that_is_unstable_has_no_error(fitted):
    """gamma u^2 dt = 8/s (p/20 bar)^2 dt is 2.45 at 70 bar and 40 Hz; no wheel locks."""
    log = stop(with_pads(REAL, 0.2, 0.2), 70e5, duration=6.0, rate=40.0)
    (found,) = validate(fitted, [noisy(log, 2)])
    assert {*METHODS} - {*found.baselines} == UNSTABLE
    e = found.estimate
    for name in UNSTABLE:
        assert np.isnan(METHODS[name](e)[0]).all()
    assert np.mean(e.valid[e.braked & (e.read.speed > 5.0)]) > 0.5


def test_errors_are_against_truth_or_the_speed(fitted):
    log = noisy(stop(), 3)
    blind = replace(log, truth={})
    by_truth, by_speed, by_nothing = validate(fitted, [log, blind, without(blind, "v")])
    assert set(by_truth.baselines) == {"estimate", "ecu", *METHODS}
    assert set(by_speed.baselines) == {"ecu", *METHODS}
    assert by_nothing.baselines == {}
    told = [found.compared_with for found in (by_truth, by_speed, by_nothing)]
    assert told == ["truth", "reference", "none"]
    e = by_speed.estimate
    off = (METHODS["nominal"](e)[1] / e.best.pads_r.value - 1.0)[e.valid]
    assert by_speed.baselines["nominal"][1] == pytest.approx(np.sqrt(np.mean(off**2)))


# Mean gain ---------------------------------------------------------------------------------------


def test_mean_gain_is_the_mean_weighted_by_force(ideal):
    """Pads 0.31/0.27 of nominal 0.38: one factor, with the gains A r of Table I as weights."""
    e = estimate(ideal, stop(with_pads(IDEAL, 0.31, 0.27), 30e5), CAR)
    front, rear = mean_gain(e)
    assert np.array_equal(front, rear)
    assert front[0] == 0.38
    weights = (28.84 * 130.9, 11.34 * 124.0)
    mean = np.average([0.31, 0.27], weights=weights)
    assert front[e.valid & (e.time > 3.0)] == pytest.approx(mean, rel=0.005)


def run_of(log, known=None, s=None, eta=None, car=CAR):
    """A run as the methods need it."""
    s = s or signals(log, car.rear.rolling_radius)
    return SimpleNamespace(
        table=made_table(),
        car=replace(car, effects=known or Effects()),
        ran=SimpleNamespace(log=log),
        read=s,
        forces=brake_balance(car, Effects(), s),
        eta=np.ones_like(s.z) if eta is None else eta,
    )


@pytest.fixture(scope="module")
def braking():
    return stop(IDEAL, 40e5)


# The law as it is written ------------------------------------------------------------------------

DT, N, ETA, TRUE = 0.005, 800, 1.003, (0.30, 0.45)


def turning(spin):
    """Signals of wheels that turn by (13), (14) at constant z and eta, with the pads ``TRUE``."""
    z, D = K * (ETA - 1.0), C * (ETA - 1.0)
    rear = (1.1556 - z * 0.615) / 2.805  # (7) over the weight
    loads = (1744.0 * G * (1.0 - rear), 1744.0 * G * rear)
    forces = (z + D * rear, z - D * (1.0 - rear))  # (11), (12), (18)
    pressures = []
    for axle, mu, F, load in zip((VEHICLE.front, VEHICLE.rear), TRUE, forces, loads, strict=True):
        torque = F * 0.322 * load / 2.0 - axle.wheel_inertia * spin
        p = torque / (mu * 2.0 * axle.piston_area * axle.effective_radius)
        p[0] = 0.0  # there is no sample before, so no d omega/dt
        pressures.append(p)
    omega = 80.0 + DT * np.cumsum(spin)
    flat = np.ones(N)
    return Signals(
        time=DT * np.arange(N),
        p_f=pressures[0],
        p_r=pressures[1],
        drive_f=0.0 * flat,
        drive_r=0.0 * flat,
        z=z * flat,
        omega_f=omega,
        omega_r=omega,
        v=None,
        speed=0.322 * omega,
        lead_in=flat < 0.0,
        sample_time=DT,
    )


def test_error_falls_by_the_same_gamma_u2_dt_on_both_axles(braking):
    """theta - zeta shrinks by 1 - gamma u^2 dt a sample, however the wheels shake."""
    s = turning(-10.0 + 30.0 * np.random.default_rng(1).normal(size=N))
    found = as_written(run_of(braking, s=s, eta=np.full(N, ETA), car=VEHICLE))
    gamma = gain(VEHICLE.front)
    for pad, axle, mu, p in zip(
        found, (VEHICLE.front, VEHICLE.rear), TRUE, (s.p_f, s.p_r), strict=True
    ):
        u = 2.0 * axle.piston_area * axle.effective_radius * p
        error, expected = 0.38 - mu, []
        for value in u:
            error *= 1.0 - gamma * value**2 * DT
            expected.append(mu + error)
        assert pad == pytest.approx(np.array(expected), abs=1e-10)
    front, rear = (abs(pad[200] - mu) / abs(0.38 - mu) for pad, mu in zip(found, TRUE, strict=True))
    assert front < 0.01  # after 1 s
    assert rear > 0.05  # one gamma for both axles makes the rear slow


def test_it_is_frozen_where_no_pads_bite(braking):
    e = run_of(braking, eta=np.full_like(braking.time, ETA))
    acts = e.forces.active[1:]
    for pad in METHODS["gradient_paper"](e):
        assert pad[0] == 0.38
        assert not np.any(np.diff(pad)[~acts])
        assert np.mean(np.diff(pad)[acts] != 0.0) > 0.9


@pytest.mark.parametrize("name", ["gradient_as_written", "gradient_paper"])
@pytest.mark.parametrize("pad", [0.38, 0.2])
def test_the_law_is_right_on_the_car_that_the_paper_describes(ideal, name, pad):
    """Constant pads alike, no noise, no drag, exact radii, the road of the ramp: within 2 %.

    What is left is the table's: D(eta) from another tyre curve than the plant's, 4 % off.
    """
    e = estimate(ideal, stop(with_pads(IDEAL, pad, pad), 25e5))
    last = int(np.flatnonzero(e.braked & (e.read.speed > 3.0))[-1])
    found = [float(axle[last]) for axle in METHODS[name](e)]
    assert found == pytest.approx((pad, pad), rel=0.02)
