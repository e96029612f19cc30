"""Reader of the DCM files that `write_dcm` makes, with a check of every count that they state."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from calib.errors import ExchangeError
from calib.exports.dataset import Content
from calib.exports.returned import Returned, returned

AXIS, GROUP, LINE, VALUE = "STUETZSTELLENVERTEILUNG", "GRUPPENKENNLINIE", "KENNLINIE", "FESTWERT"
FORMAT, FUNCTIONS, END = "KONSERVIERUNG_FORMAT", "FUNKTIONEN", "END"
ARRAYS = {AXIS: ("ST/X",), GROUP: ("ST/X", "WERT"), LINE: ("ST/X", "WERT"), VALUE: ("WERT",)}
"""Arrays that an object of each kind must have."""

TEXTS = ("LANGNAME", "DISPLAYNAME", "FUNKTION", "EINHEIT_X", "EINHEIT_W", "FKT")


@dataclass
class DcmBlock:
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


def _blocks(path: Path, lines: list[str], start: int) -> Iterator[DcmBlock]:
    """The objects of the file, each complete up to its END."""
    block: DcmBlock | None = None
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


def _opened(path: Path, i: int, line: str) -> DcmBlock:
    kind, *rest = line.split()
    sized = kind in (AXIS, GROUP, LINE)
    if kind == FUNCTIONS and not rest:
        return DcmBlock(kind, "", 0, i)
    if len(rest) != 1 + sized or (sized and not rest[1].isdecimal()):
        raise _bad(path, i, repr(line), f"{kind} NAME" + " SIZE" * sized)
    return DcmBlock(kind, rest[0], int(rest[1]) if sized else 1, i)


def _take(path: Path, i: int, line: str, block: DcmBlock) -> None:
    """One line within an object."""
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


def _check_counts(path: Path, block: DcmBlock) -> None:
    for word in ARRAYS.get(block.kind, ()):
        count = len(block.numbers.get(word, []))
        if count != block.size:
            what = f"{block.kind} {block.name} has {count} of {block.size} numbers {word}"
            raise _bad(path, block.line, what, "as many as it says")


def _content(path: Path, blocks: list[DcmBlock]) -> Content:
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


def _open(path: Path, block: DcmBlock) -> ExchangeError:
    return _bad(path, block.line, f"{block.kind} {block.name} has no {END}", "the whole object")


def _bad(path: Path, line: int, what: str, expected: str) -> ExchangeError:
    return ExchangeError(what, where=f"{path}:{line + 1}", expected=expected)
