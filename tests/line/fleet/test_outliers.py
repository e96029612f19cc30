"""Outliers: good fleets seldom have one, and cars that are off are named."""

import numpy as np
import pytest
from scipy.stats import binom, t

from calib.line.fleet.outliers import find_outliers


def outlier_test(values, least=0.0):
    """Test metrics (m, n) of which differences of ``least`` matter."""
    values = np.atleast_2d(values)
    return find_outliers(values, [least] * len(values))


def cars_named(values):
    return np.flatnonzero(outlier_test(values).reasons.any(axis=0)).tolist()


FLEETS = 25


def long_tails(rng, m, n):
    """Student's t with 4 degrees of freedom."""
    return rng.standard_t(4, size=(m, n)) / np.sqrt(2.0)


def skewed(rng, m, n):
    return np.exp(0.5 * rng.normal(size=(m, n))) / 0.604


def mixed(rng, m, n):
    """A third of the metrics skewed, a third with long tails, a third normal."""
    parts = (skewed(rng, m, n), long_tails(rng, m, n), rng.normal(size=(m, n)))
    return np.choose(np.arange(m)[:, None] % 3, parts)


def shrunk(rng, m, n):
    """Each car drawn to the nominal value by a weight of its own."""
    return rng.normal(size=(m, n)) * (1.0 - rng.beta(4.0, 1.0, size=(m, n))) * 3.6


def false_alarms(draw, metrics, cars):
    """Number of pages of good cars, of `FLEETS`, that name a car."""
    rng = np.random.default_rng([1, cars, metrics])
    return sum(outlier_test(draw(rng, metrics, cars)).reasons.any() for _ in range(FLEETS))


MAX_FALSE_ALARMS = binom.ppf(0.999, FLEETS, 0.05)
"""More false alarms than this come once in 1000 times, if a fleet gives one in 5 % of cases."""


@pytest.mark.parametrize(
    ("draw", "metrics", "cars"),
    [(long_tails, 1, 60), (skewed, 1, 60), (skewed, 6, 300), (mixed, 12, 200), (shrunk, 1, 60)],
)
def test_a_page_of_good_cars_seldom_names_a_car(draw, metrics, cars):
    assert false_alarms(draw, metrics, cars) <= MAX_FALSE_ALARMS


def test_a_car_that_is_six_sigma_off_is_named_once_with_all_its_reasons():
    rng = np.random.default_rng(4)
    x = rng.normal(size=(5, 60))
    x[1] = x[0] + 0.1 * x[1]  # follows the first
    x[:2, 17] += 8.0
    test = outlier_test(x)
    assert np.flatnonzero(test.reasons.any(axis=0)).tolist() == [17]
    assert np.flatnonzero(test.reasons[:, 17]).tolist() == [0, 1]


def test_a_difference_that_does_not_matter_names_no_car():
    x = 0.38 + 1e-6 * np.random.default_rng(6).normal(size=60)
    x[5] += 1e-4
    assert outlier_test(x).reasons[0, 5]
    assert not outlier_test(x, 0.001).reasons.any()
    x[5] += 0.05
    assert outlier_test(x, 0.001).reasons[0, 5]


def test_outliers_are_named_and_do_not_hide_each_other():
    x = 0.38 + 0.01 * np.random.default_rng(8).normal(size=500)
    x[[3, 50, 77]] = (0.45, 0.30, 0.50)
    assert cars_named(x) == [3, 50, 77]


def test_gaps_few_cars_and_figures_without_scale():
    x = np.r_[np.nan, np.arange(20.0)]
    assert np.isnan(outlier_test(x).p[0, 0])
    for values in (np.arange(3.0), np.r_[np.zeros(50), 1.0], np.full(4, np.nan)):
        assert not np.isfinite(outlier_test(values).p).any()
        assert cars_named(values) == []


def test_the_tails_of_a_large_bulk_are_found():
    share = (np.arange(8000) + 0.5) / 8000
    for freedom in (1e6, 4.0):
        x = np.r_[t.ppf(share, freedom), np.nan]
        x[-1] = t.isf(5e-5, freedom)
        assert outlier_test(x).p[0, -1] == pytest.approx(1e-4, rel=0.2)
