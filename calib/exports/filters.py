"""Texts and numbers as each format has them: the filters of the templates."""

import math
import re
import string
import sys
from typing import Any

import numpy as np

from calib.base.errors import ExchangeError
from calib.exports.dataset import Axis, Grid, Object, Scalar

_LONGEST_TEXT = 255  # characters of a text of A2L
_TYPES = {8: "SBYTE", 16: "SWORD", 32: "SLONG"}  # of A2L by width of the fixed point
_DIGITS = 7  # significant ones that a tool shows of the largest number of an object in double
_MOST_DECIMALS = 15


def printable(text: str) -> str:
    """``text`` on one line, without control characters."""
    return "".join(c if c.isprintable() else " " for c in text)


def quoted(text: str) -> str:
    """A quoted text of DCM, which has no escapes."""
    plain = printable(text).replace('"', "'").replace("\\", "/")
    return f'"{plain}"'


def commented(text: str) -> str:
    """``text`` on one line without marks of a comment: simple readers see them in texts, too."""
    plain = printable(text).replace("\\", "/")
    return re.sub(r"/(?=[/*])|\*(?=/)", r"\g<0> ", plain)


def short(text: str) -> str:
    """A quoted text of A2L. Raises ExchangeError where the standard has no room for it."""
    plain = commented(text).replace('"', "'")
    if len(plain) > _LONGEST_TEXT:
        raise ExchangeError(
            f"{plain[:24]}... has {len(plain)} characters",
            expected=f"at most {_LONGEST_TEXT} in a text of A2L",
            do="give the table a shorter name",
        )
    return f'"{plain}"'


def as_comment(text: str) -> str:
    """``text`` for a comment of C: without a begin or end of a comment and without trigraphs."""
    plain = "".join(c if " " <= c <= "~" and c not in "?\\" else "_" for c in text)
    return plain.replace("*/", "* /").replace("/*", "/ *").replace("//", "/ /")


def a2l_type(one: Object, single: bool) -> str:
    """Data type of A2L."""
    floating = "FLOAT32_IEEE" if single else "FLOAT64_IEEE"
    return floating if one.fixed is None else _TYPES[one.fixed.bits]


def made(one: Object) -> str:
    """How an object came about, for its history in CDF."""
    if isinstance(one, Scalar):
        return "fitted" + ("" if one.sigma is None else f"; one standard deviation {one.sigma!r}")
    axes = (one,) if isinstance(one, Axis) else one.axes
    return "; ".join(("fitted", one.span, *(axis.placed for axis in axes)))


def type_limits(one: Object) -> tuple[float, float]:
    """Range of the type in C [unit]."""
    if one.fixed is None:
        return -sys.float_info.max, sys.float_info.max
    half = one.fixed.step * 2.0 ** (one.fixed.bits - 1)
    return one.fixed.origin - half, one.fixed.origin + half - one.fixed.step


def limits(one: Object) -> tuple[float, float]:
    """Range of the numbers and their 95 % band, within that of the type [unit]."""
    values = one.values if one.fixed is None else one.fixed.values
    band = np.concatenate((values, one.band[np.isfinite(one.band)]))
    low, high = type_limits(one)
    return max(float(band.min()), low), min(float(band.max()), high)


def display_format(one: Object) -> str:
    """Format of A2L: the sign, the digits before the point, and decimals that show one step."""
    largest = float(np.abs(one.values).max())
    finest = largest * 10.0**-_DIGITS if one.fixed is None else one.fixed.step
    decimals = math.ceil(-math.log10(finest)) if finest > 0.0 else 1
    decimals = min(max(decimals, 0), _MOST_DECIMALS)
    return f"%{len(str(int(largest))) + decimals + 2}.{decimals}"


def c_type(one: Object, single: bool) -> str:
    """Type of a constant of the C header."""
    floating = "float" if single else "double"
    return floating if one.fixed is None else f"int{one.fixed.bits}_t"


def c_numbers(one: Object, single: bool) -> Any:
    """The numbers of a constant as C has them, those of a map nested as its axes are."""
    if one.fixed is None:
        numbers = one.values.astype(np.float32 if single else np.float64)
        texts = [f"{x!s}{'F' * single}" for x in numbers]
    else:
        texts = [f"{v}{'L' * (one.fixed.bits == 32)}" for v in one.fixed.raw.tolist()]
    shape = one.shape if isinstance(one, Grid) else (-1,)
    return np.array(texts, dtype=object).reshape(shape).tolist()


def c_string(text: str) -> str:
    """A string constant: octal of three digits for each byte that is not plain."""
    plain = string.ascii_letters + string.digits + "@-_. "
    return "".join(c if c in plain else f"\\{b:03o}" for b in text.encode() for c in [chr(b)])
