"""Whatever a log holds: no traceback, no number that is not finite."""

import numpy as np
import pytest

from tests.support.reference_car import REAL, noisy, ramp, stop
from tests.support.spoiled import findings, spoiled


@pytest.fixture(scope="module")
def runs():
    return {True: noisy(ramp(REAL), 1), False: noisy(stop(REAL), 2)}


@pytest.mark.parametrize("seed", range(2))
def test_spoiled_logs(runs, fitted, seed):
    for number in range(6):
        rng = np.random.default_rng([100 + seed, number])
        is_ramp = number % 3 == 0
        done, text = spoiled(runs[is_ramp], rng)
        assert findings(text, fitted, is_ramp) == [], done
