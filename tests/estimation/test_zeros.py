"""Radii that drift while the car rolls for five minutes: the zero is that of the bite."""

import numpy as np
import pytest

from calib.estimation.estimator import estimate
from calib.fitting.fit import fit
from tests.support.reference_car import (
    CAR,
    IDEAL,
    covered,
    noisy,
    prepared,
    ramp,
    rolled,
    stop,
    with_pads,
)

ROLLING = 300.0
RADII = CAR.front.rolling_radius / CAR.rear.rolling_radius
PADS = 0.34, 0.31


@pytest.fixture(scope="module")
def table():
    return fit(CAR, [noisy(ramp(), 1)])


@pytest.fixture(scope="module")
def braking():
    return stop(with_pads(IDEAL, *PADS), duration=6.0)


@pytest.mark.parametrize("drift", [0.0, 1e-3])
def test_tyres_that_warm_up_move_no_pads(table, braking, drift):
    result = estimate(table, noisy(rolled(braking, ROLLING, drift), 4))
    assert result.zeros[0] == pytest.approx((1.0 + drift) * RADII, abs=1.5e-4)
    assert covered(result, *PADS)[1] > 0.95
    assert np.mean(result.best.pads_r.value, where=result.valid) == pytest.approx(PADS[1], rel=0.05)


def test_a_ramp_is_zeroed_where_it_bites():
    drift = 1e-3
    log = noisy(rolled(ramp(), ROLLING, drift), 4)
    run = prepared(log)
    assert np.count_nonzero(run.use) * run.blocks.length < 75.0
    assert np.mean(run.blocks.eta[run.rolling]) - 1.0 == pytest.approx(
        (1.0 + drift) * RADII - 1.0, abs=1.5e-4
    )
