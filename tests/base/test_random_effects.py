"""Random effects against closed forms, a published example, and fleets drawn at random."""

import math

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from scipy.stats import norm, t

from calib.base.random_effects import (
    as_sigma,
    between_variance,
    quantile95,
    random_effects,
)

# Tuberculosis and not, vaccinated and not, of 13 trials: Colditz et al. 1994, JAMA 271, 698-702
ILL = np.array([4, 6, 3, 62, 33, 180, 8, 505, 29, 17, 186, 5, 27])
WELL = np.array([119, 300, 228, 13536, 5036, 1361, 2537, 87886, 7470, 1699, 50448, 2493, 16886])
ILL_0 = np.array([11, 29, 11, 248, 47, 372, 10, 499, 45, 65, 141, 3, 29])
WELL_0 = np.array([128, 274, 209, 12619, 5761, 1079, 619, 87892, 7232, 1600, 27197, 2338, 17825])
RISK = np.log(ILL / (ILL + WELL)) - np.log(ILL_0 / (ILL_0 + WELL_0))
VARIANCE = 1 / ILL - 1 / (ILL + WELL) + 1 / ILL_0 - 1 / (ILL_0 + WELL_0)


def test_the_published_example_of_the_vaccine():
    """REML and Hartung-Knapp of these trials, as the package metafor prints them."""
    found = random_effects(RISK[:, None], VARIANCE[:, None])
    assert found.between[0] == pytest.approx(0.3132, abs=5e-5)
    assert found.mean[0] == pytest.approx(-0.7145, abs=5e-5)
    assert found.sigma[0] == pytest.approx(0.1808, abs=5e-5)
    ends = found.mean[0] + np.array([-1.0, 1.0]) * quantile95(found.freedom) * found.sigma[0]
    assert ends == pytest.approx((-1.1084, -0.3206), abs=5e-5)


def restricted_likelihood(between, x, v):
    """Minus ln of the restricted likelihood, from contrasts of the data that are free of the mean.

    Written with matrices: the contrasts are an orthonormal basis of all vectors with sum zero.
    """
    basis = np.linalg.svd(np.ones((1, x.size)))[2][1:]
    S = basis @ np.diag(v + between) @ basis.T
    y = basis @ x
    return 0.5 * (np.linalg.slogdet(S)[1] + y @ np.linalg.solve(S, y))


@pytest.mark.parametrize("seed", range(3))
def test_reml_is_the_maximum_of_the_restricted_likelihood(seed):
    rng = np.random.default_rng(seed)
    k = int(rng.integers(2, 9))
    v = rng.uniform(0.3, 3.0, k)
    x = rng.normal(0.0, 2.0 + np.sqrt(v))
    best = minimize_scalar(
        restricted_likelihood, bounds=(0.0, 200.0), args=(x, v), method="bounded",
        options={"xatol": 1e-10},
    )  # fmt: skip
    found = between_variance(x[:, None], v[:, None])[0]
    assert found == pytest.approx(best.x, rel=1e-4, abs=1e-5)


@pytest.mark.parametrize("freedom", [1, 2, 9, 200])
@pytest.mark.parametrize("value", [-8.0, -1.0, 0.0, 0.3, 4.0])
def test_a_sigma_is_as_rare_as_the_t_that_it_stands_for(freedom, value):
    sigma = as_sigma(value, freedom)
    assert norm.sf(abs(sigma)) == pytest.approx(t.sf(abs(value), freedom), rel=1e-9)
    assert math.copysign(1.0, sigma) == math.copysign(1.0, value)
    assert quantile95(freedom) == pytest.approx(t.ppf(0.975, freedom))


@pytest.mark.parametrize("k", [2, 5])
@pytest.mark.parametrize("between", [0.0, 3.0])
def test_the_interval_of_the_mean_holds_it_and_one_more_is_within_its_sigma(k, between):
    """2000 fleets: 95 % within 1.5 %, or more; never above it by being infinitely wide."""
    rng = np.random.default_rng([k, int(between)])
    v = rng.uniform(0.5, 2.0, (k, 2000))
    found = random_effects(rng.normal(0.0, np.sqrt(between**2 + v)), v)
    held = np.mean(np.abs(found.mean) <= quantile95(k - 1) * found.sigma)
    assert held >= 0.935
    one = rng.normal(0.0, np.sqrt(between**2 + rng.uniform(0.5, 2.0, 2000)))
    t_of = np.abs(one - found.mean) / found.one_more
    assert np.mean(t_of <= quantile95(k - 1)) >= 0.93
    if between == 3.0 and k >= 5:
        assert held <= 0.97
