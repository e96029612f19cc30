"""The objects of the C header as an A2L describes them: scaling, limits, number format."""

import math
import sys
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from calib.exports.dataset import Axis, Curve, Dataset, Scalar
from calib.exports.fixed_point import Fixed, fixed_axis, to_fixed
from calib.statistics.intervals import Z95
from calib.table.table import Array

DIGITS = 7
"""Significant digits that a tool shows of the largest number of an object in double."""

MOST_DECIMALS = 15

DOUBLE = (-sys.float_info.max, sys.float_info.max)
"""Range of double."""


@dataclass(frozen=True)
class A2lItem:
    """An object: ``kind`` AXIS_PTS, CURVE or VALUE; a curve has its ``axis``.

    ``limits`` of the numbers with their 95 % band, ``type_limits`` of the type in C [unit];
    ``step``, ``origin`` of the fixed point [unit], step None in double; ``form`` as ``%8.3``.
    """

    label: str
    kind: str
    meaning: str
    unit: str
    points: int
    limits: tuple[float, float]
    type_limits: tuple[float, float]
    step: float | None
    origin: float
    form: str
    axis: "A2lItem | None" = None


def items(data: Dataset, bits: int | None) -> Iterator[A2lItem]:
    """Every object of ``data``, axes first. Raises ExchangeError as `fixed_axis` does."""
    axes = {axis.label: _axis(axis, bits) for axis in data.axes}
    yield from axes.values()
    for curve in data.curves:
        yield _curve(curve, axes[curve.axis], bits)
    for scalar in data.scalars:
        yield _scalar(scalar, bits)


def _axis(axis: Axis, bits: int | None) -> A2lItem:
    fixed = None if bits is None else fixed_axis(axis, bits)
    return _item(axis, "AXIS_PTS", axis.values, axis.values, fixed, bits)


def _curve(curve: Curve, axis: A2lItem, bits: int | None) -> A2lItem:
    fixed = None if bits is None else to_fixed(curve.values, bits)
    band = np.concatenate((curve.values, curve.lower, curve.upper))
    return _item(curve, "CURVE", curve.values, band, fixed, bits, axis)


def _scalar(scalar: Scalar, bits: int | None) -> A2lItem:
    values, half = np.array([scalar.value]), Z95 * (scalar.sigma or 0.0)
    fixed = None if bits is None else to_fixed(values, bits)
    return _item(scalar, "VALUE", values, scalar.value + np.array([-half, half]), fixed, bits)


def _item(
    one: Axis | Curve | Scalar, kind: str, values: Array, band: Array, fixed: Fixed | None,
    bits: int | None, axis: A2lItem | None = None,
) -> A2lItem:  # fmt: skip
    largest = float(np.abs(values).max())
    step, origin, type_limits = None, 0.0, DOUBLE
    if fixed is not None and bits is not None:
        step, origin, values = fixed.step, fixed.origin, fixed.values
        half = step * 2.0 ** (bits - 1)
        type_limits = (origin - half, origin + half - step)
    finest = step or largest * 10.0**-DIGITS
    band = np.concatenate((values, band[np.isfinite(band)]))
    limits = (max(float(band.min()), type_limits[0]), min(float(band.max()), type_limits[1]))
    return A2lItem(
        one.label, kind, one.meaning, one.unit, len(values), limits, type_limits,
        step, origin, _form(largest, finest), axis,
    )  # fmt: skip


def _form(largest: float, finest: float) -> str:
    """Format with a sign, the digits before the point, and decimals that show ``finest``.

    >>> _form(1744.0, 0.5), _form(0.0, 0.0)
    ('%7.1', '%4.1')
    """
    decimals = math.ceil(-math.log10(finest)) if finest > 0.0 else 1
    decimals = min(max(decimals, 0), MOST_DECIMALS)
    return f"%{len(str(int(largest))) + decimals + 2}.{decimals}"
