"""A file that a run contradicts is refused with the entry that is wrong."""

import math
from dataclasses import replace

import pytest

from calib.base.errors import VehicleError
from calib.fitting.fit import fit
from calib.plausibility.pads import likely_entry, require_possible_pads
from calib.table.table import Calibration, Value
from tests.support.reference_car import CAR, REAL, noisy, ramp


def with_entry(axle, name, factor):
    old = getattr(CAR, axle)
    return replace(CAR, **{axle: replace(old, **{name: factor * getattr(old, name)})})


def pads(vehicle, torque_f=1.0, torque_r=1.0, sigma=0.05):
    """What a fit makes of the torques of `CAR` times these factors, with another file."""
    f, r = (
        factor * true.pad_friction * true.torque_gain / axle.torque_gain
        for factor, true, axle in (
            (torque_f, CAR.front, vehicle.front),
            (torque_r, CAR.rear, vehicle.rear),
        )
    )
    rho = math.log(f / vehicle.front.pad_friction * vehicle.rear.pad_friction / r)
    return Calibration(
        Value(1.0, 0.02), Value(rho, sigma), Value(f, 0.01), Value(r, 0.02), Value(25.0, 2.0)
    )


EXCHANGED = replace(CAR, front=CAR.rear, rear=CAR.front)


@pytest.mark.parametrize("axle", ["front", "rear"])
@pytest.mark.parametrize("factor", [0.6, 1.8])
def test_the_area_of_another_caliper(axle, factor):
    file = with_entry(axle, "piston_area", factor)
    best = likely_entry(file, pads(file, 1.05, 0.95))
    right = 1e4 * getattr(CAR, axle).piston_area
    assert best.startswith(f"{axle}.piston_area: ")
    assert float(best.split()[1]) == pytest.approx(right, rel=0.15)
    with pytest.raises(VehicleError):
        require_possible_pads(file, pads(file), ())


def test_exchanged_blocks():
    best = likely_entry(EXCHANGED, pads(EXCHANGED, 1.05, 0.95))
    assert best == "[front] and [rear] are exchanged"


@pytest.mark.parametrize(("f", "r", "sigma"), [(1.1, 0.9, 0.05), (1.4, 0.8, 0.2), (1.8, 1.8, 0.1)])
def test_pads_that_may_be_are_not_refused(f, r, sigma):
    require_possible_pads(CAR, pads(CAR, f, r, sigma), ())


@pytest.mark.parametrize("file", [EXCHANGED, with_entry("rear", "piston_area", 3.0)])
def test_a_fit_with_such_a_file_ends_with_3(file):
    with pytest.raises(VehicleError) as refused:
        fit(file, [noisy(ramp(REAL), 1)])
    assert refused.value.exit_code == 3
