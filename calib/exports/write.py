"""Write a data set in each format: JSON and CSV by functions, the others by templates.

    json csv  for programs without calibration formats; a missing value is an empty cell
    dcm       conservation format 2.0 of ETAS, with German keywords. Range, digest and the number of
              objects are comments; the number shows a file that was cut off.
    cdfx      CDF 2.0 of ASAM: XML with one SW-INSTANCE per object, elements in the standard's order
    c-header  constants in C99 by MISRA C:2012: declared for every file (8.4, 8.11), defined only
              in the file that defines NAME_DEFINE before its #include (8.6)
    a2l       ASAM MCD-2 MC 1.7.1: types and addresses of the objects of the C header or of the
              code, without values and interface, to be merged into the A2L of the ECU

A map of three axes is a CUBOID. DCM has maps of two axes at most: a map of three is written as one
map for each value of its third axis. Every number is written so that it reads back to the last bit.
"""

import csv
import io
import json
import math
import re
import string
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from itertools import product
from typing import Any
from xml.sax.saxutils import escape

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import ExchangeError
from calib.base.intervals import Z95
from calib.base.templates import templates
from calib.exports.build import UNIT
from calib.exports.dataset import MOST_AXES, Axis, Dataset, Grid, Object, Scalar
from calib.exports.symbols import label

_FUNCTION = "brake_torque"  # function of the ECU to which the objects belong
_NO_UNIT = "-"  # unit [1] in CSV: a reader that guesses types would take 1 for an integer

COLUMNS = (
    "label", "axis", "x", "value", "unit", "lower", "upper", "count", "flag", "meaning",
)  # fmt: skip
"""Columns of CSV: ``value`` [unit] of ``label`` at ``x`` on ``axis``, with its 95 % bounds."""

_MORE_AXES = ("axis_2", "x_2", "axis_3", "x_3")  # further columns of a data set with maps

_BOM = b"\xef\xbb\xbf"  # marks UTF-8; A2L needs it unless all is ASCII
_LONGEST_TEXT = 255  # characters of a text of A2L
_A2L_TYPES = {8: "SBYTE", 16: "SWORD", 32: "SLONG"}  # by width of the fixed point [bit]
_DIGITS = 7  # significant digits of the largest number of an object that a tool shows
_MOST_DECIMALS = 15
MOST = 1e30  # limit of a number without limits: any floating point holds it


def _write_json(data: Dataset) -> bytes:
    def fields_of(constant: Object, *keys: str) -> dict[str, Any]:
        return {key: getattr(constant, key) for key in keys}

    axes = [
        fields_of(x, "label", "meaning", "unit", "values", "shared", "origin", "rows", "misfit")
        for x in data.axes
    ]
    curves = [
        {"label": x.label, "axis": x.axis.label} | fields_of(x, "meaning", "unit", "values")
        | _bounds(x) | fields_of(x, "count", "flag")
        for x in data.curves
    ]  # fmt: skip
    scalars = [
        fields_of(x, "label", "meaning", "unit") | {"value": x.numbers[0], "sigma": x.sigma}
        for x in data.scalars
    ]
    document = {"schema": 1, **data.facts(), "version": data.stored.version}
    document |= {"axes": axes, "curves": curves}
    if data.maps:
        document["maps"] = [_map(x) for x in data.maps if not x.is_bound]
    document |= {"scalars": scalars, "record": data.stored.table.content()[0]}

    def plain(value: Any) -> Any:
        return value.tolist() if isinstance(value, np.ndarray) else vars(value)

    return (json.dumps(document, indent=1, allow_nan=False, default=plain) + "\n").encode()


def _map(grid: Grid) -> dict[str, Any]:
    """Return a map with its bounds for JSON, nested as its axes are."""
    values = {"values": grid.values} | _bounds(grid)
    head = {"label": grid.label, "axes": [axis.label for axis in grid.axes]}
    head |= {"meaning": grid.meaning, "unit": grid.unit}
    return head | {name: x.reshape(grid.shape) for name, x in values.items()}


def _bounds(grid: Grid) -> dict[str, Array]:
    """Return the bounds of a grid by the keys of JSON, if it has any."""
    return dict(zip(("lower", "upper"), grid.bounds, strict=True)) if grid.bounds else {}


