"""A ramp in a bend of the independent plant, against a straight coast log."""

from dataclasses import replace

import pytest

from calib.base.names import G
from calib.plausibility.evidence import Evidence
from calib.plausibility.forces import bend
from calib.run.run import Run
from tests.support.plant import as_log, drive
from tests.support.reference_car import CAR, REAL, noisy, ramp
from tests.support.refusals import broken


def unlike(log):
    """Its right wheels 0.3 % larger than the left ones: they turn slower."""
    slower = {name: log[name] / 1.003 for name in ("omega_fr", "omega_rr")}
    return replace(log, channels={**log.channels, **slower})


COAST = unlike(as_log(drive(REAL, lambda t: 0.0, 32.0, duration=6.0), "coast"))


def found(log, straight=(COAST,)):
    runs = [Run(one, CAR) for one in straight]
    return broken([bend], Evidence(Run(log, CAR), straight=runs))


@pytest.mark.parametrize("radius", [400.0, -250.0])
def test_a_bend_is_named_with_its_lateral_acceleration(radius):
    """v^2/R at the mean square of v, as long as the car is not braked hard."""
    log = ramp(replace(REAL, curvature=lambda t: 1.0 / radius))
    (warning,) = found(unlike(noisy(log, 1)))
    assert warning.code == "bend"
    speed = log["v"][log["a_x"] > -0.1 * G]
    assert warning.measured == pytest.approx((speed**2).mean() / radius, rel=0.1)


def test_unlike_wheels_on_a_straight_road_are_not_a_bend():
    assert found(unlike(noisy(ramp(REAL), 1))) == []


def test_without_a_straight_run_nothing_is_said():
    log = unlike(noisy(ramp(replace(REAL, curvature=lambda t: 1.0 / 250.0)), 1))
    assert found(log, ()) == []
