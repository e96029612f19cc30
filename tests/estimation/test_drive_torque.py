"""A motor that brakes and is logged: the estimate is that of the brakes alone."""

from dataclasses import replace

import numpy as np
import pytest

from calib.estimation.estimator import estimate
from calib.fitting.fit import fit
from tests.support.plant import as_log, drive
from tests.support.reference_car import CAR, REAL, covered, noisy, ramp, stop, with_pads, without

PADS = (0.31, 0.27)
CHANNELS = ("T_drive_f", "T_drive_r")


def regenerating(front, rear, lasting=False):
    """The car with a motor of so many N m a wheel: with the brakes, or ``lasting`` all the time."""

    def motor(t):
        share = 1.0 if lasting else min(max((t - 1.5) / 0.5, 0.0), 1.0)
        return -2.0 * front * share, -2.0 * rear * share

    return replace(REAL, motor=motor)


def driven(plant):
    """Ramp, coast and a stop with wet pads."""
    coast = drive(plant, lambda t: 0.0, 33.0, duration=12.0, stop_speed=8.0)
    wet = stop(with_pads(plant, *PADS), 35e5)
    logs = (ramp(plant), as_log(coast, "coast"), wet)
    return [noisy(log, seed) for seed, log in enumerate(logs, start=100)]


def judged(logs):
    """Truth in the interval and rms error of both axles, over the valid samples of the stop."""
    *runs, held_out = logs
    e = estimate(fit(CAR, runs), held_out)
    assert np.mean(e.valid[e.braked]) > 0.8
    axles = zip((e.best.pads_f, e.best.pads_r), PADS, strict=True)
    errors = [(axle.value / mu - 1.0)[e.valid] for axle, mu in axles]
    rms = np.sqrt(np.mean(np.square(errors), axis=1))
    return list(zip(covered(e, *PADS), rms, strict=True))


@pytest.fixture(scope="module")
def free():
    return driven(REAL)


@pytest.fixture(scope="module")
def control(free):
    return judged(free)


@pytest.mark.parametrize(("front", "rear", "lasting"), [(200, 0, False), (60, 60, True)])
def test_a_logged_motor_costs_nothing(control, front, rear, lasting):
    axles = judged(driven(regenerating(front, rear, lasting)))
    for (inside, rms), (_, free_rms), allowed in zip(axles, control, (0.015, 0.03), strict=True):
        assert inside > 0.95
        assert rms < free_rms + allowed


def test_a_motor_on_the_lead_in_is_not_zeroed_away(free):
    """100 N m a wheel slip the front tyres by 0.3 %; the radii differ by 0.08 %."""
    table = fit(CAR, free[:2])
    log = noisy(stop(regenerating(100, 0, lasting=True)), 5)
    zero = estimate(table, log).zeros[0] - 1.0
    # the front wheels turn slower by their larger share of the rolling resistance
    assert zero == pytest.approx(-0.0008, abs=2e-4)
    assert estimate(table, without(log, *CHANNELS)).zeros[0] > 1.001
