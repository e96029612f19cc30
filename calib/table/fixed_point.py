"""Numbers as integers with a binary scaling: value = origin + raw * 2^-shift.

The scaling is the finest that fits the width: the rounding error is at most 2^-(shift + 1).
"""

import math
from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array, Index
from calib.base.errors import ExchangeError

BITS = (8, 16, 32)
"""Widths of the signed integer types of C [bit]."""

FINEST = 52
"""Largest shift: the step is then that of a double at 1."""


@dataclass(frozen=True)
class Fixed:
    """Integers ``raw`` (n,) of ``bits``; ``error`` the largest rounding error, as the values."""

    raw: Index
    bits: int
    origin: float
    shift: int
    error: float = 0.0

    @property
    def step(self) -> float:
        """Value of one step of the integers."""
        return math.ldexp(1.0, -self.shift)

    @property
    def values(self) -> Array:
        """Values of the integers (n,)."""
        return self.origin + np.ldexp(self.raw.astype(np.float64), -self.shift)


def to_fixed(values: Array, bits: int, origin: float = 0.0) -> Fixed:
    """Nearest integers of ``bits`` (signed) for ``values`` (n,).

    Raises ExchangeError for a width that C does not have.
    """
    if bits not in BITS:
        expected = "one of " + ", ".join(map(str, BITS))
        raise ExchangeError(f"fixed point of {bits} bits", expected=expected)
    away = values - origin
    largest, most = float(np.abs(away).max()), 2 ** (bits - 1) - 1
    shift = min(FINEST, _finest(largest, most)) if largest > 0.0 else 0
    raw = np.rint(np.ldexp(away, shift)).astype(np.int64)
    error = np.abs(Fixed(raw, bits, origin, shift).values - values).max()
    return Fixed(raw, bits, origin, shift, float(error))


def _finest(largest: float, most: int) -> int:
    """Greatest shift at which ``largest`` is at most ``most`` steps; computed without overflow."""
    shift = math.floor(math.log2(most) - math.log2(largest))
    return shift if math.ldexp(largest, min(shift, FINEST)) <= most else shift - 1


def fixed_axis(label: str, values: Array, bits: int, origin: float) -> Fixed:
    """Axis as integers that still increase strictly. Raises ExchangeError when they do not."""
    found = to_fixed(values, bits, origin)
    if np.any(np.diff(found.raw) <= 0):
        raise ExchangeError(
            f"in {bits} bits some breakpoints become equal",
            where=label,
            expected="an axis that increases strictly",
            do="take fewer points or more bits",
        )
    return found
