"""Ramps of a car whose axles brake nearly alike: a fit must not end far from all that tyres are.

There eta says little. Were a prior less than quadratic far out, as data are for outliers, pads at a
third of their friction and tyres of three times the stiffness would be a minimum of their own.
"""

from dataclasses import replace

import numpy as np
import pytest

from calib.car.vehicle import Axle
from calib.fitting.fit import fit
from calib.model.parameters import PRIORS
from calib.model.ramp import sigma_eta
from tests.studies.clean_cars import logs, plant
from tests.support.plant import Plant, as_log, drive, magic, per_pascal
from tests.support.reference_car import CAR, noisy, prepared

PADS = 0.42


def with_brake(axle: Axle, radius: float, inertia: float, area: float, disc: float) -> Axle:
    """An axle with other wheels [m], [kg m^2] and another brake [m^2], [m]."""
    return replace(
        axle,
        rolling_radius=radius,
        wheel_inertia=inertia,
        piston_area=area,
        effective_radius=disc,
        pad_friction=PADS,
    )


SPORTS = replace(
    CAR,
    name="sports-car",
    mass=1500.0,
    cg_to_front_axle=1.42,
    cg_to_rear_axle=1.05,
    cg_height=0.46,
    front=with_brake(CAR.front, 0.330, 1.1, 30e-4, 0.150),
    rear=with_brake(CAR.rear, 0.338, 1.5, 16e-4, 0.140),
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
    for found in (table.calibration.pad_friction_f, table.calibration.pad_friction_r):
        assert abs(found.value - PADS) < 2.5 * found.sigma
    for name, prior in PRIORS._asdict().items():
        assert abs(table.posterior.value(name) - prior.mean) < 3.0 * prior.sigma


def test_a_top_that_bends_more_than_a_cubic_leads_to_no_far_minimum():
    """Started from afar, this one ended with pads of 0.3 of their ratio, and was refused."""
    made = plant("rear-engined", np.random.default_rng([2, 1, 0]))
    table = fit(made.vehicle, logs(made, 100))
    pads = table.calibration.pad_friction_f, table.calibration.pad_friction_r
    for found, true in zip(pads, made.pads(0.0), strict=True):
        assert found.value == pytest.approx(true, rel=0.08)
        assert found.ci95[0] < true < found.ci95[1]


def test_the_sizes_of_the_wheels_have_no_say_in_what_the_brakes_do_to_eta():
    run = drive(Plant(SPORTS), lambda t: 8e5 * max(t - 1.5, 0.0), 33.0, duration=5.0)
    log = noisy(as_log(run, "ramp"), 0)
    one = prepared(log, SPORTS)
    other = replace(one, blocks=replace(one.blocks, omega_r=1.1 * one.blocks.omega_r))
    seen = [sigma_eta(each, each.since_rolling(each.blocks.eta)) for each in (one, other)]
    assert seen[1][one.use] == pytest.approx(seen[0][one.use], rel=0.11)
