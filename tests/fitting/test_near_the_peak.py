"""A ramp that goes near to the peak of the tyres, where no cubic follows them."""

from dataclasses import replace

import numpy as np
import pytest

from calib.car.vehicle import Axle
from calib.fitting.fit import fit
from tests.support.plant import magic
from tests.support.reference_car import CAR, REAL, noisy, one_axle, prepared, ramp

PEAK, SHAPE, STIFFNESS = 0.92, 1.65, 25.0


ESTATE = replace(
    CAR,
    mass=1610.0,
    cg_to_front_axle=1.31,
    cg_to_rear_axle=1.49,
    cg_height=0.55,
    front=Axle(0.327, 1.25, 28.3e-4, 0.131, 2, 0.4),
    rear=Axle(0.327, 1.15, 11.3e-4, 0.126, 2, 0.4),
)
"""Front brakes that take 0.72 of the force: at 0.68 g the front tyres are at 0.8 of their peak."""


def test_pads_as_declared_are_not_taken_for_others_on_a_hard_ramp():
    plant = replace(REAL, vehicle=ESTATE, tyre=magic(18.4, PEAK, 1.57, curvature=0.33))
    found = fit(ESTATE, [noisy(ramp(plant, 6.6e5), 1)])
    ratio = found.calibration.pad_log_ratio
    assert abs(ratio.value) < 0.1
    assert abs(ratio.value) < 1.96 * ratio.sigma
    assert "pad_ratio" not in [one.code for one in found.warnings]


def test_the_model_error_grows_near_the_peak_where_both_axles_brake():
    def errors(log):
        run = prepared(log)
        return np.broadcast_to(run.model_error, run.blocks.end.shape)[run.use]

    usual = errors(ramp(REAL, 4e5))  # to 0.45 g
    hard = errors(ramp(REAL, 7e5))  # to 0.75 g
    assert usual.max() < 0.015
    assert hard[0] == pytest.approx(usual[0])
    assert hard.max() > 0.05
    assert np.ptp(errors(one_axle(REAL, "f"))) == 0.0
