import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from calib.base.errors import ExchangeError
from calib.exports.breakpoints import Misfit
from calib.exports.build import build
from calib.exports.dataset import Axis
from calib.exports.fixed_point import BITS, fixed_axis, fixed_misfit, roundings, to_fixed

numbers = arrays(np.float64, st.integers(1, 30), elements=st.floats(-1e6, 1e6))
widths = st.sampled_from(BITS)


@given(numbers, widths)
def test_integers_fit_and_lie_within_half_a_step(values, bits):
    fixed = to_fixed(values, bits)
    assert np.all(np.abs(fixed.raw) < 2 ** (bits - 1))
    back = np.array([int(r) * 2.0**-fixed.shift for r in fixed.raw])
    assert np.abs(back - values).max() == fixed.error
    assert fixed.error <= 2.0 ** -(fixed.shift + 1) * (1 + 1e-12)


@given(st.floats(1e-6, 1e6), widths)
def test_the_scaling_is_the_finest_that_fits(largest, bits):
    fixed = to_fixed(np.array([largest]), bits)
    assert fixed.shift == 52 or largest * 2.0 ** (fixed.shift + 1) > 2 ** (bits - 1) - 1


@given(st.lists(st.floats(1e-5, 1e-2), min_size=2, max_size=60), widths)
def test_an_axis_increases_or_is_refused(steps, bits):
    eta = 1.0 + np.concatenate([[0.0], np.cumsum(steps)])
    axis = Axis("eta", "eta", "1", eta, True, 1.0, len(eta), Misfit(0.0, 1.0, 0.0))
    rounded = np.rint((eta - 1.0) * 2.0 ** to_fixed(eta, bits, 1.0).shift)
    if np.all(np.diff(rounded) > 0):
        assert np.all(np.diff(fixed_axis(axis, bits).values) > 0)
    else:
        with pytest.raises(ExchangeError, match="become equal"):
            fixed_axis(axis, bits)


def test_two_breakpoints_that_fall_together_are_named():
    axis = Axis("eta", "eta", "1", np.array([1.0, 1.5, 1.5001, 2.0]), True, 1.0, 4,
                Misfit(0.0, 1.0, 0.0))  # fmt: skip
    with pytest.raises(ExchangeError, match=r"in 8 bits the breakpoints at 1\.5 and above it"):
        fixed_axis(axis, 8)
    assert np.all(np.diff(fixed_axis(axis, 16).raw) > 0)


@pytest.mark.parametrize("bits", [16, 32])
def test_the_reading_error_is_found_on_a_grid_too(real, bits):
    data = build(real, 16)
    for curve in data.curves:
        axis = data.axis(curve.axis)
        x, y = fixed_axis(axis, bits).values, to_fixed(curve.values, bits).values
        grid = np.linspace(axis.values[0], axis.values[-1], 4001)
        gap = np.abs(np.interp(grid, x, y) - np.interp(grid, axis.values, curve.values)).max()
        worst = fixed_misfit(axis, curve, bits).worst
        assert 0.9 * worst <= gap <= worst * (1 + 1e-9)


def test_every_object_is_reported(stored):
    data = build(stored)
    assert len(roundings(data, 16)) == len(data.axes) + len(data.curves) + len(data.scalars)


def test_more_bits_round_less(real):
    coarse, fine = (
        {r.label: r.error for r in roundings(build(real, 8), bits)} for bits in (16, 32)
    )
    assert all(fine[name] <= coarse[name] for name in coarse)
    assert math.isclose(coarse[f"{build(real).prefix}_version"], 0.0)


def test_other_widths_are_refused():
    with pytest.raises(ExchangeError, match="12 bits; expected one of 8, 16, 32"):
        to_fixed(np.ones(1), 12)
