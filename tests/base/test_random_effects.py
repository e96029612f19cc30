"""Random effects against closed forms, and fleets drawn at random."""

import math

import numpy as np
import pytest
from scipy.stats import norm, t

from calib.base.random_effects import normal_equivalent, quantile95, random_effects


@pytest.mark.parametrize("freedom", [1, 2, 9, 200])
@pytest.mark.parametrize("value", [-8.0, -1.0, 0.0, 0.3, 4.0])
def test_normal_equivalent_is_as_rare_as_t(freedom, value):
    sigma = normal_equivalent(value, freedom)
    assert norm.sf(abs(sigma)) == pytest.approx(t.sf(abs(value), freedom), rel=1e-9)
    assert math.copysign(1.0, sigma) == math.copysign(1.0, value)
    assert quantile95(freedom) == pytest.approx(t.ppf(0.975, freedom))


@pytest.mark.parametrize("k", [2, 5])
@pytest.mark.parametrize("between", [0.0, 3.0])
def test_intervals_of_mean_and_prediction_hold_95_percent(k, between):
    """In 4000 fleets, 95 % of the values are in the intervals, or more without scatter between."""
    rng = np.random.default_rng([k, int(between)])
    scatter, largest_share = np.hypot(between, 1.0), 0.96 if between else 0.995
    effects = random_effects(rng.normal(0.0, scatter, (k, 4000)), np.ones((k, 4000)))
    next_values, t95 = rng.normal(0.0, scatter, 4000), quantile95(k - 1)
    for error, sigma in (
        (effects.mean, effects.sigma),
        (next_values - effects.mean, effects.prediction_sigma),
    ):
        assert 0.94 <= np.mean(np.abs(error) <= t95 * sigma) <= largest_share
    if between and k == 5:
        assert np.sqrt(np.mean(effects.between**2)) == pytest.approx(between, rel=0.05)
