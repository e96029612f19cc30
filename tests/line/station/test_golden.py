"""A car against golden tables whose distance is a closed form."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import norm, t

from calib.line.station.golden import golden_metrics
from calib.store.merge import merge
from tests.support.cars_of_a_line import car_table, cars, version
from tests.support.tables import made_table


def shortened(table):
    d = table.difference
    return replace(table, difference=replace(d, **{n: getattr(d, n)[:8] for n in vars(d)}))


@pytest.mark.parametrize("stiffness", [20.0, 27.0, 30.0])
def test_the_distance_is_that_of_the_stiffnesses(stiffness):
    metrics = golden_metrics(made_table(stiffness), made_table(27.0))
    assert metrics["golden_distance"] == pytest.approx(abs(stiffness / 27.0 - 1.0))
    # both bands are 2 (eta - 1) to either side
    assert metrics["golden_bands"] == pytest.approx(abs(stiffness - 27.0) / (2.0 * 2.0**0.5))


def test_a_short_table_has_no_distance():
    golden = made_table()
    assert "golden_distance" in golden_metrics(golden, shortened(golden))
    metrics = golden_metrics(shortened(car_table(9)), GOLDEN)
    assert {"golden_distance", "golden_sigma_d"} & set(metrics) == set()
    assert metrics["golden_sigma_stiffness"] == pytest.approx(0.0, abs=0.1)


def test_pads_and_tyres_are_compared_where_D_is_the_same():
    golden = made_table()
    cal = golden.calibration
    front = replace(cal.pad_friction_f, value=0.8 * cal.pad_friction_f.value)
    softer = replace(cal.slip_stiffness, value=cal.slip_stiffness.value / 1.25)
    table = replace(golden, calibration=replace(cal, pad_friction_f=front, slip_stiffness=softer))
    assert golden_metrics(table, golden) == {
        "golden_distance": 0.0,
        "golden_bands": 0.0,
        "golden_pads_f": pytest.approx(-0.2),
        "golden_pads_r": pytest.approx(0.0),
        "golden_stiffness": pytest.approx(1.0 / 1.25 - 1.0),
    }


def as_rare(value, freedom):
    return math.copysign(norm.isf(t.sf(abs(value), freedom)), value)


def sigma(table, golden, name="d"):
    return golden_metrics(table, golden)[f"golden_sigma_{name}"]


GOLDEN = merge(cars(25.0, 27.0, 29.0), "golden")
"""D = 27 (eta - 1), S = 2 (eta - 1), three cars; no car has errors of its own."""


def test_D_of_a_car_over_scatter_and_error_of_the_mean():
    away = as_rare(6.0 / (2.0 * math.sqrt(4.0 / 3.0)), 2)
    for stiffness, expected in ((33.0, away), (21.0, -away), (27.0, 0.0)):
        metrics = sigma(car_table(9, stiffness), GOLDEN)
        assert metrics == pytest.approx(expected, rel=1e-6, abs=1e-6)


def test_sigma_of_pads_and_tyres_where_D_is_the_same():
    tables = [car_table(n, 27.0, 0.02 * n, -0.03 * n) for n in range(4)]
    golden = merge([version(table, n) for n, table in enumerate(tables, 1)], "golden")
    scatter = np.std(range(4), ddof=1)
    car = car_table(9, 27.0, 0.02 * 6.0, -0.03 * 6.0)
    away = as_rare((6.0 - 1.5) / (scatter * math.sqrt(1.25)), 3)
    assert sigma(car, golden) == pytest.approx(0.0, abs=1e-6)
    assert sigma(car, golden, "ratio") == pytest.approx(-away, rel=1e-6)
    assert sigma(car, golden, "level") == pytest.approx(away, rel=0.02)  # the shares move a little
    assert sigma(car, golden, "stiffness") == 0.0
