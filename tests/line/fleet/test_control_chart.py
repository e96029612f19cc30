"""The chart against closed forms and published run lengths, the change against known changes."""

import numpy as np
import pytest

from calib.line.fleet.control_chart import (
    alarms,
    change,
    chart,
    likeness,
)


def test_the_run_length_is_the_published_one():
    """Cars up to the first alarm; Champ and Woodall (1987), table 1: exact, by Markov chains."""
    rng = np.random.default_rng(1)
    found = []
    for _ in range(500):
        first = np.flatnonzero(np.logical_or.reduce([*alarms(rng.normal(size=1500)).values()]))
        found.append(first[0] + 1)
    assert abs(np.mean(found) - 91.75) < 4.0 * np.std(found) / np.sqrt(500)


def test_patterns_by_hand():
    def at(rule, *z):
        return np.flatnonzero(alarms(np.array(z))[rule]).tolist()

    assert at(1, 0.0, 3.1, -3.1, 2.9) == [1, 2]
    assert at(2, 2.1, 0.0, 2.1, 0.0, 2.1) == [2, 4]
    assert at(2, 2.1, -2.1) == []
    assert at(3, 1.1, 1.1, 0.0, 1.1, 1.1, 0.0) == [4]
    assert at(4, *[0.1] * 9) == [7, 8]
    assert at(4, *[0.1] * 7, -0.1, 0.1) == []


def test_no_chart_without_scatter_or_with_few():
    assert chart(np.full(50, 0.38)) is None
    assert chart(np.arange(9.0)) is None
    assert change(np.full(50, 0.38)) is None
    assert change(np.arange(9.0)) is None
    assert chart(np.where(np.arange(100) % 5 == 0, 0.1, 0.0)).sigma > 0.0  # a coarse metric


@pytest.mark.parametrize("size", [1.0, 1.5])
def test_a_change_is_found_where_it_is(size):
    rng = np.random.default_rng(4)
    first = []
    for _ in range(100):
        y = rng.normal(size=300)
        y[180:] += size
        found = change(y)
        assert found.p < 0.001
        assert found.after - found.before == pytest.approx(size, abs=0.6)
        first.append(found.first)
    assert abs(np.median(first) - 180) <= 2
    assert np.mean(np.abs(np.array(first) - 180) <= 15) > 0.9


def test_a_steady_line_changes_as_rarely_as_said_whatever_its_law():
    rng = np.random.default_rng(5)
    for draw in (rng.normal, rng.standard_cauchy, rng.exponential):
        p = np.array([change(draw(size=200)).p for _ in range(500)])
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
        found.append(likeness(x - x.mean(), 150))
    assert np.mean(found) == pytest.approx(r, abs=0.03)
