"""Events of runs whose times are known."""

import pytest

from calib.run.driving_record import BITES, BRAKING, LEAD_IN, STANDSTILL, run_events
from tests.support.made_runs import changed, made_run, stop


def test_the_events_of_a_stop_that_is_released():
    lead_in, bite, braking = run_events(made_run(stop(start=1.5, end=4.0), noise=0.0))
    assert [e.kind for e in (lead_in, bite, braking)] == [LEAD_IN, BITES, BRAKING]
    assert lead_in.start == 0.0
    assert lead_in.end == pytest.approx(1.4, abs=0.15)
    assert bite.start == bite.end == braking.start == pytest.approx(1.5, abs=0.1)
    assert braking.end == pytest.approx(4.0, abs=0.4)


def test_a_car_that_stands_stands():
    events = run_events(made_run(stop(), speed=20.0, duration=12.0, noise=0.0))
    assert events[-1].kind == STANDSTILL
    assert events[-1].end == pytest.approx(12.0, abs=0.1)


def test_without_wheel_speeds_nothing_is_known():
    assert run_events(changed(made_run(stop()), omega_fl=None)) == ()
