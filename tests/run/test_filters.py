"""Means, stretches and least squares of many fits against the plain ones of numpy."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from calib.run.filters import (
    centred_mean,
    inner_products,
    long_run_variance,
    low_pass,
    residual_squares,
    trailing_mean,
    true_intervals,
)

floats = st.lists(st.floats(-1e3, 1e3), min_size=1, max_size=60)


@given(x=arrays(float, st.integers(1, 40), elements=st.floats(-1e3, 1e3)), width=st.integers(1, 9))
def test_centred_mean_is_the_mean_around_each(x, width):
    first = width // 2
    expected = [x[max(i - first, 0) : i - first + width].mean() for i in range(x.size)]
    np.testing.assert_allclose(centred_mean(x, width), expected, atol=1e-9)


def test_low_pass_follows_a_step_as_its_time_constant_says():
    step = np.concatenate([np.zeros(10), np.ones(400)])
    y = low_pass(step, 0.01, 0.5)
    assert np.all(y[:10] == 0.0)
    # the n-th sample of the step has gone 1 - exp(-n dt/T) of the way
    assert y[10:] == pytest.approx(1.0 - np.exp(-0.01 * np.arange(1, 401) / 0.5))
    assert low_pass(np.full(5, 3.0), 0.01, 0.5) == pytest.approx(np.full(5, 3.0))


@given(floats, st.integers(1, 20))
def test_trailing_mean_is_the_plain_one(x, n):
    expected = [np.mean(x[max(0, i + 1 - n) : i + 1]) for i in range(len(x))]
    assert trailing_mean(np.array(x), n) == pytest.approx(expected, abs=1e-9)


@given(mask=arrays(bool, st.integers(0, 40)))
def test_intervals_tile_the_mask(mask):
    rebuilt = np.zeros_like(mask)
    for start, end in true_intervals(mask):
        assert start < end
        assert not rebuilt[max(start - 1, 0) : end].any()  # apart from the one before
        rebuilt[start:end] = True
    assert np.array_equal(rebuilt, mask)


def test_residuals_are_those_of_numpy_for_each_fit():
    rng = np.random.default_rng(0)
    columns = rng.normal(size=(7, 3, 40)) * rng.uniform(1e-3, 1e5, (7, 3, 1))
    y = rng.normal(size=40)
    for A, square in zip(columns, residual_squares(inner_products(columns, y)), strict=True):
        residual = y - A.T @ np.linalg.lstsq(A.T, y)[0]
        assert square == pytest.approx(float(residual @ residual), abs=1e-8 * float(y @ y))


def test_a_ridge_equals_rows_whose_right_side_is_zero():
    rng = np.random.default_rng(1)
    columns, y, ridge = rng.normal(size=(1, 3, 40)), rng.normal(size=40), np.array([0.0, 4.0, 9e2])
    rows, wanted = np.vstack([columns[0].T, np.diag(np.sqrt(ridge))]), np.append(y, np.zeros(3))
    residual = wanted - rows @ np.linalg.lstsq(rows, wanted)[0]
    square = residual_squares(inner_products(columns, y), ridge)[0]
    assert square == pytest.approx(float(residual @ residual), rel=1e-7)


def test_the_variance_of_held_noise_grows_with_the_hold():
    rng = np.random.default_rng(2)
    white = rng.normal(size=40_000)
    assert long_run_variance(white, 4) == pytest.approx(1.0, rel=0.05)
    assert long_run_variance(np.repeat(white, 4), 4) == pytest.approx(4.0, rel=0.05)
