"""The top of a ramp, where the tyres are near their peak, is believed only as far as it agrees."""

from dataclasses import replace

import pytest

from calib.fitting.fit import fit
from tests.support.plant import magic
from tests.support.reference_car import CAR, REAL, noisy, ramp

TRUE = CAR.front.pad_friction, CAR.rear.pad_friction


def left_out(table):
    return [remark for remark in table.remarks if "left out above" in remark]


def pads(table):
    return table.calibration.pad_friction_f, table.calibration.pad_friction_r


def test_on_a_wet_road_the_pads_are_those_of_a_dry_one():
    """A ramp to 0.53 g, at up to 0.9 of the tyres' peak; brakes are 20 to 30 ms late."""
    plant = replace(REAL, tyre=magic(25.0, 0.58), hydraulic_lag=0.03)
    table = fit(CAR, [noisy(ramp(plant, 4.8e5), 0)])
    for found, true in zip(pads(table), TRUE, strict=True):
        assert found.ci95[0] < true < found.ci95[1]


def test_what_is_not_believed_is_told_and_not_in_the_table(fitted):
    assert left_out(fitted) == []  # a dry road
    table = fit(CAR, [noisy(ramp(replace(REAL, tyre=magic(25.0, 0.58)), 4.8e5), 0)])
    assert len(left_out(table)) == 1
    assert table.quality["deceleration_max"] == pytest.approx(0.43, abs=0.005)
