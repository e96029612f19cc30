"""Sigma of the fleet: a closed form of two and more cars, and fleets drawn at random."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import norm, t

from calib.line.station.fleet_sigma import fleet_sigma
from calib.store.merge import merge
from tests.support.cars_of_a_line import car_table, cars, version


def as_rare(value, freedom):
    return math.copysign(norm.isf(t.sf(abs(value), freedom)), value)


GOLDEN = merge(cars(25.0, 27.0, 29.0), "golden")
"""D = 27 (eta - 1), S = 2 (eta - 1), three cars; no car has errors of its own."""


def test_D_of_a_car_over_scatter_and_error_of_the_mean():
    found = fleet_sigma(car_table(9, 33.0), GOLDEN)
    assert pytest.approx(as_rare(6.0 / (2.0 * math.sqrt(4.0 / 3.0)), 2), rel=1e-6) == found.D
    assert pytest.approx(-found.D, rel=1e-6) == fleet_sigma(car_table(9, 21.0), GOLDEN).D
    assert pytest.approx(0.0, abs=1e-6) == fleet_sigma(car_table(9, 27.0), GOLDEN).D


def test_pads_and_tyres_are_compared_where_D_is_the_same():
    made = [car_table(n, 27.0, 0.02 * n, -0.03 * n) for n in range(4)]
    golden = merge([version(table, n) for n, table in enumerate(made, 1)], "golden")
    S = np.std(range(4), ddof=1)
    found = fleet_sigma(car_table(9, 27.0, 0.02 * 6.0, -0.03 * 6.0), golden)
    away = as_rare((6.0 - 1.5) / (S * math.sqrt(1.25)), 3)
    assert pytest.approx(0.0, abs=1e-6) == found.D
    assert found.pad_ratio == pytest.approx(-away, rel=1e-6)
    assert found.pad_level == pytest.approx(away, rel=0.02)  # the shares move a little
    assert found.stiffness == 0.0


def test_the_own_error_of_the_car_counts(fitted):
    """A car measured by itself is nearer, in sigma, than one that is known exactly."""
    two = replace(fitted, provenance=replace(fitted.provenance, logs=()))
    stiffer = tuple(
        m - 0.05 * (n == "log_compliance")
        for n, m in zip(fitted.posterior.names, fitted.posterior.mean, strict=True)
    )
    other = replace(two, posterior=replace(two.posterior, mean=stiffer))
    golden = merge([version(fitted, 1), version(other, 2)], "golden")
    exact = replace(fitted, budget=None)
    assert abs(fleet_sigma(fitted, golden).stiffness) < abs(fleet_sigma(exact, golden).stiffness)


def test_two_cars_say_that_they_know_little():
    """The same six standard deviations are 1.1 sigma of two cars, and 3.6 of six."""
    of = {2: (25.0, 29.0), 6: (25.0, 29.0) * 3}
    sigma = {}
    for k, stiffness in of.items():
        golden = merge(cars(*stiffness), "golden")
        between = golden.spread.D[-1].between / 0.005
        sigma[k] = fleet_sigma(car_table(99, 27.0 + 6.0 * between), golden).D
    assert sigma[2] < 2.0
    assert sigma[6] > 3.0


def test_a_golden_table_of_one_car_knows_no_fleet():
    assert fleet_sigma(car_table(1), car_table(2)) is None


def test_a_car_with_a_short_table_has_no_sigma_of_D_but_of_its_pads():
    car = car_table(9)
    d = car.difference
    short = replace(car, difference=replace(d, **{n: getattr(d, n)[:8] for n in vars(d)}))
    found = fleet_sigma(short, GOLDEN)
    assert found.D is None
    assert found.stiffness == pytest.approx(0.0, abs=0.1)


@pytest.mark.parametrize("k", [3, 6])
def test_a_car_of_the_fleet_is_within_its_sigma_as_often_as_it_should(k):
    """150 golden tables, four more cars each: 95 % within 1.96, and next to all within 3."""
    rng = np.random.default_rng(k)
    found = []
    for _ in range(150):
        golden = merge(cars(*rng.normal(27.0, 1.0, k).tolist()), "golden")
        found += [
            abs(fleet_sigma(car_table(99, float(x)), golden).D) for x in rng.normal(27.0, 1.0, 4)
        ]
    assert 0.92 < np.mean(np.array(found) < 1.96) < 0.98
    assert np.mean(np.array(found) < 3.0) > 0.985