def _rows(data: Dataset) -> Iterator[tuple[str | float | None, ...]]:
    """Return the rows of CSV; the bounds of a map stand beside its medians."""
    for grid in (*data.curves, *data.maps):
        if not grid.is_bound:
            yield from _cells(grid)
    more = (None,) * len(_MORE_AXES)
    for s in data.scalars:
        band = (None, None) if s.sigma is None else _band(s).tolist()
        yield (s.label, None, None, s.numbers[0], s.unit, *band, None, None, s.meaning, *more)


def _cells(grid: Grid) -> Iterator[tuple[str | float | None, ...]]:
    """Return the rows of a curve or map, one for each of its values."""
    empty = np.full(grid.values.size, None)
    lower, upper = grid.bounds or (empty, empty)
    columns = [grid.values, lower, upper]
    columns += [empty if x is None else x for x in (grid.count, grid.flag)]
    places = product(*([(axis.label, x) for x in axis.numbers] for axis in grid.axes))
    missing = [None] * (2 * (MOST_AXES - len(grid.axes)))
    rows = zip(*(x.tolist() for x in columns), strict=True)
    for place, numbers in zip(places, rows, strict=True):
        (axis, x), *more = place
        value, *bounds_count_flag = numbers
        further = [*(cell for pair in more for cell in pair), *missing]  # axis_2, x_2, axis_3, x_3
        yield (grid.label, axis, x, value, grid.unit, *bounds_count_flag, grid.meaning, *further)


def _write_csv(data: Dataset) -> bytes:
    text = io.StringIO()
    # a spreadsheet would split a comment at its commas, and take a part of it for a formula
    facts = ((key, printable(fact).replace(",", ";")) for key, fact in data.facts().items())
    text.writelines(f"# {key}: {fact}\n" for key, fact in facts)
    table = csv.writer(text, lineterminator="\n")
    columns = COLUMNS + (_MORE_AXES if data.maps else ())
    for row in (columns, *_rows(data)):
        table.writerow(_NO_UNIT if cell == UNIT else cell for cell in row[: len(columns)])
    return text.getvalue().encode()


def printable(text: str) -> str:
    """Return a text on one line, without control characters."""
    return "".join(c if c.isprintable() else " " for c in text)


def _quoted(text: str) -> str:
    """Return a quoted text of DCM, which has no escapes."""
    plain = printable(text).replace('"', "'").replace("\\", "/")
    return f'"{plain}"'


def _without_comment_marks(text: str) -> str:
    """Return a text on one line without marks of comments, which simple readers see in texts."""
    plain = printable(text).replace("\\", "/")
    return re.sub(r"/(?=[/*])|\*(?=/)", r"\g<0> ", plain)


def _short(text: str) -> str:
    """Return a quoted text of A2L. Raises ExchangeError if it is longer than A2L allows."""
    plain = _without_comment_marks(text).replace('"', "'")
    if len(plain) > _LONGEST_TEXT:
        flaw = f"{plain[:24]}... has {len(plain)} characters"
        expected = f"at most {_LONGEST_TEXT} in a text of A2L"
        raise ExchangeError(flaw, expected=expected, do="give the table a shorter name")
    return f'"{plain}"'


def as_comment(text: str) -> str:
    """Return a text for a comment of C, without marks of comments and without trigraphs."""
    plain = "".join(c if " " <= c <= "~" and c not in "?\\" else "_" for c in text)
    return plain.replace("*/", "* /").replace("/*", "/ *").replace("//", "/ /")


def _origin_of(constant: Object) -> str:
    """Return how an object was made, for its history in CDF."""
    if isinstance(constant, Scalar):
        sigma = constant.sigma
        return "fitted" + ("" if sigma is None else f"; one standard deviation {sigma!r}")
    axes = (constant,) if isinstance(constant, Axis) else constant.axes
    return "; ".join(("fitted", constant.span, *(axis.placed for axis in axes)))


def _type_limits(constant: Object) -> tuple[float, float]:
    """Return the range of the type in C [unit]."""
    if constant.fixed is None:
        return -sys.float_info.max, sys.float_info.max
    half = constant.fixed.step * 2.0 ** (constant.fixed.bits - 1)
    return constant.fixed.origin - half, constant.fixed.origin + half - constant.fixed.step


def _band(scalar: Scalar) -> Array:
    """Return the 95 % bounds (2,) of a scalar."""
    return scalar.values + Z95 * (scalar.sigma or 0.0) * np.array([-1.0, 1.0])


