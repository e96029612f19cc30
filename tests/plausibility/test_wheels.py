"""A v that was made of the wheel speeds, and a wheel whose sensor loses pulses."""

from dataclasses import replace

import numpy as np
import pytest

from calib.plausibility.evidence import Evidence
from calib.plausibility.wheels import lost_pulses, slip_of_v
from calib.run.run import Run
from tests.support.reference_car import CAR, REAL, noisy, stop
from tests.support.refusals import broken, why_not


@pytest.fixture(scope="module")
def clean():
    return stop(REAL)


def warnings(log):
    return broken((slip_of_v, lost_pulses), Evidence(Run(log)))


def changed(log, **channels):
    return replace(log, channels={**log.channels, **channels})


@pytest.mark.parametrize(("wheels", "filtered"), [("fl fr", True), ("fl fr rl rr", False)])
def test_a_v_of_wheels_is_named_also_behind_a_filter(clean, wheels, filtered):
    log = noisy(clean, 1)
    v = CAR.front.rolling_radius * np.mean([log[f"omega_{w}"] for w in wheels.split()], axis=0)
    if filtered:
        v = np.round(v / 0.02) * 0.02
    (warning,) = warnings(changed(log, v=v))
    assert warning.code == "v_of_wheels"
    assert warning.measured < warning.expected[0]
    assert why_not(changed(log, v=v), "validate") == ["v_of_wheels"]


def test_a_v_that_is_off_by_a_factor_is_measured(clean):
    log = noisy(clean, 2)
    assert warnings(changed(log, v=1.03 * log["v"])) == []


@pytest.mark.parametrize("teeth", [48, 96])
def test_lost_pulses_name_the_wheel(clean, teeth):
    log, rng = noisy(clean, 4), np.random.default_rng(4)
    lost = rng.random(log.time.size) < 0.1
    run = changed(log, omega_rl=log["omega_rl"] * np.where(lost, 1.0 - 1.0 / teeth, 1.0))
    (warning,) = warnings(run)
    assert warning.code == "lost_pulses"
    assert "omega_rl" in warning.causes[0]
    assert warning.measured == pytest.approx(0.1, abs=0.05)  # of some 200 samples


def test_bumps_up_and_down_lose_no_pulses(clean):
    log, rng = noisy(clean, 5), np.random.default_rng(5)
    spikes = np.where(rng.random(log.time.size) < 0.02, rng.choice([-1.0, 1.0], log.time.size), 0)
    assert warnings(changed(log, omega_fr=log["omega_fr"] * (1.0 + 0.02 * spikes))) == []
