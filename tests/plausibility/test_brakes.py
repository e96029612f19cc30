"""What is said of the pressure and of force without it."""

import numpy as np
import pytest

from calib.plausibility.brakes import pressure_warnings, response_warnings
from calib.signals.axle_signals import signals
from calib.signals.brake_response import BrakeResponse
from tests.support.reference_car import CAR, REAL, noisy, stop


def response(delay=0.0, share=0.0, sigma=0.01):
    return BrakeResponse(1.0, delay, sigma, 5000.0 * share, 5000.0 * sigma, share, sigma)


@pytest.mark.parametrize(
    ("seen", "codes"),
    [
        (response(), []),
        (response(share=0.02), []),
        (response(share=0.06), ["unexplained_braking_force"]),
        (response(share=0.06, sigma=0.03), []),
        (response(share=-0.03), []),
        (response(share=-0.08), ["braking_force_missing"]),
        (response(delay=0.15), ["pressure_lag"]),
        (response(delay=-0.15), ["pressure_lag"]),
        (response(delay=0.15, sigma=0.1), []),
        (None, []),
    ],
)
def test_only_what_is_large_and_sure_is_named(seen, codes):
    assert [one.code for one in response_warnings("log", seen)] == codes


def test_the_side_of_the_delay_decides_who_is_late():
    (after,) = response_warnings("log", response(delay=0.2))
    (before,) = response_warnings("log", response(delay=-0.2))
    assert "hydraulic" in after.causes[0]
    assert before.causes[0] == "the clock of p_mc, late"


@pytest.mark.parametrize("zero", [-3e5, -1e5, 1e5])
def test_the_zero_of_the_pressure_is_measured(zero):
    log = noisy(stop(REAL), 1)
    log.channels["p_mc"] = log["p_mc"] + zero
    (warning,) = pressure_warnings("log", signals(log, CAR))
    assert warning.code == "pressure_zero"
    assert warning.measured == pytest.approx(zero / 1e5, abs=0.1)


def test_a_pressure_sensor_that_is_right():
    log = noisy(stop(REAL), 1)
    assert list(pressure_warnings("log", signals(log, CAR))) == []
    assert np.mean(log["p_mc"][log.time < 1.0]) < 0.3e5
