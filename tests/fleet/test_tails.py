import numpy as np
import pytest
from scipy.stats import norm

from calib.fleet import tails
from calib.fleet.tails import Shape, shape


def test_a_lognormal_figure_has_its_own_sigma_as_g():
    # median exp(0) = 1, (exp(0.4 z) - 1)/0.4 * 0.4: B = 0.4, g = 0.4, h = 0
    x = np.exp(0.4 * norm.ppf((np.arange(20_000) + 0.5) / 20_000))
    found = shape(x, 1.0, 0.4)
    assert found.g == pytest.approx(0.4, abs=0.01)
    assert found.h == pytest.approx(0.0, abs=0.01)
    assert found.scale == pytest.approx(0.4, rel=0.02)
    assert found.z(np.exp(0.4 * np.array([-3.0, 0.0, 5.0])) - 1.0) == pytest.approx(
        [-3.0, 0.0, 5.0], abs=0.2
    )


def test_a_normal_figure_stays_normal():
    rng = np.random.default_rng(1)
    kept = [shape(rng.normal(size=400), 0.0, 1.0) == Shape(1.0, 0.0, 0.0) for _ in range(300)]
    # two tests at 3 sigma, one of them one-sided: 0.4 %, and 4 sigma of 300 more
    assert np.mean(kept) > 0.98


def test_the_sigmas_are_those_of_normal_figures(monkeypatch):
    monkeypatch.setattr(tails, "SURE", 0.0)
    rng = np.random.default_rng(2)
    x = rng.normal(size=(1500, 1000))
    found = [shape(row, float(np.median(row)), 1.0) for row in x]
    assert np.std([s.g for s in found]) * np.sqrt(1000) == pytest.approx(tails.SIGMA_G, rel=0.08)
    # h below nought is cut: the upper half alone has the mean square of the whole
    h = np.array([s.h for s in found])
    assert np.sqrt(2.0 * np.mean(h**2)) * np.sqrt(1000) == pytest.approx(tails.SIGMA_H, rel=0.1)


def test_wild_values_do_not_move_the_shape():
    x = norm.ppf((np.arange(2000) + 0.5) / 2000)
    wild = np.where(np.arange(2000) >= 1940, 1e9, x)
    assert shape(wild, 0.0, 1.0) == shape(x, 0.0, 1.0)


def test_few_or_one_sided_values_have_no_shape():
    x = np.exp(np.random.default_rng(3).normal(size=99))
    assert shape(x, 1.0, 0.7) == Shape(0.7, 0.0, 0.0)
    half = np.r_[np.ones(200), np.linspace(0.0, 1.0, 100)]
    assert shape(half, 1.0, 0.1) == Shape(0.1, 0.0, 0.0)
