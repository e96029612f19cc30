"""The change of level against known changes."""

import numpy as np
import pytest

from calib.line.fleet.drift import autocorrelation, find_change


def test_no_change_without_scatter_or_with_few():
    assert find_change(np.full(50, 0.38)) is None
    assert find_change(np.arange(21.0)) is None
    assert find_change(np.repeat([0.0, 1.0], 11)).p < 0.001  # a plain step in as few as are tested


@pytest.mark.parametrize("size", [1.0, 1.5])
def test_a_change_is_found_where_it_is(size):
    rng = np.random.default_rng(4)
    first = []
    for _ in range(100):
        y = rng.normal(size=300)
        y[180:] += size
        found = find_change(y)
        assert found.p < 0.001
        assert found.new_level - found.old_level == pytest.approx(size, abs=0.6)
        first.append(found.first)
    assert abs(np.median(first) - 180) <= 2
    assert np.mean(np.abs(np.array(first) - 180) <= 15) > 0.9


def test_a_steady_line_changes_as_rarely_as_said_whatever_its_law():
    rng = np.random.default_rng(5)
    for draw in (rng.normal, rng.standard_cauchy, rng.exponential):
        p = np.array([find_change(draw(size=200)).p for _ in range(500)])
        assert 0.02 < np.mean(p < 0.05) < 0.08


@pytest.mark.parametrize("drift", ["none", "step", "line"])
def test_the_likeness_of_neighbours_is_that_of_the_cars_and_not_of_the_drift(drift):
    rng = np.random.default_rng(7)
    n, r = 400, 0.6
    moved = {"none": np.zeros(n), "step": np.arange(n) >= 150, "line": np.arange(n) / n}[drift]
    found = []
    for noise in rng.normal(size=(40, n)):
        x = np.empty(n)
        x[0] = noise[0]
        for i in range(1, n):  # AR(1) with variance 1
            x[i] = r * x[i - 1] + np.sqrt(1.0 - r * r) * noise[i]
        x += 3.0 * moved
        found.append(autocorrelation(x - x.mean(), 150))
    assert np.mean(found) == pytest.approx(r, abs=0.03)
