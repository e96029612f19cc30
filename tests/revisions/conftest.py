"""Twenty ramps of one car, each fitted by itself."""

import pytest

from calib.fitting.fit import fit
from calib.table.table import Table
from tests.support.reference_car import CAR, REAL, noisy, ramp


@pytest.fixture(scope="session")
def runs() -> list[Table]:
    driven = ramp(REAL)
    return [fit(CAR, [noisy(driven, seed)]) for seed in range(20)]
