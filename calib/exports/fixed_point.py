"""Numbers as integers with a binary scaling: value = origin + raw * 2^-shift.

The scaling is the finest whose integers fit the width, so that the rounding error is at most half a
step, 2^-(shift + 1). An axis that is not strictly increasing after rounding is refused.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.base.errors import ExchangeError
from calib.exports.breakpoints import Misfit, misfit
from calib.exports.dataset import Axis, Curve, Dataset
from calib.table.table import Array

BITS = (8, 16, 32)
"""Widths of the signed integer types of C [bit]."""

FINEST = 52
"""Largest shift: the step is then that of a double at 1."""


@dataclass(frozen=True)
class Fixed:
    """Integers ``raw`` (n,), ``origin`` and ``shift``; ``error`` is the largest rounding error.

    ``origin`` and ``error`` are in the unit of the values.
    """

    raw: NDArray[np.int64]
    origin: float
    shift: int
    error: float

    @property
    def step(self) -> float:
        """Value of one step of the integers."""
        return math.ldexp(1.0, -self.shift)

    @property
    def values(self) -> Array:
        """Values of the integers, origin + step * raw (n,)."""
        return self.origin + np.ldexp(self.raw.astype(np.float64), -self.shift)


def to_fixed(values: Array, bits: int, origin: float = 0.0) -> Fixed:
    """Nearest integers of ``bits`` (signed) for ``values`` (n,).

    Raises ExchangeError for a width that C does not have.
    """
    if bits not in BITS:
        raise ExchangeError(
            f"fixed point of {bits} bits", expected="one of " + ", ".join(map(str, BITS))
        )
    away = values - origin
    largest, most = float(np.abs(away).max()), 2 ** (bits - 1) - 1
    shift = min(FINEST, _finest(largest, most)) if largest > 0.0 else 0
    raw = np.rint(np.ldexp(away, shift)).astype(np.int64)
    found = Fixed(raw, origin, shift, 0.0)
    return Fixed(raw, origin, shift, float(np.abs(found.values - values).max()))


def _finest(largest: float, most: int) -> int:
    """Greatest shift at which ``largest`` is at most ``most`` steps; computed without overflow."""
    shift = math.floor(math.log2(most) - math.log2(largest))
    return shift if math.ldexp(largest, min(shift, FINEST)) <= most else shift - 1


def fixed_axis(axis: Axis, bits: int) -> Fixed:
    """Axis as integers that still increase strictly. Raises ExchangeError when they do not."""
    found = to_fixed(axis.values, bits, axis.origin)
    together = np.flatnonzero(np.diff(found.raw) <= 0)
    if together.size:
        at = float(axis.values[together[0]])
        raise ExchangeError(
            f"in {bits} bits the breakpoints at {at:.8g} and above it become equal",
            where=axis.label,
            expected="an axis that increases strictly",
            do="take fewer points or more bits",
        )
    return found


def fixed_misfit(axis: Axis, curve: Curve, bits: int) -> Misfit:
    """Error of a curve over its axis, both rounded, against the curve before rounding."""
    x, y = fixed_axis(axis, bits).values, to_fixed(curve.values, bits).values
    return misfit(axis.values, curve.values[None], x, y[None])


@dataclass(frozen=True)
class Rounding:
    """Errors of fixed point in one object: ``error`` is the largest of its numbers.

    ``read_error`` is that of a curve over its rounded axis; None for axes and scalars.
    """

    label: str
    step: float
    error: float
    read_error: float | None


def fixed_objects(data: Dataset, bits: int) -> dict[str, Fixed]:
    """Every object of ``data`` by label. Raises ExchangeError as `fixed_axis`."""
    axes = {axis.label: fixed_axis(axis, bits) for axis in data.axes}
    others = {name: to_fixed(x, bits) for name, x in data.arrays.items() if name not in axes}
    return axes | others


def roundings(data: Dataset, bits: int) -> list[Rounding]:
    """The rounding of every object of ``data`` in integers of ``bits``."""
    worst = {c.label: fixed_misfit(data.axis(c.axis), c, bits).worst for c in data.curves}
    return [
        Rounding(name, fixed.step, fixed.error, worst.get(name))
        for name, fixed in fixed_objects(data, bits).items()
    ]


def numbers_in_words(bits: int | None) -> str:
    """How the numbers of a file are written."""
    return "double" if bits is None else f"int{bits}_t, value = origin + step * raw"