def _limits(constant: Object) -> tuple[float, float]:
    """Return the range of the numbers with their 95 % bounds, within that of the type [unit]."""
    if constant.within is not None:  # a number of the C code has no limits
        return -MOST, MOST
    fixed = constant.fixed
    parts = [constant.values] if fixed is None else [fixed.values, constant.values]
    if isinstance(constant, Scalar):
        parts.append(_band(constant))
    elif isinstance(constant, Grid) and constant.count is not None:  # bounds of a map are grids
        parts += constant.bounds or ()
    numbers = np.concatenate(parts)
    finite = numbers[np.isfinite(numbers)]
    low, high = _type_limits(constant)
    return max(float(finite.min()), low), min(float(finite.max()), high)


def _display_format(constant: Object) -> str:
    """Return the format of A2L, %WIDTH.DECIMALS, that shows the smallest step of the numbers."""
    largest = float(np.abs(constant.values).max())
    finest = largest * 10.0**-_DIGITS if constant.fixed is None else constant.fixed.step
    decimals = math.ceil(-math.log10(finest)) if finest > 0.0 else 1
    decimals = min(max(decimals, 0), _MOST_DECIMALS)
    return f"%{len(str(int(largest))) + decimals + 2}.{decimals}"


def _c_numbers(constant: Object, single: bool) -> Any:
    """Return the numbers of an object in C, those of a map nested as its axes are."""
    if constant.fixed is None:
        numbers = constant.values.astype(np.float32 if single else np.float64)
        suffix = "F" if single else ""
    else:
        numbers, suffix = constant.fixed.raw, "L" if constant.fixed.bits == 32 else ""
    texts = [f"{x!s}{suffix}" for x in numbers]
    shape = constant.shape if isinstance(constant, Grid) else (-1,)
    return np.array(texts, dtype=object).reshape(shape).tolist()


def _c_string(text: str) -> str:
    """Return a string constant of C, with an octal escape for each byte that is not plain."""
    plain = (string.ascii_letters + string.digits + "@-_. ").encode()
    return "".join(chr(byte) if byte in plain else f"\\{byte:03o}" for byte in text.encode())


def _filled(name: str, text: Callable[[str], str], data: Dataset) -> bytes:
    """Return a file made from the template of a format; ``text`` quotes or escapes its texts."""
    c_float, a2l_float = ("float", "FLOAT32") if data.single else ("double", "FLOAT64")
    environment = templates("calib.exports", markup=False)
    environment.filters |= {
        "text": text,
        "printable": printable,
        "comment": _without_comment_marks,
        "label": lambda parts: label(*parts),
        "origin": _origin_of,
        "limits": _limits,
        "type_limits": _type_limits,
        "display_format": _display_format,
        "c_type": lambda x: f"int{x.fixed.bits}_t" if x.fixed else c_float,
        "c_numbers": partial(_c_numbers, single=data.single),
        "c_string": _c_string,
        "type": lambda x: _A2L_TYPES[x.fixed.bits] if x.fixed else f"{a2l_float}_IEEE",
    }
    facts = data.facts()
    written = environment.get_template(f"{name}.j2").render(
        {key: facts[key] for key in ("version", "digest", "program", "vehicle")},
        data=data,
        facts=list(facts.items()),
        function=f"{data.prefix}_{_FUNCTION}",
    )
    return written.encode()


def _write_a2l(data: Dataset) -> bytes:
    text = _filled("a2l", _short, data)
    return text if text.isascii() else _BOM + text


@dataclass(frozen=True)
class _Format:
    """A format of files."""

    ending: str  # of the file's name
    write: Callable[[Dataset], bytes]  # makes the file of a data set
    fixed: bool = False  # whether it can be in fixed point and in single precision
    addressed: bool = False  # whether it holds addresses of the ECU's memory
    most_axes: int = MOST_AXES  # that a map in it can have


FORMATS = {
    "json": _Format("json", _write_json),
    "csv": _Format("csv", _write_csv),
    "dcm": _Format("dcm", partial(_filled, "dcm", _quoted), most_axes=2),
    "cdfx": _Format("cdfx", partial(_filled, "cdfx", lambda x: escape(printable(x)))),
    "a2l": _Format("a2l", _write_a2l, fixed=True, addressed=True),
    "c-header": _Format("h", partial(_filled, "h", as_comment), fixed=True),
}
"""Formats by name. A new format is a template and a line of this table."""
