"""What is warned about, by numbers set by hand and by a plant with one thing wrong."""

import math
from dataclasses import replace

import numpy as np
import pytest

from calib.estimation.estimator import estimate
from calib.estimation.results import to_dict
from calib.estimation.validate import validate
from calib.estimation.warnings import warnings_of
from tests.support.plant import as_log, drive
from tests.support.reference_car import CAR, REAL, misread, noisy, stop, with_pads, without
from tests.support.tables import stored_as


def codes(estimate):
    return [warning.code for warning in warnings_of(estimate)]


# On the plant


@pytest.fixture(scope="module")
def clean():
    return stop(REAL)


def test_a_clean_stop_is_not_warned_about(fitted, clean):
    log = noisy(clean, 0)
    assert codes(estimate(fitted, log)) == []


@pytest.mark.parametrize(
    ("scale", "offset", "code", "within"),
    [
        (0.92, 0.0, "a_x_scale", 0.025),
        (1.08, 0.0, "a_x_scale", 0.025),
        (1.0, 0.4, "a_x_offset", 0.1),
    ],
)
def test_a_wrong_a_x_is_named_and_measured(fitted, clean, scale, offset, code, within):
    log = misread(noisy(clean, 0), scale, offset)
    warnings = warnings_of(estimate(fitted, log))
    (warning,) = [warning for warning in warnings if warning.code == code]
    assert warning.measured == pytest.approx(scale - 1.0 + offset, abs=within)


@pytest.mark.parametrize(("axle", "delay"), [("f", 0.05), ("r", 0.04)])
def test_wheel_speeds_of_an_axle_that_are_late_are_named_first(fitted, clean, axle, delay):
    log = noisy(clean, 1)
    wheels = [f"omega_{axle}{side}" for side in "lr"]
    late = {w: np.interp(log.time - delay, log.time, log[w]) for w in wheels}
    first, *_ = warnings_of(estimate(fitted, replace(log, channels={**log.channels, **late})))
    assert first.code == "wheels_late"
    assert first.measured == pytest.approx(delay, abs=0.01)


def test_pads_wet_on_one_axle_are_named(fitted):
    log = noisy(stop(with_pads(REAL, 0.22, 0.38)), 3)
    warnings = warnings_of(estimate(fitted, log))
    (warning,) = [warning for warning in warnings if warning.code == "pads_changed_apart"]
    assert warning.measured == pytest.approx(0.22 / 0.38 - 1.0, rel=0.3)


def test_a_load_that_nobody_stated_is_named_and_measured(fitted):
    """The same pads under 1.12 times the mass seem weaker by 1/1.12; with --mass they do not."""
    log = noisy(stop(replace(REAL, mass_scale=1.12)), 0)
    (warning,) = warnings_of(estimate(fitted, log))
    assert warning.code == "level_changed"
    assert warning.measured == pytest.approx(1.0 / 1.12 - 1.0, abs=0.02)
    assert codes(estimate(fitted, log, mass=1.12 * CAR.mass)) == []


def with_passengers(mass):
    """The plant with people on all seats, most of them behind the middle [kg]."""
    total = CAR.mass + mass
    front = (CAR.mass * CAR.cg_to_front_axle + mass * 0.62 * CAR.wheelbase) / total
    rear = CAR.wheelbase - front
    car = replace(CAR, mass=total, cg_to_front_axle=front, cg_to_rear_axle=rear)
    return replace(REAL, vehicle=car)


@pytest.mark.parametrize(("pressure", "logged"), [(18e5, "with v"), (30e5, "without v")])
def test_passengers_in_the_stops_only_are_named_first(fitted, pressure, logged):
    """Most of their weight is on the rear axle: its pads seem to have lost more."""
    log = noisy(stop(with_passengers(225.0), pressure), 7)
    log = log if logged == "with v" else without(log, "v")
    warnings = warnings_of(estimate(fitted, log))
    assert "level_changed" in [warning.code for warning in warnings]
    for warning in warnings:
        assert "load" in warning.causes[0]
        assert "--mass" in warning.do


def test_a_strong_motor_that_is_not_logged_leaves_nothing_valid(fitted):
    """200 N m a wheel at the rear, with the pedal: force without pressure, and no answer."""

    def pedal(t):
        return 35e5 * min(max((t - 1.5) / 0.3, 0.0), 1.0) * (0.9 + 0.1 * math.sin(2.0 * t))

    def motor(t):
        return 0.0, -400.0 * min(max((t - 1.5) / 0.1, 0.0), 1.0)

    run = as_log(drive(replace(REAL, motor=motor), pedal, 27.0, duration=9.0, stop_speed=1.5), "m")
    silent = replace(run, channels={k: x for k, x in run.channels.items() if k[:2] != "T_"})
    (result,) = validate(fitted, [noisy(silent, 1)])
    (warning,) = [x for x in result.warnings if x.code == "unexplained_braking_force"]
    force = 400.0 / CAR.rear.rolling_radius
    usual = float(np.median(-silent["a_x"][600:1200])) * CAR.mass
    assert warning.measured == pytest.approx(force / usual, rel=0.35)
    assert not result.passed
    assert result.figures["valid_share"] == 0.0
    (logged,) = validate(fitted, [noisy(run, 1)])  # with T_drive
    assert logged.figures["valid_share"] > 0.6
    assert not [x for x in logged.warnings if x.code == "unexplained_braking_force"]


def test_the_summary_holds_the_warnings_with_their_log(fitted, clean):
    log = replace(misread(noisy(clean, 0), 1.08), name="wrong")
    results = validate(fitted, [replace(noisy(clean, 1), name="right"), log], CAR)
    warnings = to_dict(stored_as("sedan@1"), results)["warnings"]
    assert {x["log"] for x in warnings} == {"wrong"}
    (warning,) = (x for x in warnings if x["code"] == "a_x_scale")
    assert set(warning) == {"code", "log", "measured", "expected", "causes", "do"}
    assert list(warning["expected"]) == [-0.03, 0.03]
