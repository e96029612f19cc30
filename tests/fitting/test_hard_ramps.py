"""Ramps near the peak of the tyres, and of axles that brake alike, where eta says little."""

from dataclasses import replace

import numpy as np

from calib.car.vehicle import Axle
from calib.fitting.fit import fit
from tests.support.plant import Plant, as_log, drive, magic, per_pascal
from tests.support.reference_car import CAR, REAL, noisy, ramp

TRUE = CAR.front.pad_friction, CAR.rear.pad_friction


def pads(table):
    return table.calibration.pad_friction_f, table.calibration.pad_friction_r


def test_on_a_wet_road_the_pads_are_those_of_a_dry_one():
    """A ramp to 0.53 g, at up to 0.9 of the tyres' peak; brakes are 20 to 30 ms late."""
    plant = replace(REAL, tyre=magic(25.0, 0.58), hydraulic_lag=0.03)
    table = fit(CAR, [noisy(ramp(plant, 4.8e5), 0)])
    for pad, true in zip(pads(table), TRUE, strict=True):
        assert pad.ci95[0] < true < pad.ci95[1]


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
    plant = replace(REAL, vehicle=ESTATE, tyre=magic(18.4, 0.92, 1.57, curvature=0.33))
    table = fit(ESTATE, [noisy(ramp(plant, 6.6e5), 1)])
    ratio = table.calibration.pad_log_ratio
    assert abs(ratio.value) < 0.1
    assert abs(ratio.value) < 1.96 * ratio.sigma
    assert "pad_ratio" not in [warning.code for warning in table.warnings]


PADS = 0.42
SPORTS = replace(
    CAR,
    name="sports-car",
    mass=1500.0,
    cg_to_front_axle=1.42,
    cg_to_rear_axle=1.05,
    cg_height=0.46,
    front=Axle(0.330, 1.1, 30e-4, 0.150, 2, PADS),
    rear=Axle(0.338, 1.5, 16e-4, 0.140, 2, PADS),
)


def test_a_car_near_ideal_balance_has_the_pads_that_it_has():
    seed = 5
    rng = np.random.default_rng(seed)
    tyre = magic(
        float(rng.uniform(18.0, 30.0)),
        float(rng.uniform(0.8, 1.0)),
        curvature=float(rng.uniform(-0.5, 0.3)),
    )
    plant = Plant(SPORTS, tyre=tyre, drag_area=0.66, rolling_resistance=0.01)
    slope = 0.5 / per_pascal(SPORTS) / 6.5  # 0.5 g within 6.5 s
    run = drive(plant, lambda t: slope * max(t - 1.5, 0.0), 33.0, duration=8.0, stop_speed=6.0)
    table = fit(SPORTS, [noisy(as_log(run, "ramp"), seed)])
    for pad in pads(table):
        assert abs(pad.value - PADS) < 2.5 * pad.sigma
