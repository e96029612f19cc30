"""The paper's law as written against a plain loop over (13), (14), and on an ideal car."""

import numpy as np
import pytest

from calib.estimation import adaptive
from calib.estimation.as_written import as_written
from calib.estimation.estimator import estimate
from calib.fitting.fit import fit
from calib.run.axle_signals import Signals
from tests.support.reference_car import CAR, IDEAL, ramp, stop, with_pads
from tests.support.tables import VEHICLE, C, K, made_table

G = 9.80665
DT, N = 0.005, 800
ETA = 1.003
TRUE = (0.30, 0.45)


def run(spin):
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


def test_error_falls_by_the_same_gamma_u2_dt_on_both_axles():
    """theta - zeta shrinks by 1 - gamma u^2 dt a sample, however the wheels shake."""
    spin = -10.0 + 30.0 * np.random.default_rng(1).normal(size=N)
    s = run(spin)
    found = as_written(made_table(), VEHICLE, s, np.full(N, ETA))
    gamma = adaptive.gain(VEHICLE.front)
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


@pytest.fixture(scope="module")
def table():
    return fit(CAR, [ramp(IDEAL)])


def ends(table, log):
    """Last values of the law as written while the car brakes above 3 m/s, front and rear [1]."""
    e = estimate(table, log)
    last = int(np.flatnonzero(e.braked & (e.speed > 3.0))[-1])
    return tuple(float(pad[last]) for pad in e.baselines["gradient_as_written"])


@pytest.mark.parametrize("pad", [0.38, 0.2])
def test_it_is_right_on_the_car_that_the_paper_describes(table, pad):
    """Constant pads alike, no noise, no drag, exact radii, the road of the ramp: within 1.5 %.

    What is left is the table's: D(eta) from another tyre curve than the plant's, 4 % off.
    """
    found = ends(table, stop(with_pads(IDEAL, pad, pad), 25e5))
    assert found == pytest.approx((pad, pad), rel=0.015)
