"""C header: constant arrays and scalars, in C99, by the rules of MISRA C:2012 named below.

    declarations      for every file that includes the header            (8.4, 8.11)
    definitions       only where <NAME>_DEFINE is defined before it: in one file     (8.6)

An include guard, sizes as unsigned constants, explicit widths of integers, labels of at most 31
characters, one kind of comment. In fixed point each object has its origin and its step, and the
largest rounding error is in its comment: value = origin + step * raw.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from calib.exports.dataset import Axis, Dataset, label
from calib.exports.fixed_point import Fixed, fixed_misfit, fixed_objects, numbers_in_words
from calib.table.table import Array

PER_LINE = 4


@dataclass(frozen=True)
class _Constant:
    """One constant of the header: an array where it has a ``size`` macro."""

    label: str
    kind: str
    size: str
    values: list[str]
    remarks: tuple[str, ...]


def write_c_header(data: Dataset, bits: int | None = None) -> bytes:
    """C header of ``data`` in double, or in signed integers of ``bits``; ASCII.

    Raises ExchangeError where a rounded axis is not strictly increasing.
    """
    guard, define = f"{data.prefix.upper()}_H", f"{data.prefix.upper()}_DEFINE"
    constants = list(_constants(data, bits))
    lines = ["/*", *(f" * {_plain(f'{k}: {v}')}" for k, v in data.facts().items())]
    lines += [
        f" * numbers: {numbers_in_words(bits)}",
        f" * Define {define} in exactly one source file",
        " */",
    ]
    lines += [f"#ifndef {guard}", f"#define {guard}", ""]
    lines += ["/* 1U only for a released version */"]
    lines += [f"#define {data.prefix.upper()}_RELEASED ({int(data.release.released)}U)", ""]
    lines += ["#include <stdint.h>", ""] if bits else []
    for axis in data.axes:
        lines.append(f"#define {_size(axis)} ({len(axis.values)}U)")
    for c in constants:
        lines += ["", *(f"/* {_plain(r)} */" for r in c.remarks), f"extern const {_declared(c)};"]
    lines += ["", f"#ifdef {define}"]
    for c in constants:
        lines += ["", *_definition(c)]
    lines += ["", f"#endif /* {define} */", "", f"#endif /* {guard} */"]
    return ("\n".join(lines) + "\n").encode("ascii")


def _size(axis: Axis) -> str:
    return f"{axis.label.upper()}_SIZE"


def _constants(data: Dataset, bits: int | None) -> Iterator[_Constant]:
    for name, text in (("id", data.id), ("digest", data.digest)):
        escaped = "".join(_escaped(byte) for byte in text.encode())
        size = str(len(text.encode()) + 1)
        yield _Constant(f"{data.prefix}_{name}", "char", size, [f'"{escaped}"'], (f"{name}",))
    fixed = {} if bits is None else fixed_objects(data, bits)
    for axis in data.axes:
        says = f"{axis.meaning} [{axis.unit}], strictly increasing"
        yield from _object(axis.label, _size(axis), says, axis.values, fixed, bits)
    for curve in data.curves:
        axis = data.axis(curve.axis)
        says = f"{curve.meaning} [{curve.unit}] over {axis.label}, clamped at its ends"
        if bits is not None:
            worst = fixed_misfit(axis, curve, bits).worst
            says += f"; read over the rounded axis at most {worst:.3g} off"
        yield from _object(curve.label, _size(axis), says, curve.values, fixed, bits)
    for s in data.scalars:
        says = f"{s.meaning} [{s.unit}]"
        yield from _object(s.label, "", says, np.array([s.value]), fixed, bits)


def _object(
    name: str, size: str, says: str, values: Array, every: dict[str, Fixed], bits: int | None
) -> Iterator[_Constant]:
    fixed = every.get(name)
    if fixed is None:
        yield _Constant(name, "double", size, [repr(float(v)) for v in values], (says,))
        return
    rounding = (
        f"origin {fixed.origin!r}, step 2^{-fixed.shift}, rounding error at most {fixed.error:.3g}"
    )
    raw = [f"{v}{'L' * (bits == 32)}" for v in fixed.raw.tolist()]
    yield _Constant(name, f"int{bits}_t", size, raw, (says, rounding))
    for part, value in (("origin", fixed.origin), ("step", fixed.step)):
        yield _Constant(label(name, part), "double", "", [repr(value)], ())


def _declared(c: _Constant) -> str:
    return f"{c.kind} {c.label}" + (f"[{c.size}]" if c.size else "")


def _definition(c: _Constant) -> Iterator[str]:
    if not c.size or c.kind == "char":
        yield f"const {_declared(c)} = {c.values[0]};"
        return
    yield f"const {_declared(c)} = {{"
    for i in range(0, len(c.values), PER_LINE):
        part = c.values[i : i + PER_LINE]
        yield f"    {', '.join(part)}" + ("," if i + PER_LINE < len(c.values) else "")
    yield "};"


def _escaped(byte: int) -> str:
    """A byte within a string constant: octal of three digits where it is not plain."""
    plain = byte < 128 and (chr(byte).isalnum() or chr(byte) in "@-_. ")
    return chr(byte) if plain else f"\\{byte:03o}"


def _plain(text: str) -> str:
    """``text`` for a comment: ASCII, without a begin or end of a comment and without trigraphs."""
    ascii_ = "".join(c if " " <= c <= "~" and c not in "?\\" else "_" for c in text)
    return ascii_.replace("*/", "* /").replace("/*", "/ *").replace("//", "/ /")
