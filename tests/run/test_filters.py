"""Means and stretches against the plain ones of numpy."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from calib.run.filters import centred_mean, low_pass, runs, trailing_mean

floats = st.lists(st.floats(-1e3, 1e3), min_size=1, max_size=60)


@given(x=arrays(float, st.integers(1, 40), elements=st.floats(-1e3, 1e3)), width=st.integers(1, 9))
def test_centred_mean_is_the_mean_around_each(x, width):
    first = width // 2
    expected = [x[max(i - first, 0) : i - first + width].mean() for i in range(x.size)]
    np.testing.assert_allclose(centred_mean(x, width), expected, atol=1e-9)


@given(x=arrays(float, st.integers(1, 40), elements=st.floats(-1e3, 1e3)), width=st.integers(1, 9))
def test_held_ends_repeat_the_first_and_the_last_value(x, width):
    padded = np.concatenate([np.full(width, x[0]), x, np.full(width, x[-1])])
    start = width - width // 2
    expected = [padded[i + start : i + start + width].mean() for i in range(x.size)]
    np.testing.assert_allclose(centred_mean(x, width, held_ends=True), expected, atol=1e-9)


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


@given(floats, floats, st.integers(1, 20))
def test_trailing_mean_knows_nothing_of_the_future(past, future, n):
    short = trailing_mean(np.array(past), n)
    assert np.array_equal(trailing_mean(np.array(past + future), n)[: len(past)], short)


@given(mask=arrays(bool, st.integers(0, 40)))
def test_runs_tile_the_mask(mask):
    rebuilt = np.zeros_like(mask)
    for start, end in runs(mask):
        assert start < end
        assert not rebuilt[max(start - 1, 0) : end].any()  # apart from the one before
        rebuilt[start:end] = True
    assert np.array_equal(rebuilt, mask)
