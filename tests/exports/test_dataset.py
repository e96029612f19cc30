"""Labels that are valid in every format, the rows that are kept, and numbers in fixed point."""

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from calib.base.errors import ExchangeError
from calib.car.balance import force_balance
from calib.car.effects.effects import Effects
from calib.estimation.baselines import _by_curves
from calib.exports.build import build
from calib.exports.symbols import LONGEST, LONGEST_PREFIX, label, prefix
from calib.exports.write import printable
from calib.table.exported import BITS, Precision

# C99, 6.4.2.1, without the names that C and C++ keep for themselves.
IDENTIFIER = re.compile(r"[A-Za-z](_?[A-Za-z0-9])*")


@given(st.text(), st.from_regex(r"[a-z](_?[a-z0-9]){0,60}", fullmatch=True))
def test_any_name_gives_identifiers(name, part):
    word = label(prefix(name), part)
    assert IDENTIFIER.fullmatch(prefix(name))
    assert IDENTIFIER.fullmatch(word)
    assert (len(prefix(name)) <= LONGEST_PREFIX, len(word) <= LONGEST) == (True, True)
    assert len(printable(name).splitlines()) <= 1


def test_ends_are_clamped_as_the_look_up_does(stored):
    """What every file says of the ends is what `_by_curves` does."""
    z, eta, car = np.full(2, 0.1), np.array([0.9, 1.1]), stored.table.vehicle
    curves = {c.label: c.values for c in build(stored).curves}
    b = force_balance(car, Effects(), z, z, z, z)
    brake_f, brake_r = _by_curves(stored.table, eta, b)
    F_f, F_r = (brake_f + b.drag_f) / b.load_f, (brake_r + b.drag_r) / b.load_r
    assert (F_f - z).tolist() == pytest.approx(curves["sedan_f1"][[0, -1]].tolist())
    assert (F_r - z).tolist() == pytest.approx(curves["sedan_f2"][[0, -1]].tolist())


numbers = arrays(np.float64, st.integers(1, 30), elements=st.floats(-1e6, 1e6))


@given(numbers, st.sampled_from(BITS))
def test_integers_fit_lie_within_half_a_step_and_are_the_finest(values, bits):
    fixed = Precision(bits=bits).numbers(values).fixed
    assert np.all(np.abs(fixed.raw) < 2 ** (bits - 1))
    back = np.array([int(r) * 2.0**-fixed.shift for r in fixed.raw])
    assert np.abs(back - values).max() == fixed.error
    assert fixed.error <= 2.0 ** -(fixed.shift + 1) * (1 + 1e-12)
    largest = np.abs(values).max()
    finest = largest * 2.0 ** (fixed.shift + 1) > 2 ** (bits - 1) - 1
    assert finest or fixed.shift == 52 or largest == 0.0


@given(st.lists(st.floats(1e-5, 1e-2), min_size=2, max_size=60), st.sampled_from(BITS))
def test_an_axis_increases_or_is_refused(steps, bits):
    eta = 1.0 + np.concatenate([[0.0], np.cumsum(steps)])
    how = Precision(bits=bits)
    rounded = np.rint((eta - 1.0) * 2.0 ** how.numbers(eta, 1.0).fixed.shift)
    if np.all(np.diff(rounded) > 0):
        assert np.all(np.diff(how.axis("eta", eta, 1.0).ecu_values) > 0)
    else:
        with pytest.raises(ExchangeError, match="become equal"):
            how.axis("eta", eta, 1.0)
