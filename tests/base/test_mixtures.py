"""The weighing of hypotheses against Bayes by sampling and by integrals, and in its limits."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.stats import norm

from calib.base.mixtures import likelihood_ratio, mean_square, mixture_posterior

FREE, ODDS, NOMINAL = 0.4, 2.0, 0.02


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
@pytest.mark.parametrize("x", [0.0, 0.12, -0.16])
def test_is_the_posterior_of_the_two_hypotheses(x, error):
    # what it is given: the posterior under the free hypothesis, prior included
    kept = FREE**2 / (FREE**2 + error**2)
    found = mixture_posterior(kept * x, np.sqrt(kept) * error, FREE, ODDS, NOMINAL)
    mean, sigma, weight = by_sampling(x, error)
    assert found.mean == pytest.approx(mean, abs=0.05 * error)
    assert found.sigma == pytest.approx(sigma, rel=0.05)
    assert found.nominal_weight == pytest.approx(weight, abs=0.02)


@pytest.mark.parametrize(
    ("given_by", "mean", "sigma"),
    [
        ((0.5, 0.01, FREE, ODDS, NOMINAL), 0.5, 0.01),  # far from nominal: as measured
        ((1e3, 0.1, FREE, ODDS, NOMINAL), 1e3, 0.1),  # far beyond what is usual, too
        ((0.01, 0.05, FREE, np.inf, 0.0), 0.0, 0.0),  # an exact nominal leaves no spread
        ((0.02, 0.02, FREE, 1e6, 0.001), 0.0, 0.001),  # within its noise it does not pay for it
    ],
)
def test_in_its_limits_one_hypothesis_is_left(given_by, mean, sigma):
    found = mixture_posterior(*given_by)
    assert float(found.mean) == pytest.approx(mean, abs=1e-4)
    assert float(found.sigma) == pytest.approx(sigma, abs=1e-4)


@given(st.floats(-1.5, 1.5), st.floats(1e-4, 0.3))
def test_mean_lies_between_and_sigma_spans_both(d, s):
    found = mixture_posterior(d, s, FREE, ODDS, NOMINAL)
    w = float(found.nominal_weight)
    at_nominal = d * NOMINAL**2 / (NOMINAL**2 + s**2)
    assert min(at_nominal, d) - 1e-12 <= found.mean <= max(at_nominal, d) + 1e-12
    assert found.sigma >= np.sqrt(w * (1.0 - w)) * abs(d - at_nominal) - 1e-12
    mirrored = mixture_posterior(-d, s, FREE, ODDS, NOMINAL)
    assert (-mirrored.mean, mirrored.sigma) == (found.mean, found.sigma)


@pytest.mark.parametrize(
    ("x", "sigma", "spread"),
    [(0.05, 0.01, 0.1), (-0.03, 0.02, 0.06), (0.0, 0.03, 0.06), (0.3, 0.05, 0.1)],
)
def test_ratio_and_mean_square_of_what_is_not_below_zero_are_integrals(x, sigma, spread):
    def density(m, power=0):
        return m**power * 2.0 * norm.pdf(m, 0.0, spread) * norm.pdf(x, m, sigma)

    top = max(x, 0.0) + 8.0 * sigma
    total, squares = (quad(density, 0.0, top, (k,), limit=200)[0] for k in (0, 2))
    ratio = total / norm.pdf(x, 0.0, sigma)
    assert likelihood_ratio(x, sigma, spread) == pytest.approx(ratio, rel=1e-6)
    assert mean_square(x, sigma, spread) == pytest.approx(squares / total, rel=1e-6)


def test_far_from_zero_nothing_overflows():
    assert np.isfinite(likelihood_ratio(10.0, 0.01, 0.1))
    assert likelihood_ratio(-10.0, 0.01, 0.1) == 0.0
    assert 0.0 <= mean_square(-10.0, 0.01, 0.1) < 1e-3
