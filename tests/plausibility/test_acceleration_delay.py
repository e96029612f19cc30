"""The delay of a_x against v and the wheel speeds, which the plant made without one."""

import numpy as np
import pytest

from calib.plausibility.acceleration_delay import acceleration_delay
from calib.plausibility.evidence import Evidence
from calib.plausibility.forces import a_x_late
from calib.run.run import Run
from tests.support.made_runs import changed
from tests.support.plant import as_log, drive
from tests.support.reference_car import CAR, REAL, noisy, ramp, stop, without
from tests.support.refusals import broken

LOGS = {"ramp": noisy(ramp(REAL, 7e5), 5), "stop": noisy(stop(REAL), 6)}


def delayed(log, delay):
    return changed(log, a_x=np.interp(log.time - delay, log.time, log["a_x"]))


@pytest.mark.parametrize("absent", [(), ("v",)])
@pytest.mark.parametrize("delay", [0.0, 0.25])
@pytest.mark.parametrize("kind", LOGS)
def test_a_delay_of_a_x_is_measured(kind, delay, absent):
    log = without(delayed(LOGS[kind], delay), *absent)
    measured = acceleration_delay(Run(log, CAR))
    assert measured.value == pytest.approx(delay, abs=0.06)
    assert measured.against == ("the wheel speeds" if absent else "v")
    codes = [warning.code for warning in broken((a_x_late,), Evidence(Run(log, CAR)))]
    assert codes == (["a_x_late"] if delay else [])


def test_a_log_without_braking_shows_no_delay():
    coast = without(as_log(drive(REAL, lambda t: 0.0, 30.0, duration=8.0), "coast"), "v")
    for a_x in (coast["a_x"], np.where(coast.time > 4.0, -1.6, coast["a_x"])):
        assert acceleration_delay(Run(changed(coast, a_x=a_x), CAR)) is None
