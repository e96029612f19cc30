"""Events and lead-in of runs whose pressure is given in closed form."""

import numpy as np
import pytest

from calib.base.names import G
from calib.run.driving_record import brake_events, driving_record
from tests.support.made_runs import BAR_PER_G, changed, made_run, ramp, stop


def test_ramp_is_one_event():
    driving = driving_record(made_run(ramp(start=1.5, rate=6.0, top=40.0), duration=7.0))
    (event,) = brake_events(driving)
    assert event.start == pytest.approx(1.5 + 1.5 / 6.0, abs=0.05)  # 1.5 bar are reached then
    assert event.pressure == pytest.approx(33.0e5, rel=0.02)
    assert event.z_high == pytest.approx(33.0 / BAR_PER_G, rel=0.02)
    assert event.speed_start == pytest.approx(30.0, abs=0.1)
    assert event.rise == pytest.approx(0.9 * (7.0 - 1.75), rel=0.05)
    assert event.rise_z == pytest.approx(0.9 * (33.0 - 1.5) / BAR_PER_G, rel=0.05)


def test_step_with_a_long_hold_does_not_rise_for_long():
    (event,) = brake_events(driving_record(made_run(stop())))
    assert event.rise < 0.3
    assert event.braking > 5.0


def test_braking_counts_only_above_walking_pace():
    log = made_run(stop(start=1.0, level=35.0), speed=10.0)
    (event,) = brake_events(driving_record(log))
    assert event.braking == pytest.approx(7.0 / (0.5 * G), abs=0.1)  # from 10 to 3 m/s with 0.5 g


def test_lead_in_ends_before_the_brake():
    driving = driving_record(made_run(stop(start=2.0)))
    assert driving.time[driving.lead_in][-1] == pytest.approx(1.9, abs=0.06)


def test_no_braking_is_all_lead_in():
    driving = driving_record(made_run(lambda t: 0.0 * t))
    assert driving.lead_in.all()
    assert brake_events(driving) == ()


def test_short_touch_is_no_event_and_short_release_does_not_end_one():
    def pressure(t):
        touch = (t > 1.0) & (t < 1.15)
        held = (t > 2.0) & (t < 5.0) & ~((t > 3.0) & (t < 3.1))
        return 20.0 * (touch | held)

    (event,) = brake_events(driving_record(made_run(pressure)))
    assert event.start == pytest.approx(2.0, abs=0.06)
    assert event.end == pytest.approx(5.0, abs=0.06)


def test_without_pressure_the_deceleration_tells():
    log = changed(made_run(stop(start=2.0)), p_mc=None)
    (event,) = brake_events(driving_record(log))
    assert event.pressure is None
    assert event.start == pytest.approx(2.0, abs=0.06)


@pytest.mark.parametrize("rate", [40.0, 1000.0])
def test_rate_does_not_matter(rate):
    usual = brake_events(driving_record(made_run(ramp())))[0]
    other = brake_events(driving_record(made_run(ramp(), rate=rate)))[0]
    assert other.start == pytest.approx(usual.start, abs=0.06)
    assert other.rise == pytest.approx(usual.rise, rel=0.05)
    assert other.rise_z == pytest.approx(usual.rise_z, rel=0.05)


def test_driven_lead_in_is_not_taken_for_rolling():
    log = made_run(stop(start=4.0))
    gas = np.where(log.time < 2.0, 0.3 * G, 0.0)
    driving = driving_record(changed(log, a_x=log["a_x"] + gas))
    assert not driving.unbraked[driving.time < 1.9].any()
    assert driving.unbraked[(driving.time > 2.1) & (driving.time < 3.8)].all()
