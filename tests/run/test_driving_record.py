"""Events and lead-in of runs whose pressure is given in closed form."""

from dataclasses import replace

import numpy as np
import pytest

from calib.base.names import G
from calib.run.driving_record import brake_events, driving_record
from calib.run.events import BITES, BRAKING, LEAD_IN, STANDSTILL, run_events
from calib.run.wheels import rolling_radius
from tests.support.made_runs import BAR_PER_G, changed, made_run, ramp, stop
from tests.support.reference_car import IDEAL, without
from tests.support.reference_car import stop as plant_stop


def events_of(log):
    return brake_events(driving_record(log))


@pytest.mark.parametrize("rate", [40.0, 200.0, 1000.0])
def test_ramp_is_one_event(rate):
    (event,) = events_of(made_run(ramp(start=1.5, rate=6.0, top=40.0), duration=7.0, rate=rate))
    assert event.start == pytest.approx(1.5 + 1.5 / 6.0, abs=0.06)  # 1.5 bar are reached then
    assert event.pressure == pytest.approx(33.0e5, rel=0.02)
    assert event.z_high == pytest.approx(33.0 / BAR_PER_G, rel=0.02)
    assert event.speed_start == pytest.approx(30.0, abs=0.15)
    assert event.rise_time == pytest.approx(0.9 * (7.0 - 1.75), rel=0.05)
    assert event.rise_z == pytest.approx(0.9 * (33.0 - 1.5) / BAR_PER_G, rel=0.05)


def test_step_with_a_long_hold_does_not_rise_for_long():
    (event,) = events_of(made_run(stop()))
    assert event.rise_time < 0.3
    assert event.braking_time > 5.0


def test_braking_counts_only_above_walking_pace():
    (event,) = events_of(made_run(stop(start=1.0, level=35.0), speed=10.0))
    assert event.braking_time == pytest.approx(7.0 / (0.5 * G), abs=0.1)  # 10 to 3 m/s at 0.5 g


def test_lead_in_ends_before_the_brake_and_is_all_of_a_coast():
    driving = driving_record(made_run(stop(start=2.0)))
    assert driving.time[driving.before_braking][-1] == pytest.approx(1.9, abs=0.06)
    coast = driving_record(made_run(lambda t: 0.0 * t))
    assert coast.before_braking.all()
    assert brake_events(coast) == ()


def test_short_touch_is_no_event_and_short_release_does_not_end_one():
    def pressure(t):
        touch = (t > 1.0) & (t < 1.15)
        pressed = (t > 2.0) & (t < 5.0) & ~((t > 3.0) & (t < 3.1))
        return 20.0 * (touch | pressed)

    (event,) = events_of(made_run(pressure))
    assert (event.start, event.end) == (pytest.approx(2.0, abs=0.06), pytest.approx(5.0, abs=0.06))


def test_without_pressure_the_deceleration_tells():
    (event,) = events_of(changed(made_run(stop(start=2.0)), p_mc=None))
    assert event.pressure is None
    assert event.start == pytest.approx(2.0, abs=0.06)


def test_driven_lead_in_is_not_taken_for_rolling():
    log = made_run(stop(start=4.0))
    gas = np.where(log.time < 2.0, 0.3 * G, 0.0)
    driving = driving_record(changed(log, a_x=log["a_x"] + gas))
    assert not driving.unbraked[driving.time < 1.9].any()
    assert driving.unbraked[(driving.time > 2.1) & (driving.time < 3.8)].all()


def test_the_events_of_a_stop_that_is_released_and_of_one_that_stands():
    lead_in, bite, braking = run_events(made_run(stop(start=1.5, end=4.0), noise=0.0))
    assert [e.kind for e in (lead_in, bite, braking)] == [LEAD_IN, BITES, BRAKING]
    assert (lead_in.start, lead_in.end) == (0.0, pytest.approx(1.4, abs=0.15))
    assert bite.start == bite.end == braking.start == pytest.approx(1.5, abs=0.1)
    assert braking.end == pytest.approx(4.0, abs=0.4)
    last = run_events(made_run(stop(), speed=20.0, duration=12.0, noise=0.0))[-1]
    assert (last.kind, last.end) == (STANDSTILL, pytest.approx(12.0, abs=0.1))
    assert run_events(changed(made_run(stop()), omega_fl=None)) == ()


def test_the_rolling_radius_is_that_of_the_plant():
    # Table I: 0.322 m on both axles; the plant rolls without resistance
    log = plant_stop(IDEAL, duration=3.0)
    assert rolling_radius(log, driving_record(log)) == pytest.approx(0.322, rel=1e-4)
    larger = replace(log, channels=log.channels | {"v": 1.1 * log["v"]})
    assert rolling_radius(larger, driving_record(larger)) == pytest.approx(0.3542, rel=1e-4)
    bare = without(log, "v")
    assert rolling_radius(bare, driving_record(bare)) is None
    braked = replace(log, channels=log.channels | {"p_mc": np.full(log.time.size, 2e6)})
    assert rolling_radius(braked, driving_record(braked)) is None
