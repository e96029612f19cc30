"""A fit whose inputs differ by less than any sensor resolves is the same, on any processor."""

import numpy as np

from calib.fitting.fit import fit
from tests.support.reference_car import CAR, REAL, noisy, ramp
from tests.support.rounding import jittered


def test_a_fit_does_not_hang_on_the_last_digits(fitted):
    other = fit(CAR, [jittered(noisy(ramp(REAL), 1), 2)])
    for name, draws in vars(fitted.draws).items():
        if isinstance(draws, np.ndarray) and draws.dtype == float:
            low, high = np.quantile(draws, [0.025, 0.975], axis=0)
            moved = np.abs(
                np.quantile(vars(other.draws)[name], [0.025, 0.5, 0.975], axis=0)
                - np.quantile(draws, [0.025, 0.5, 0.975], axis=0)
            )
            assert np.all(moved <= 1e-4 * (high - low)), name
    assert [one.code for one in other.warnings] == [one.code for one in fitted.warnings]
