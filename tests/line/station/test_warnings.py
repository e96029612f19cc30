"""Warnings of ramp and stops of one car together."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from calib.estimation.validate import validate
from calib.fitting.fit import fit
from calib.line.station.station import car_warnings, force_over_ramp
from calib.plausibility.check import check
from tests.support.reference_car import CAR, REAL, noisy, ramp, stop


@pytest.fixture(scope="module")
def table():
    return fit(CAR, [noisy(ramp(REAL), 1)])


def result_with(front, rear):
    return SimpleNamespace(figures={"pad_friction_f": front, "pad_friction_r": rear})


def test_the_level_is_that_of_the_whole_car(table):
    cal = table.calibration
    f, r = cal.pad_friction_f.value, cal.pad_friction_r.value
    assert force_over_ramp(table, result_with(f, r)) == pytest.approx(1.0)
    assert force_over_ramp(table, result_with(0.9 * f, 0.9 * r)) == pytest.approx(0.9)
    front_only = force_over_ramp(table, result_with(0.9 * f, r))
    share = (1.0 - front_only) / 0.1
    assert 0.65 < share < 0.8  # the front axle makes three quarters of the brake force
    assert force_over_ramp(table, result_with(None, r)) is None


@pytest.mark.parametrize(("mass", "expected"), [(1.0, []), (1.15, ["level_changed"])])
def test_a_load_in_the_stops_is_named(table, mass, expected):
    plant = replace(REAL, mass_scale=mass)
    results = validate(table, [noisy(stop(plant, p, f"stop_{p}"), 3) for p in (15e5, 30e5)])
    warnings = list(car_warnings(table, results))
    assert [warning.code for warning in warnings] == expected
    for warning in warnings:
        assert warning.measured == pytest.approx(1.0 / mass - 1.0, abs=0.02)


def test_radii_that_differ_as_the_file_says_are_no_warning():
    """Wider rear tyres: eta of rolling wheels is R_f/R_r, 2 % below 1."""
    wide = replace(CAR, rear=replace(CAR.rear, rolling_radius=1.02 * CAR.rear.rolling_radius))
    log = noisy(ramp(REAL), 5)
    turned = {w: log[w] / 1.02 if w in ("omega_rl", "omega_rr") else log[w] for w in log.channels}
    log = replace(log, channels=turned)
    for vehicle, expected in ((None, True), (wide, False), (CAR, True)):
        warnings = check(log, vehicle=vehicle).warnings
        assert ("eta_zero" in [warning.code for warning in warnings]) == expected
