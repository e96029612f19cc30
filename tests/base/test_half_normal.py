"""Closed forms of a quantity that is not below zero, against integrals over it."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import norm

from calib.base.mixtures import likelihood_ratio, mean_square

CASES = [(0.05, 0.01, 0.1), (-0.03, 0.02, 0.06), (0.0, 0.03, 0.06), (0.3, 0.05, 0.1)]


@pytest.mark.parametrize(("x", "sigma", "spread"), CASES)
def test_ratio_and_mean_square_are_the_integrals(x, sigma, spread):
    def density(m, power=0):
        return m**power * 2.0 * norm.pdf(m, 0.0, spread) * norm.pdf(x, m, sigma)

    top = max(x, 0.0) + 8.0 * sigma
    total, squares = (quad(density, 0.0, top, (k,), limit=200)[0] for k in (0, 2))
    assert likelihood_ratio(x, sigma, spread) == pytest.approx(
        total / norm.pdf(x, 0.0, sigma), rel=1e-6
    )
    assert mean_square(x, sigma, spread) == pytest.approx(squares / total, rel=1e-6)


def test_far_from_zero_nothing_overflows():
    assert np.isfinite(likelihood_ratio(10.0, 0.01, 0.1))
    assert likelihood_ratio(-10.0, 0.01, 0.1) == 0.0
    assert 0.0 <= mean_square(-10.0, 0.01, 0.1) < 1e-3
