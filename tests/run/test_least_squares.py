"""Least squares of many fits at a time against numpy's of each."""

import numpy as np
import pytest

from calib.run.least_squares import lasting_variance, squares_left


def test_what_is_left_is_numpy_s_for_each_fit():
    rng = np.random.default_rng(0)
    columns = rng.normal(size=(7, 3, 40)) * rng.uniform(1e-3, 1e5, (7, 3, 1))
    y = rng.normal(size=(7, 40))
    for one, of, square in zip(columns, y, squares_left(columns, y), strict=True):
        left = of - one.T @ np.linalg.lstsq(one.T, of)[0]
        assert square == pytest.approx(float(left @ left), abs=1e-8 * float(of @ of))


def test_a_ridge_is_as_rows_that_want_zero():
    rng = np.random.default_rng(1)
    columns, y, ridge = (
        rng.normal(size=(1, 3, 40)),
        rng.normal(size=40),
        np.array([0.0, 4.0, 900.0]),
    )
    rows, wanted = np.vstack([columns[0].T, np.diag(np.sqrt(ridge))]), np.append(y, np.zeros(3))
    left = wanted - rows @ np.linalg.lstsq(rows, wanted)[0]
    assert squares_left(columns, y, ridge)[0] == pytest.approx(float(left @ left), rel=1e-7)


def test_zero_and_doubled_columns_add_nothing():
    x, y = np.arange(5.0), np.array([1.0, 0.0, 2.0, -1.0, 3.0])
    alone = squares_left(x[None, None], y)
    assert squares_left(np.array([[x, 0.0 * x, 3.0 * x]]), y) == pytest.approx(alone)


def test_an_error_that_lasts_counts_for_as_long():
    rng = np.random.default_rng(2)
    white = rng.normal(size=40_000)
    assert lasting_variance(white, 4) == pytest.approx(1.0, rel=0.05)
    assert lasting_variance(np.repeat(white, 4), 4) == pytest.approx(4.0, rel=0.05)
