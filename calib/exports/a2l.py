"""A2L, ASAM MCD-2 MC 1.7.1: what the objects of the C header are, where, and how to read them.

    RECORD_LAYOUT   numbers one after the other: FLOAT64_IEEE, SBYTE, SWORD or SLONG
    COMPU_METHOD    of each object: identical, or value = origin + step * raw in fixed point
    AXIS_PTS        each axis, also that of the tyre's curve: in C it is an array of its own
    CHARACTERISTIC  CURVE over such an axis (COM_AXIS), VALUE for a scalar
    FUNCTION        all of them, under the name they have in DCM

Limits are those of the 95 % band, extended limits those of the type in C. The file has no values
and no interface (IF_DATA): it is meant to be merged into the A2L of the ECU.
"""

import math
import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from calib.base.errors import ExchangeError
from calib.base.intervals import Z95
from calib.exports.addresses import Addresses
from calib.exports.dataset import Axis, Curve, Dataset, Scalar, label, printable
from calib.exports.dcm import FUNCTION
from calib.exports.fixed_point import Fixed, fixed_objects, numbers_in_words
from calib.table.table import Array

DIGITS = 7
"""Significant digits that a tool shows of the largest number of an object in double."""

MOST_DECIMALS = 15

DOUBLE = (-sys.float_info.max, sys.float_info.max)
"""Range of double."""


@dataclass(frozen=True)
class _Item:
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
    axis: "_Item | None" = None


def _items(data: Dataset, bits: int | None) -> Iterator[_Item]:
    """Every object of ``data``, axes first. Raises ExchangeError as `fixed_axis` does."""
    fixed = {} if bits is None else fixed_objects(data, bits)
    axes = {}
    for axis in data.axes:
        item = _item(axis, "AXIS_PTS", axis.values, axis.values, fixed.get(axis.label), bits)
        axes[axis.label] = item
        yield item
    for c in data.curves:
        band = np.concatenate((c.values, c.lower, c.upper))
        yield _item(c, "CURVE", c.values, band, fixed.get(c.label), bits, axes[c.axis])
    for s in data.scalars:
        half = Z95 * (s.sigma or 0.0)
        band = s.value + np.array([-half, half])
        yield _item(s, "VALUE", np.array([s.value]), band, fixed.get(s.label), bits)


