"""A ramp in a bend of the independent plant, against a straight coast log."""

from dataclasses import replace

import pytest

from calib.base.names import G
from calib.plausibility.evidence import Evidence
from calib.plausibility.forces import bend
from calib.run.run import Run
from tests.support.made_runs import changed
from tests.support.plant import as_log, drive
from tests.support.reference_car import CAR, REAL, noisy, ramp
from tests.support.refusals import broken


def unlike(log):
    """Return the log with right wheels 0.3 % larger than the left ones: they turn slower."""
    return changed(log, omega_fr=log["omega_fr"] / 1.003, omega_rr=log["omega_rr"] / 1.003)


COAST = unlike(as_log(drive(REAL, lambda t: 0.0, 32.0, duration=6.0), "coast"))


def warnings_on(log, straight=(COAST,)):
    runs = [Run(straight_log, CAR) for straight_log in straight]
    return broken([bend], Evidence(Run(log, CAR), straight=runs))


@pytest.mark.parametrize("radius", [400.0, -250.0])
def test_a_bend_is_named_with_its_lateral_acceleration(radius):
    """v^2/R at the mean square of v, as long as the car is not braked hard."""
    log = ramp(replace(REAL, curvature=lambda t: 1.0 / radius))
    (warning,) = warnings_on(unlike(noisy(log, 1)))
    assert warning.code == "bend"
    speed = log["v"][log["a_x"] > -0.1 * G]
    assert warning.measured == pytest.approx((speed**2).mean() / radius, rel=0.1)


def test_unlike_wheels_on_a_straight_road_are_not_a_bend():
    assert warnings_on(unlike(noisy(ramp(REAL), 1))) == []


def test_without_a_straight_run_no_bend_is_named():
    log = unlike(noisy(ramp(replace(REAL, curvature=lambda t: 1.0 / 250.0)), 1))
    assert warnings_on(log, ()) == []
