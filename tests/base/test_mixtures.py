"""The odds of a quantity that is not below zero, against an integral and in its limits."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import norm

from calib.base.mixtures import likelihood_ratio


@pytest.mark.parametrize(
    ("x", "sigma", "spread"),
    [(0.05, 0.01, 0.1), (-0.03, 0.02, 0.06), (0.0, 0.03, 0.06), (0.3, 0.05, 0.1)],
)
def test_the_ratio_of_what_is_not_below_zero_is_an_integral(x, sigma, spread):
    def density(m):
        return 2.0 * norm.pdf(m, 0.0, spread) * norm.pdf(x, m, sigma)

    total = quad(density, 0.0, max(x, 0.0) + 8.0 * sigma, limit=200)[0]
    ratio = total / norm.pdf(x, 0.0, sigma)
    assert likelihood_ratio(x, sigma, spread) == pytest.approx(ratio, rel=1e-6)


def test_far_from_zero_nothing_overflows():
    assert np.isfinite(likelihood_ratio(10.0, 0.01, 0.1))
    assert likelihood_ratio(-10.0, 0.01, 0.1) == 0.0
