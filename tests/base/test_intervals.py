"""Noise against its covariance, and likelihood ratios against integrals."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import norm

from calib.base.intervals import likelihood_ratio, noise_over, second_difference_model, white_noise


def test_second_differences_have_the_variance_of_their_parts():
    rng = np.random.default_rng(4)
    white, walk, turned = 0.5, 0.3, 0.2
    x = np.sqrt(white) * rng.standard_normal(200_000)
    x += np.cumsum(np.sqrt(walk) * rng.standard_normal(x.size))
    x += np.cumsum(np.cumsum(np.sqrt(turned) * rng.standard_normal(x.size)))
    differences = np.diff(x, 2)
    average, sigma = second_difference_model(white, walk, turned)
    expected_covariance = sigma**2 * np.correlate(average, average, "full")[average.size - 1 :]
    for lag, expected in enumerate(expected_covariance):
        measured = np.mean(differences[lag:] * differences[: differences.size - lag])
        assert measured == pytest.approx(expected, abs=0.03)


def test_white_noise_ignores_motion_and_a_spike_and_larger_lags_show_interpolated_noise():
    rng, t = np.random.default_rng(4), np.arange(2000) / 200
    x = 50.0 - 3.0 * t + 0.1 * rng.normal(size=t.size)
    x[1000] += 3.0
    assert white_noise(x) == pytest.approx(0.1, rel=0.1)
    assert noise_over(x, 8.0) == pytest.approx([0.1] * 4, rel=0.1)
    interpolated = np.interp(np.arange(2000), np.arange(0, 2000, 8), x[::8])
    assert white_noise(interpolated) < 0.03
    assert noise_over(interpolated, 8.0)[-1] > 0.06


@pytest.mark.parametrize(
    ("x", "sigma", "spread"),
    [(0.05, 0.01, 0.1), (-0.03, 0.02, 0.06), (0.0, 0.03, 0.06), (0.3, 0.05, 0.1)],
)
def test_likelihood_ratio_is_an_integral_over_its_half_normal_prior(x, sigma, spread):
    def density(m):
        return 2.0 * norm.pdf(m, 0.0, spread) * norm.pdf(x, m, sigma)

    total = quad(density, 0.0, max(x, 0.0) + 8.0 * sigma, limit=200)[0]
    ratio = total / norm.pdf(x, 0.0, sigma)
    assert likelihood_ratio(x, sigma, spread) == pytest.approx(ratio, rel=1e-6)


def test_likelihood_ratio_does_not_overflow_far_from_zero():
    assert np.isfinite(likelihood_ratio(10.0, 0.01, 0.1))
    assert likelihood_ratio(-10.0, 0.01, 0.1) == 0.0
