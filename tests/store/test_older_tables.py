"""Tables of before the tyres of the axles could differ: six parameters, read and estimated with."""

from dataclasses import replace

import numpy as np
import pytest

from calib.estimation.estimator import estimate
from calib.store.store import Store
from calib.table.table import TyrePosterior
from tests.support.reference_car import WET, noisy, stop

SIX = (
    "log_compliance",
    "curvature_2",
    "curvature_3",
    "load_exponent",
    "clock_offset",
    "log_pad_ratio",
)


@pytest.fixture(scope="module")
def older(fitted):
    """The table with the marginal of the six parameters that tables had."""
    known = fitted.posterior
    at = [known.names.index(name) for name in SIX]
    covariance = np.asarray(known.covariance)[np.ix_(at, at)]
    six = TyrePosterior(
        SIX, tuple(known.mean[i] for i in at), tuple(tuple(row) for row in covariance.tolist())
    )
    return replace(fitted, posterior=six)


def test_it_comes_back_with_its_six_parameters_and_its_digest(older, store):
    saved = Store(store).save(older)
    read = Store(store).load(saved.id)
    assert read.digest == older.digest
    assert read.table.posterior == older.posterior
    assert "scatter" not in older.content()[0]["posterior"]
    assert all(verdict.sound for verdict in Store(store).verify())


def test_it_is_estimated_with_and_doubts_its_tyres(older, store):
    """Tyres start at the prior: the interval is honest, though the table never heard of them."""
    Store(store).save(older)
    e = estimate(Store(store).load(older.name).table, noisy(stop(WET), 3))
    assert e.valid.sum() > 100
    for axle, true in ((e.best.pads_f, 0.31), (e.best.pads_r, 0.27)):
        held = (axle.lower <= true) & (true <= axle.upper)
        assert np.mean(held[e.valid]) >= 0.9
