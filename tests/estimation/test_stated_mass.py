"""A car with 20 % more mass than in its file: intervals hold the truth only if that is stated."""

from dataclasses import replace

import numpy as np

from calib.estimation.estimator import estimate
from calib.fitting.fit import fit
from tests.support.reference_car import CAR, REAL, covered, noisy, ramp, stop, with_pads

LOADED = replace(REAL, mass_scale=1.2)
KERB = replace(CAR, mass_tolerance=0.03)
PADS = (0.34, 0.30)


def test_intervals_hold_the_truth_if_the_mass_is_stated_and_else_not():
    """With a table from a ramp with the mass of the file."""
    table, log = fit(KERB, [noisy(ramp(REAL), 1)]), noisy(stop(with_pads(LOADED, *PADS), 35e5), 3)
    since = [mu / CAR.front.pad_friction for mu in PADS]
    with_mass, without_mass = estimate(table, log, mass=1.2 * CAR.mass), estimate(table, log)
    assert all(np.mean(e.valid[e.braked]) > 0.8 for e in (with_mass, without_mass))
    assert min(*covered(with_mass, *PADS), *covered(with_mass, *since, "change")) > 0.95
    assert max(covered(without_mass, *PADS)[0], covered(without_mass, *since, "change")[0]) < 0.2


def test_the_mass_of_the_file_stated_again_moves_nothing():
    table = fit(CAR, [noisy(ramp(REAL), 1)])
    log = noisy(stop(with_pads(REAL, *PADS), 35e5), 3)
    once, twice = estimate(table, log), estimate(table, log, mass=CAR.mass)
    assert np.array_equal(once.best.pads_f.value, twice.best.pads_f.value, equal_nan=True)
    assert np.array_equal(once.best.pads_f.upper, twice.best.pads_f.upper, equal_nan=True)


def test_a_ramp_with_a_stated_mass_gives_the_pads_and_keeps_the_vehicle():
    log = noisy(ramp(LOADED), 2)
    with_mass, without_mass = fit(KERB, [log], mass=1.2 * CAR.mass), fit(KERB, [log])
    true = CAR.front.pad_friction
    low, high = with_mass.calibration.pad_friction_f.ci95
    assert low < true < high
    assert without_mass.calibration.pad_friction_f.ci95[1] < true
    assert with_mass.calibration.pad_scale.sigma < 0.02 < without_mass.calibration.pad_scale.sigma
    assert with_mass.vehicle == without_mass.vehicle == KERB
    assert any("2092.8 kg" in remark for remark in with_mass.remarks)
    assert not any("kg" in remark for remark in without_mass.remarks)
