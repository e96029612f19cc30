"""Draws of one more car of a model, against Student's distribution."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import t

from calib.store.mixture import one_more
from tests.support.cars_of_a_line import car_table

LEVELS = (-0.02, 0.01, 0.03, 0.05, -0.04)


def alike(table):
    """The table with nothing left open: each of its draws is their middle."""
    draws = {name: np.full_like(x, np.mean(x)) for name, x in vars(table.draws).items()}
    return replace(table, draws=replace(table.draws, **draws))


@pytest.mark.parametrize("k", [2, 3, 5])
def test_one_more_car_is_of_students_distribution(k):
    """Its 80 % interval: cars that leave nothing open scatter, and nothing else does."""
    cars = [alike(car_table(n, level=level)) for n, level in enumerate(LEVELS[:k])]
    found = one_more(cars, np.full(k, 1.0 / k), 40_000)
    mean, sigma = np.mean(LEVELS[:k]), np.std(LEVELS[:k], ddof=1)
    half = t.ppf(0.9, k - 1) * sigma * np.sqrt(1.0 + 1.0 / k)
    ends = np.quantile(found.log_pad_level, [0.1, 0.9])
    np.testing.assert_allclose(ends, [mean - half, mean + half], atol=0.05 * half)
    assert np.ptp(found.peak) < 1e-12


def test_what_a_car_leaves_open_is_what_one_more_car_does():
    car = car_table(1)
    found = one_more([car, car_table(2)], np.array([0.5, 0.5]), 20_000)
    for name, own in vars(car.draws).items():
        assert np.std(getattr(found, name)) == pytest.approx(np.std(own), rel=0.02, abs=1e-12)


def test_a_car_counts_by_its_weight():
    cars = [car_table(1), car_table(2)]
    cars[1] = replace(cars[1], draws=replace(cars[1].draws, peak=cars[1].draws.peak + 10.0))
    found = one_more(cars, np.array([0.2, 0.8]), 1000)
    assert np.sum(found.peak > 5.0) == 800
