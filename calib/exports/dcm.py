"""DCM, the conservation format 2.0 of ETAS: a text format with German keywords.

    KONSERVIERUNG_FORMAT 2.0
    STUETZSTELLENVERTEILUNG  an axis that curves share
    GRUPPENKENNLINIE         a curve over such an axis, which it names after *SSTX and repeats
    KENNLINIE                a curve with an axis of its own
    FESTWERT                 a scalar

The format has no range, no digest and no end mark: ranges and the facts of the table are comments.
The number of objects is among the facts, so that a file cut off between two objects is detected.
Every number is written so that it reads back to the last bit.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from calib.base.errors import ExchangeError
from calib.exports.dataset import (
    Axis,
    Content,
    Curve,
    Dataset,
    Returned,
    Scalar,
    printable,
    returned,
    span,
)

PER_LINE = 6
"""Numbers on one line of an array."""

FUNCTION = "brake_torque"
"""Name of the function that the objects belong to."""


def write_dcm(data: Dataset) -> bytes:
    """DCM file of ``data``, UTF-8."""
    lines = ['* encoding="UTF-8"', "* DCM written by brake-cal"]
    lines += [f"* {key}: {printable(value)}" for key, value in data.facts().items()]
    function = f"{data.prefix}_{FUNCTION}"
    lines += ["", "KONSERVIERUNG_FORMAT 2.0", "", "FUNKTIONEN"]
    lines += [f"  FKT {function} {_text(str(data.version))} {_text(data.id)}", "END"]
    for axis in data.axes:
        if axis.shared:
            lines += ["", *_distribution(axis, function)]
    for curve in data.curves:
        lines += ["", *_curve(curve, data.axis(curve.axis), function)]
    for scalar in data.scalars:
        lines += ["", *_scalar(scalar, function)]
    return ("\n".join(lines) + "\n").encode()


def _distribution(axis: Axis, function: str) -> Iterator[str]:
    yield f"STUETZSTELLENVERTEILUNG {axis.label} {len(axis.values)}"
    yield f"* {span(axis.values)}, strictly increasing"
    yield f"  LANGNAME {_text(axis.meaning)}"
    yield f"  FUNKTION {function}"
    yield f"  EINHEIT_X {_text(axis.unit)}"
    yield from _numbers("ST/X", axis.values.tolist())
    yield "END"


def _curve(curve: Curve, axis: Axis, function: str) -> Iterator[str]:
    kind = "GRUPPENKENNLINIE" if axis.shared else "KENNLINIE"
    yield f"{kind} {curve.label} {len(curve.values)}"
    yield f"* {span(curve.values)}; clamped beyond the ends of its axis"
    yield f"  LANGNAME {_text(curve.meaning)}"
    yield f"  FUNKTION {function}"
    yield f"  EINHEIT_X {_text(axis.unit)}"
    yield f"  EINHEIT_W {_text(curve.unit)}"
    if axis.shared:
        yield f"*SSTX {axis.label}"
    yield from _numbers("ST/X", axis.values.tolist())
    yield from _numbers("WERT", curve.values.tolist())
    yield "END"


def _scalar(scalar: Scalar, function: str) -> Iterator[str]:
    yield f"FESTWERT {scalar.label}"
    if scalar.sigma is not None:
        yield f"* one standard deviation {scalar.sigma!r}"
    yield f"  LANGNAME {_text(scalar.meaning)}"
    yield f"  FUNKTION {function}"
    yield f"  EINHEIT_W {_text(scalar.unit)}"
    yield f"  WERT {scalar.value!r}"
    yield "END"


def _numbers(word: str, values: list[float]) -> Iterator[str]:
    for i in range(0, len(values), PER_LINE):
        yield f"  {word} " + " ".join(repr(v) for v in values[i : i + PER_LINE])


def _text(text: str) -> str:
    """A quoted text; the format has no escapes."""
    plain = printable(text).replace('"', "'").replace("\\", "/")
    return f'"{plain}"'


AXIS, GROUP, LINE, VALUE = "STUETZSTELLENVERTEILUNG", "GRUPPENKENNLINIE", "KENNLINIE", "FESTWERT"
FORMAT, FUNCTIONS, END = "KONSERVIERUNG_FORMAT", "FUNKTIONEN", "END"
ARRAYS = {AXIS: ("ST/X",), GROUP: ("ST/X", "WERT"), LINE: ("ST/X", "WERT"), VALUE: ("WERT",)}
"""Arrays that an object of each kind must have."""

TEXTS = ("LANGNAME", "DISPLAYNAME", "FUNKTION", "EINHEIT_X", "EINHEIT_W", "FKT")


@dataclass
class _Block:
    """One object of the file, with the line at which it begins."""

    kind: str
    name: str
    size: int
    line: int
    axis: str = ""
    unit: str = ""
    numbers: dict[str, list[float]] = field(default_factory=dict)


def read_dcm(path: Path, text: str) -> Returned:
    """Numbers and facts of a DCM file. Raises ExchangeError naming what is missing and where."""
    lines = [line.strip() for line in text.splitlines()]
    start = next((i for i, line in enumerate(lines) if line.startswith(FORMAT)), None)
    if start is None or lines[start].split() != [FORMAT, "2.0"]:
        found = f"no line {FORMAT}" if start is None else repr(lines[start])
        raise _bad(path, start or 0, found, f"DCM with {FORMAT} 2.0, or CDF, which is XML")
    blocks = list(_blocks(path, lines, start + 1))
    for block in blocks:
        _check_counts(path, block)
    units = {b.name: b.unit for b in blocks if b.kind != FUNCTIONS}
    return returned(path, "DCM", _facts(lines[:start]), units, _content(path, blocks))


def _facts(lines: list[str]) -> dict[str, str]:
    pairs = (line.removeprefix("* ").partition(": ") for line in lines if line.startswith("* "))
    return {key: value for key, colon, value in pairs if colon}


def _blocks(path: Path, lines: list[str], start: int) -> Iterator[_Block]:
    """The objects of the file, each complete up to its END."""
    block: _Block | None = None
    for i, line in enumerate(lines[start:], start):
        word = line.split()[0] if line.split() else ""
        if word == END and block is not None:
            yield block
            block = None
        elif word in (*ARRAYS, FUNCTIONS):
            if block is not None:
                raise _open(path, block)
            block = _opened(path, i, line)
        elif word.startswith("*SSTX") and block is not None:
            block.axis = line.split()[-1]
        elif word and word[0] not in "*!.":
            if block is None:
                raise _bad(path, i, f"{word!r} outside of every object", "an object or a comment")
            _take(path, i, line, block)
    if block is not None:
        raise _open(path, block)


def _opened(path: Path, i: int, line: str) -> _Block:
    kind, *rest = line.split()
    sized = kind in (AXIS, GROUP, LINE)
    if kind == FUNCTIONS and not rest:
        return _Block(kind, "", 0, i)
    if len(rest) != 1 + sized or (sized and not rest[1].isdecimal()):
        raise _bad(path, i, repr(line), f"{kind} NAME" + " SIZE" * sized)
    return _Block(kind, rest[0], int(rest[1]) if sized else 1, i)


def _take(path: Path, i: int, line: str, block: _Block) -> None:
    word, _, rest = line.partition(" ")
    if word in ARRAYS.get(block.kind, ()):
        try:
            block.numbers.setdefault(word, []).extend(
                float(v.replace(",", ".")) for v in rest.split()
            )
        except ValueError as error:
            raise _bad(path, i, str(error), f"numbers after {word}") from error
    elif word not in TEXTS:
        raise _bad(path, i, f"{word!r} within {block.kind} {block.name}", ", ".join(TEXTS))
    elif not re.fullmatch(r'".*"|\S+|\S+ ".*" ".*"', rest):
        raise _bad(path, i, f"{rest!r} after {word}", "a name or a text in quotes")
    elif word == ("EINHEIT_X" if block.kind == AXIS else "EINHEIT_W"):
        block.unit = rest.strip('"')


def _check_counts(path: Path, block: _Block) -> None:
    for word in ARRAYS.get(block.kind, ()):
        count = len(block.numbers.get(word, []))
        if count != block.size:
            what = f"{block.kind} {block.name} has {count} of {block.size} numbers {word}"
            raise _bad(path, block.line, what, "as many as it says")


def _content(path: Path, blocks: list[_Block]) -> Content:
    axes = {b.name: tuple(b.numbers["ST/X"]) for b in blocks if b.kind == AXIS}
    curves = [b for b in blocks if b.kind in (GROUP, LINE)]
    for b in curves:
        if b.kind == GROUP and axes.get(b.axis) != tuple(b.numbers["ST/X"]):
            what = f"{b.name} is over {b.axis or 'no axis'}, which is missing or differs"
            raise _bad(path, b.line, what, f"the axis it repeats, as {AXIS}")
    names = [b.name for b in blocks]
    if twice := sorted({n for n in names if names.count(n) > 1}):
        raise ExchangeError(f"{twice[0]} is in it twice", where=path)
    return Content(
        axes,
        {b.name: (tuple(b.numbers["ST/X"]), tuple(b.numbers["WERT"])) for b in curves},
        {b.name: b.numbers["WERT"][0] for b in blocks if b.kind == VALUE},
    )


def _open(path: Path, block: _Block) -> ExchangeError:
    return _bad(path, block.line, f"{block.kind} {block.name} has no {END}", "the whole object")


def _bad(path: Path, line: int, what: str, expected: str) -> ExchangeError:
    return ExchangeError(what, where=f"{path}:{line + 1}", expected=expected)
