"""Wheels that disagree by a known amount."""

import numpy as np
import pytest

from calib.base.names import WHEELS
from calib.run.driving_record import brake_events, driving_record
from calib.run.wheels import axles_of, mismatch, slipping
from tests.support.made_runs import RADIUS, SLIP_F, SLIP_R, changed, made_run, ramp, stop, with_slip


def slip_of(log):
    driving = driving_record(log)
    return slipping(log, driving, brake_events(driving))


def test_interval_holds_the_truth_as_often_as_it_says():
    rng = np.random.default_rng(1)
    hits = 0
    for _ in range(400):
        a, b = (80.0 + 0.05 * rng.normal(size=400) for _ in range(2))
        found = mismatch(a, 1.001 * b, np.ones(400, bool), 0.005)
        hits += abs(found.value - 0.001) < found.half
    assert 0.92 < hits / 400 < 0.98


def test_too_short_for_an_interval():
    assert mismatch(np.ones(100), np.ones(100), np.ones(100, bool), 0.005) is None


def test_radii_front_rear_and_left_right():
    log = made_run(ramp(start=4.0), duration=8.0)
    log = changed(
        log,
        omega_rl=1.002 * log["omega_rl"],
        omega_rr=1.002 * log["omega_rr"],
        omega_fr=1.010 * log["omega_fr"],
    )
    axles = axles_of(log, driving_record(log))
    assert axles.front_rear.value == pytest.approx(1.002 / 1.005 - 1, abs=3e-5)
    assert axles.left_right_f.value == pytest.approx(0.010, abs=3e-5)
    assert axles.left_right_r.value == pytest.approx(0.0, abs=3e-5)
    assert axles.front_rear.half < 1e-4


def test_eta_while_braked():
    axles = axles_of(log := made_run(stop(level=28.0)), driving_record(log))  # 0.4 g
    expected = (1 - 0.4 * SLIP_R) / (1 - 0.4 * SLIP_F) - 1
    assert axles.eta_braked.value == pytest.approx(expected, rel=0.02)


def test_eta_that_falls_again_is_seen_where_its_mean_is_zero():
    """Eta - 1 = 0.04 z (0.37 - z), over a ramp of 0.1 g/s up to 0.49 g: its means by integrals."""
    log = made_run(ramp(rate=7.0, top=35.0), duration=6.4, noise=0.0)
    z = 0.1 * np.clip(log.time - 1.5, 0.0, None)
    rear = {f"omega_r{s}": log[f"omega_f{s}"] * (1.0 + 0.04 * z * (0.37 - z)) for s in "lr"}
    log = changed(log, **rear)
    axles = axles_of(log, driving_record(log))
    assert abs(axles.eta_braked.value) < 3e-4  # 0.6e-4 from 0.20 to 0.49 g
    assert axles.eta_most.value == pytest.approx(13.0e-4, abs=1e-4)  # 0.10 to 0.23 g


@pytest.mark.parametrize("rate", [40.0, 200.0, 1000.0])
def test_slope_is_the_rolling_radius(rate):
    log = made_run(ramp(rate=8.0), rate=rate)
    assert axles_of(log, driving_record(log)).slope == pytest.approx(RADIUS, rel=0.03)


def test_slope_of_a_wrong_sign():
    log = made_run()
    log = changed(log, a_x=-log["a_x"])
    assert axles_of(log, driving_record(log)).slope == pytest.approx(-RADIUS, rel=0.03)


def test_no_slope_of_a_coast():
    log = made_run(lambda t: 0.0 * t)
    assert axles_of(log, driving_record(log)).slope is None


@pytest.mark.parametrize("locks_after", [0.6, 2.5])
def test_locked_wheels_do_not_make_another_radius(locks_after):
    """The wheels stop within 0.3 s while the car goes on: no radius, or that of the time before."""
    log = made_run(stop(level=28.0))
    start = log.time[np.argmax(log["p_mc"] > 2e5)] + locks_after
    turning = np.clip(1.0 - (log.time - start) / 0.3, 0.0, 1.0)
    log = changed(log, **{f"omega_{w}": turning * log[f"omega_{w}"] for w in WHEELS})
    slope = axles_of(log, driving_record(log)).slope
    assert slope is None or slope == pytest.approx(RADIUS, rel=0.2)


@pytest.mark.parametrize("v", [True, False])
def test_abs_on_one_wheel(v):
    found = slip_of(with_slip(made_run(stop()), ["fl"], 3.0, 0.4, 0.25, v))
    ((wheel, when),) = found.cycles
    assert wheel == "fl"
    assert when == pytest.approx(3.0, abs=0.06)
    assert found.locked == ()


def test_abs_on_all_wheels_needs_a_reference_speed():
    assert len(slip_of(with_slip(made_run(stop()), WHEELS, 3.0, 0.4, 0.25)).cycles) == 4
    assert slip_of(with_slip(made_run(stop()), WHEELS, 3.0, 0.4, 0.25, v=False)).cycles == ()


@pytest.mark.parametrize(("depth", "length"), [(0.10, 0.4), (0.25, 2.5)])
def test_mild_or_slow_slip_is_no_abs(depth, length):
    assert slip_of(with_slip(made_run(stop()), ["fl"], 3.0, length, depth)).cycles == ()


def spiked(log, wheel, share):
    """The run with single samples of a wheel speed that are far too low."""
    wild = np.random.default_rng(5).random(log.time.size) < 0.01
    wild[1:] &= ~wild[:-1]
    return changed(log, **{f"omega_{wheel}": np.where(wild, share, 1.0) * log[f"omega_{wheel}"]})


@pytest.mark.parametrize("v", [True, False])
@pytest.mark.parametrize("share", [0.0, 0.5])
def test_spikes_of_one_sample_are_no_abs(share, v):
    run = made_run(stop())
    found = slip_of(spiked(run if v else changed(run, v=None), "fr", share))
    assert found.cycles == ()
    assert found.locked == ()


def test_locked_wheel():
    log = made_run(stop())
    locked = np.where(log.time > 3.0, 0.0, log["omega_rl"])
    assert slip_of(changed(log, omega_rl=locked)).locked == ("rl",)


@pytest.mark.parametrize("pressure", [ramp(), stop()])
def test_usual_braking_is_neither(pressure):
    found = slip_of(made_run(pressure))
    assert found.cycles == ()
    assert found.locked == ()
