"""What is said of pads and tyres of a calibration, and of a file that a run contradicts."""

import math
from dataclasses import replace

import pytest

from calib.base.errors import VehicleError
from calib.base.warning import rule_warnings
from calib.fitting.fit import fit
from calib.plausibility.pads import (
    calibration_figures,
    change_figures,
    require_possible_pads,
)
from calib.plausibility.rules import VALIDATE
from calib.table.table import Calibration, Value
from tests.support.reference_car import CAR, REAL, noisy, ramp


def calibration(front=1.0, rear=1.0, sigma=0.02, stiffness=25.0):
    """Pads as multiples of the file's."""
    f, r = front * CAR.front.pad_friction, rear * CAR.rear.pad_friction
    rho = math.log(front / rear)
    return Calibration(
        Value(math.sqrt(front * rear), 0.02),
        Value(rho, sigma),
        Value(f, 0.01),
        Value(r, 0.01),
        Value(stiffness, 0.1 * stiffness),
    )


def codes(pads):
    return [warning.code for warning in rule_warnings("car", calibration_figures(CAR, pads))]


@pytest.mark.parametrize(
    ("pads", "expected"),
    [
        (calibration(), []),
        (calibration(0.89, 0.89), []),
        (calibration(1.11, 1.11), []),
        (calibration(0.85, 0.85), ["pads_off_file"]),
        (calibration(1.15, 1.15), ["pads_off_file"]),
        (calibration(0.75, 0.75), ["pads_off_file_f", "pads_off_file_r"]),
        (calibration(1.3, 1.3), ["pads_off_file_f", "pads_off_file_r"]),
        (calibration(1.1, 0.9), ["pad_ratio"]),
        (calibration(1.1, 0.9, sigma=0.12), []),
    ],
)
def test_pads_far_from_the_file_are_named(pads, expected):
    assert codes(pads) == expected


@pytest.mark.parametrize(("stiffness", "named"), [(2.0, True), (10.0, False), (200.0, True)])
def test_a_tyre_that_no_car_has(stiffness, named):
    assert ("tyre_stiffness" in codes(calibration(stiffness=stiffness))) == named


@pytest.mark.parametrize("factor", [0.1, 10.0])
def test_a_friction_that_no_pad_has_is_refused(factor):
    """A pressure in bar that is labelled MPa, and the other way round."""
    with pytest.raises(VehicleError) as refused:
        require_possible_pads(CAR, calibration(factor, factor), ())
    assert "scale of p_mc" in str(refused.value)


@pytest.mark.parametrize(("apart", "sigma", "named"), [(0.2, 0.05, 1), (0.2, 0.2, 0), (0.04, 0, 0)])
def test_pads_that_changed_apart(apart, sigma, named):
    warnings = rule_warnings("log", change_figures((0.0, 0.02), (apart, sigma)))
    assert len(warnings) == named
    assert all(warning.measured == pytest.approx(math.expm1(apart)) for warning in warnings)


@pytest.mark.parametrize(
    ("level", "sigma", "named"),
    [(-0.1, 0.02, 1), (0.1, 0.02, 1), (-0.1, 0.06, 0), (-0.04, 0.0, 0), (-0.6, 0.02, 0)],
    ids=["heavier", "lighter", "unsure", "as usual", "soaked pads"],
)
def test_brakes_that_another_load_or_sensor_makes_seem_changed(level, sigma, named):
    warnings = rule_warnings("log", change_figures((level, sigma), (0.0, 0.02)), VALIDATE)
    assert len(warnings) == named
    for warning in warnings:
        assert warning.measured == pytest.approx(math.expm1(level))
        assert warning.causes[0].startswith("more load" if level < 0.0 else "less load")
        assert "--mass" in warning.do


EXCHANGED = replace(CAR, front=CAR.rear, rear=CAR.front)
LARGE = replace(CAR, rear=replace(CAR.rear, piston_area=3.0 * CAR.rear.piston_area))


@pytest.mark.parametrize(("f", "r", "sigma"), [(1.1, 0.9, 0.05), (1.4, 0.8, 0.2), (1.8, 1.8, 0.1)])
def test_pads_that_may_be_are_not_refused(f, r, sigma):
    require_possible_pads(CAR, calibration(f, r, sigma), ())


@pytest.mark.parametrize("file", [EXCHANGED, LARGE])
def test_a_fit_with_such_a_file_ends_with_3(file):
    with pytest.raises(VehicleError) as refused:
        fit(file, [noisy(ramp(REAL), 1)])
    assert refused.value.exit_code == 3
