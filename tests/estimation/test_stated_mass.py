"""A car that weighs 20 % more than its file says: told, the intervals hold; untold, they do not."""

from dataclasses import replace

import numpy as np

from calib.estimation.estimator import estimate
from calib.fitting.fit import fit
from tests.support.reference_car import CAR, REAL, held, noisy, ramp, stop, with_pads

LOADED = replace(REAL, mass_scale=1.2)
KERB = replace(CAR, mass_tolerance=0.03)
PADS = (0.34, 0.30)


def test_told_the_intervals_hold_the_truth_and_untold_they_do_not():
    """With a table from a ramp with the mass of the file."""
    table, log = fit(KERB, [noisy(ramp(REAL), 1)]), noisy(stop(with_pads(LOADED, *PADS), 35e5), 3)
    since = [mu / CAR.front.pad_friction for mu in PADS]
    told, untold = estimate(table, log, mass=1.2 * CAR.mass), estimate(table, log)
    assert all(np.mean(e.valid[e.braked]) > 0.8 for e in (told, untold))
    assert min(*held(told, *PADS), *held(told, *since, "change")) > 0.95
    assert max(held(untold, *PADS)[0], held(untold, *since, "change")[0]) < 0.2


def test_the_mass_of_the_file_stated_again_moves_nothing():
    table = fit(CAR, [noisy(ramp(REAL), 1)])
    log = noisy(stop(with_pads(REAL, *PADS), 35e5), 3)
    once, twice = estimate(table, log), estimate(table, log, mass=CAR.mass)
    assert np.array_equal(once.best.pads_f.value, twice.best.pads_f.value, equal_nan=True)
    assert np.array_equal(once.best.pads_f.upper, twice.best.pads_f.upper, equal_nan=True)


def test_a_ramp_with_a_stated_mass_gives_the_pads_and_keeps_the_vehicle():
    log = noisy(ramp(LOADED), 2)
    told, untold = fit(KERB, [log], mass=1.2 * CAR.mass), fit(KERB, [log])
    true = CAR.front.pad_friction
    low, high = told.calibration.pad_friction_f.ci95
    assert low < true < high
    assert untold.calibration.pad_friction_f.ci95[1] < true
    assert told.calibration.pad_scale.sigma < 0.02 < untold.calibration.pad_scale.sigma
    assert told.vehicle == untold.vehicle == KERB
    assert any("2092.8 kg" in remark for remark in told.remarks)
    assert not any("kg" in remark for remark in untold.remarks)
