"""What a bulk says of its tails, against closed forms and against many draws."""

import numpy as np
import pytest
from scipy.stats import norm

from calib.line.fleet.shapes import (
    SKEW,
    TAIL,
    TAIL_PRIOR,
    Bulk,
    evidence,
    log_likelihood,
    two_sided,
)


def bulk(x, scale=1.0):
    return Bulk(np.sort(x), scale, float(x.min()), float(x.max()), 0, 0)


def normal(n, sigma=1.0):
    """Quantiles of a normal metric: a sample without chance."""
    return sigma * norm.ppf((np.arange(n) + 0.5) / n)


def test_a_large_normal_metric_gives_the_normal_p():
    one = bulk(normal(2000, 0.02), 0.02)
    p = two_sided(one, log_likelihood(one), TAIL_PRIOR, 0.02 * np.array([-3.0, 0.0, 2.0, 4.0]))
    assert p == pytest.approx(2.0 * norm.sf([3.0, 0.0, 2.0, 4.0]), rel=0.1)


def test_the_shape_of_a_lognormal_metric_is_found():
    x = np.exp(0.5 * normal(2000)) - 1.0  # g = 0.5
    at = np.unravel_index(np.argmax(log_likelihood(bulk(x, 0.5))), (SKEW.size, TAIL.size, 9))
    assert SKEW[at[0]] == 0.5
    assert TAIL[at[1]] == 0.0


def test_long_tails_are_evident_in_many_cars_and_not_in_few():
    rng = np.random.default_rng(1)
    many, few = (evidence(log_likelihood(bulk(rng.standard_t(4, n)))) for n in (2000, 12))
    assert np.argmax(many) > 0
    assert many[0] < -20.0
    assert few.min() > -3.0


def test_cars_outside_count_by_their_number_and_not_by_their_distance():
    x = normal(60)
    near = Bulk(x[3:-3], 1.0, x[3], x[-4], 3, 3)
    assert np.argmax(evidence(log_likelihood(near))) == 0


def test_few_cars_make_a_distance_less_rare():
    few, many = (bulk(normal(n)) for n in (10, 1000))
    p = [two_sided(b, log_likelihood(b), TAIL_PRIOR, np.array([5.0]))[0] for b in (few, many)]
    assert p[0] > 30.0 * p[1]
