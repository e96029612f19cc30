"""The weighing of two hypotheses against its limits and against Bayes by sampling."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.base.mixtures import mixture_posterior

FREE, ODDS, NOMINAL = 0.4, 2.0, 0.02

deviations = st.floats(-1.5, 1.5)
sigmas = st.floats(1e-4, 0.3)


def by_sampling(x, error, n=400_000):
    """Mean, sd and weight of nominal, given x measured with that error: draw, weigh, add up."""
    rng = np.random.default_rng(5)
    nominal = rng.random(n) < ODDS / (1.0 + ODDS)
    theta = np.where(nominal, NOMINAL, FREE) * rng.normal(size=n)
    likely = np.exp(-0.5 * ((x - theta) / error) ** 2)
    likely /= likely.sum()
    mean = likely @ theta
    return mean, np.sqrt(likely @ (theta - mean) ** 2), likely @ nominal


@pytest.mark.parametrize("error", [0.03, 0.06])
@pytest.mark.parametrize("x", [0.0, 0.05, 0.12, 0.2, -0.16])
def test_is_the_posterior_of_the_two_hypotheses(x, error):
    # what it is given: the posterior under the free hypothesis, prior included
    kept = FREE**2 / (FREE**2 + error**2)
    found = mixture_posterior(kept * x, np.sqrt(kept) * error, FREE, ODDS, NOMINAL)
    mean, sigma, weight = by_sampling(x, error)
    assert found.mean == pytest.approx(mean, abs=0.05 * error)
    assert found.sigma == pytest.approx(sigma, rel=0.05)
    assert found.nominal_weight == pytest.approx(weight, abs=0.02)


def test_far_from_nominal_it_is_as_measured():
    found = mixture_posterior(0.5, 0.01, FREE, ODDS, NOMINAL)
    assert found.nominal_weight < 1e-50
    assert found.mean == pytest.approx(0.5, abs=1e-12)
    assert found.sigma == pytest.approx(0.01, rel=1e-9)


def test_far_beyond_what_is_usual_it_is_as_measured_too():
    found = mixture_posterior(1e3, 0.1, FREE, ODDS, NOMINAL)
    assert (float(found.mean), float(found.sigma)) == pytest.approx((1e3, 0.1))


def test_what_cannot_be_told_from_nominal_stays_there():
    """A noisy measurement within its noise does not widen nominal by that noise."""
    found = mixture_posterior(0.02, 0.02, FREE, 1e6, 0.001)
    assert found.nominal_weight > 0.999
    assert abs(found.mean) < 1e-3
    assert found.sigma < 0.0015


def test_exact_nominal_leaves_no_spread():
    found = mixture_posterior(0.01, 0.05, FREE, np.inf, 0.0)
    assert (float(found.mean), float(found.sigma)) == pytest.approx((0.0, 0.0), abs=1e-12)


@given(deviations, sigmas)
def test_mean_lies_between_and_sigma_spans_both(d, s):
    found = mixture_posterior(d, s, FREE, ODDS, NOMINAL)
    w = float(found.nominal_weight)
    at_nominal = d * NOMINAL**2 / (NOMINAL**2 + s**2)
    assert min(at_nominal, d) - 1e-12 <= found.mean <= max(at_nominal, d) + 1e-12
    assert found.sigma >= np.sqrt(w * (1.0 - w)) * abs(d - at_nominal) - 1e-12
    mirrored = mixture_posterior(-d, s, FREE, ODDS, NOMINAL)
    assert (-mirrored.mean, mirrored.sigma) == (found.mean, found.sigma)


@given(st.floats(0.0, 1.0), st.floats(0.0, 1.0), sigmas)
def test_the_farther_the_less_nominal(a, b, s):
    near, far = sorted((a, b))
    weights = mixture_posterior(np.array([near, far]), s, FREE, ODDS, NOMINAL).nominal_weight
    assert weights[0] >= weights[1]


def test_arrays_are_weighed_one_by_one():
    d, s = np.array([0.0, 0.1, 0.5]), np.array([0.01, 0.05, 0.1])
    together = mixture_posterior(d, s, FREE, ODDS, NOMINAL)
    for i in range(3):
        alone = mixture_posterior(d[i], s[i], FREE, ODDS, NOMINAL)
        assert [x[i] for x in together] == pytest.approx([float(x) for x in alone], rel=1e-12)