def _item(
    one: Axis | Curve | Scalar, kind: str, values: Array, band: Array, fixed: Fixed | None,
    bits: int | None, axis: _Item | None = None,
) -> _Item:  # fmt: skip
    largest = float(np.abs(values).max())
    step, origin, type_limits = None, 0.0, DOUBLE
    if fixed is not None and bits is not None:
        step, origin, values = fixed.step, fixed.origin, fixed.values
        half = step * 2.0 ** (bits - 1)
        type_limits = (origin - half, origin + half - step)
    finest = step or largest * 10.0**-DIGITS
    band = np.concatenate((values, band[np.isfinite(band)]))
    limits = (max(float(band.min()), type_limits[0]), min(float(band.max()), type_limits[1]))
    return _Item(
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


TYPES = {None: "FLOAT64_IEEE", 8: "SBYTE", 16: "SWORD", 32: "SLONG"}
"""Data type of the standard by width of the fixed point; None is double."""

LONGEST_TEXT = 255
"""Most characters of a text of the standard."""

BOM = b"\xef\xbb\xbf"
"""Mark of UTF-8, which the standard demands where a file is not ASCII."""


def write_a2l(data: Dataset, bits: int | None, addresses: Addresses) -> bytes:
    """A2L file of ``data`` in double, or in signed integers of ``bits``; UTF-8.

    Raises ExchangeError for a width that C does not have, where a rounded axis is not strictly
    increasing, or where a text is too long.
    """
    described, origin = list(_items(data, bits)), f"table {data.id}, digest {data.digest}"
    lines = ["ASAP2_VERSION 1 71", *_comment(data, bits, addresses)]
    lines += [f"/begin PROJECT {data.prefix} {_text(data.id)}"]
    lines += [f"  /begin HEADER {_text(origin)}", f'    VERSION "{data.version}"', "  /end HEADER"]
    lines += [f"  /begin MODULE {data.prefix} {_text(origin)}"]
    body = [*_common(data, addresses), *_layouts(data, bits)]
    for item in described:
        body += ["", *_method(item, data), *_object(item, data, bits, addresses)]
    lines += [f"    {line}".rstrip() for line in [*body, "", *_function(data, origin)]]
    lines += ["  /end MODULE", "/end PROJECT"]
    text = "\n".join(lines) + "\n"
    return (b"" if text.isascii() else BOM) + text.encode()


def _comment(data: Dataset, bits: int | None, addresses: Addresses) -> Iterator[str]:
    facts = [*data.facts().items(), ("numbers", numbers_in_words(bits))]
    yield "/*"
    for key, text in [*facts, *(("addresses", remark) for remark in addresses.remarks)]:
        yield f" * {_plain(f'{key}: {text}')}"
    yield " */"


def _common(data: Dataset, addresses: Addresses) -> Iterator[str]:
    order = "MSB_FIRST" if addresses.big_endian else "MSB_LAST"
    yield '/begin MOD_COMMON "memory of the C header"'
    yield f"  BYTE_ORDER {order}"
    yield "  DEPOSIT ABSOLUTE"
    yield "/end MOD_COMMON"


def _layouts(data: Dataset, bits: int | None) -> Iterator[str]:
    yield f"/begin RECORD_LAYOUT {_layout(data, True)}"
    yield f"  AXIS_PTS_X 1 {TYPES[bits]} INDEX_INCR DIRECT"
    yield "/end RECORD_LAYOUT"
    yield f"/begin RECORD_LAYOUT {_layout(data, False)}"
    yield f"  FNC_VALUES 1 {TYPES[bits]} COLUMN_DIR DIRECT"
    yield "/end RECORD_LAYOUT"


def _layout(data: Dataset, axis: bool) -> str:
    return label(data.prefix, "points" if axis else "values")


def _method(item: _Item, data: Dataset) -> Iterator[str]:
    name, form, unit = _method_of(item), f'"{item.form}"', _text(item.unit)
    if item.step is None:
        yield f'/begin COMPU_METHOD {name} "value = raw" IDENTICAL {form} {unit}'
    else:
        yield f'/begin COMPU_METHOD {name} "value = origin + step * raw" LINEAR {form} {unit}'
        yield f"  COEFFS_LINEAR {item.step!r} {item.origin!r}"
    yield "/end COMPU_METHOD"


def _method_of(item: _Item) -> str:
    return label(item.label, "cm")


def _object(item: _Item, data: Dataset, bits: int | None, addresses: Addresses) -> Iterator[str]:
    kind = "AXIS_PTS" if item.kind == "AXIS_PTS" else "CHARACTERISTIC"
    at, limits = f"0x{addresses.of(item.label):08X}", _pair(item.limits)
    layout = _layout(data, item.kind == "AXIS_PTS")
    yield f"/begin {kind} {item.label} {_text(item.meaning)}"
    if item.kind == "AXIS_PTS":
        yield f"  {at} NO_INPUT_QUANTITY {layout} 0 {_method_of(item)} {item.points} {limits}"
        yield "  DEPOSIT ABSOLUTE"
        yield "  MONOTONY STRICT_INCREASE"
    else:
        yield f"  {item.kind} {at} {layout} 0 {_method_of(item)} {limits}"
    yield f"  EXTENDED_LIMITS {_pair(item.type_limits)}"
    yield f'  SYMBOL_LINK "{item.label}" 0'
    if item.axis is not None:
        axis = item.axis
        yield "  /begin AXIS_DESCR COM_AXIS NO_INPUT_QUANTITY"
        yield f"    {_method_of(axis)} {axis.points} {_pair(axis.limits)}"
        yield f"    AXIS_PTS_REF {axis.label}"
        yield "  /end AXIS_DESCR"
    yield f"/end {kind}"


def _function(data: Dataset, origin: str) -> Iterator[str]:
    yield f"/begin FUNCTION {data.prefix}_{FUNCTION} {_text(origin)}"
    yield f'  FUNCTION_VERSION "{data.version}"'
    yield "  /begin DEF_CHARACTERISTIC"
    yield from (f"    {axis.label}" for axis in data.axes)
    yield from (f"    {curve.label}" for curve in data.curves)
    yield from (f"    {scalar.label}" for scalar in data.scalars)
    yield "  /end DEF_CHARACTERISTIC"
    yield "/end FUNCTION"


def _pair(limits: tuple[float, float]) -> str:
    return f"{limits[0]!r} {limits[1]!r}"


def _plain(text: str) -> str:
    """``text`` on one line without marks of a comment: simple readers see them in texts, too."""
    plain = printable(text).replace("\\", "/")
    return re.sub(r"/(?=[/*])|\*(?=/)", r"\g<0> ", plain)


def _text(text: str) -> str:
    """A quoted text. Raises ExchangeError where the standard has no room for it."""
    plain = _plain(text).replace('"', "'")
    if len(plain) > LONGEST_TEXT:
        raise ExchangeError(
            f"{plain[:24]}... has {len(plain)} characters",
            expected=f"at most {LONGEST_TEXT} in a text of A2L",
            do="give the table a shorter name",
        )
    return f'"{plain}"'
