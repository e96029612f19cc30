"""The numbers of the normal distribution, to the digits that are kept of them."""

import pytest
import scipy.stats

from calib.base.intervals import QUARTILE, Z95


def test_z95_is_the_quantile_of_the_normal_distribution():
    assert pytest.approx(scipy.stats.norm.ppf(0.975), abs=5e-5) == Z95


def test_quartile_is_that_of_the_normal_distribution():
    assert pytest.approx(scipy.stats.norm.ppf(0.75), abs=5e-5) == QUARTILE
