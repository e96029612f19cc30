"""What is said of an accelerometer, by numbers set by hand."""

from types import SimpleNamespace

import pytest

from calib.base.names import G
from calib.car.beliefs import LOG
from calib.plausibility.evidence import Evidence
from calib.plausibility.forces import accelerometer
from calib.plausibility.wheels import a_x_by_wheels, v_scale
from calib.run.accelerometer import Accelerometer
from calib.run.run import Run
from tests.support.reference_car import CAR, REAL, misread, noisy, stop, without
from tests.support.refusals import broken


def sensor(**values):
    """An accelerometer that is right, but for ``values``; sigma 0.1 % and 0.0005 g."""
    names = ("scale", "bias", "covariance", "drag", "walk_probability", "disagreement")
    right = dict.fromkeys(names, 0.0) | {"variance_scale": 1e-6, "variance_bias": 2.5e-7}
    return Accelerometer(**right | values)


def warned(sensor, other_scale=0.0, noise=0.002):
    """Warnings on a sensor in a run; ``noise`` [g] is that of means of a_x over 1 s."""
    run = SimpleNamespace(other_scale=other_scale, noise=SimpleNamespace(z=noise, v=0.0))
    return broken((v_scale, accelerometer), Evidence(run, sensor))


def codes(sensor):
    return [warning.code for warning in warned(sensor)]


def test_a_sensor_that_is_right_is_not_warned_about():
    assert codes(sensor()) == []


@pytest.mark.parametrize(
    ("wrong", "code", "measured"),
    [
        ({"scale": 0.04}, "a_x_scale", 0.04 / 0.96),
        ({"scale": -0.04}, "a_x_scale", -0.04 / 1.04),
        ({"bias": 0.03}, "a_x_offset", -0.03 * G),
        ({"bias": -0.03}, "a_x_offset", 0.03 * G),
        ({"drag": 0.03}, "unexplained_drag", 0.03 * G),
        ({"walk_probability": 0.9, "disagreement": 0.03}, "a_x_against_v", 0.03),
    ],
)
def test_a_wrong_sensor_is_named_with_what_was_measured(wrong, code, measured):
    """a_x is -g z: an offset of z has the other sign."""
    (warning,) = warned(sensor(**wrong))
    assert warning.code == code
    assert warning.measured == pytest.approx(measured)
    assert not warning.expected[0] <= warning.measured <= warning.expected[1]
    assert warning.causes
    assert warning.do


def test_a_scale_that_no_sensor_has_is_the_only_warning():
    (warning,) = warned(sensor(scale=0.06), 1.0 / 6.0)
    assert (warning.code, warning.measured) == ("v_scale", pytest.approx(0.2))


@pytest.mark.parametrize("gain", [0.85, 1.0, 1.15])
def test_without_v_the_wheels_show_a_gain_of_a_x(gain):
    log = misread(noisy(without(stop(REAL), "v"), 3), gain)
    (error,) = a_x_by_wheels(Evidence(Run(log, CAR)))
    assert error.value + LOG.a_x_scale.mean == pytest.approx(gain - 1.0, abs=2.0 * error.sigma)
    assert error.sigma < 0.03
    assert not [*a_x_by_wheels(Evidence(Run(stop(REAL), CAR)))]


def test_an_uncertain_error_is_not_warned_about():
    assert codes(sensor(scale=0.04, variance_scale=9e-4)) == []
    assert codes(sensor(bias=0.03, variance_bias=1.6e-3)) == []
    assert codes(sensor(walk_probability=0.2, disagreement=0.03)) == []
    assert codes(sensor(walk_probability=0.9, disagreement=0.005)) == []
    assert not warned(sensor(walk_probability=0.9, disagreement=0.02), noise=0.008)
