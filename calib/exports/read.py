"""DCM and CDF files read back, those that another tool has saved too: what is cut off is named.

A tool that saves a file keeps labels and numbers, and seldom the head; so a file is an export of
this program when it names a table, in its head or by its labels.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree as ET
from xml.parsers import expat

from calib.base.bounded import CALIBRATION, bytes_of
from calib.base.errors import ExchangeError
from calib.exports.dataset import Content, Numbers

VERSION = "_version"
"""How the label of the scalar ends that holds the version of the table."""


@dataclass(frozen=True)
class Returned:
    """A file read back: ``format`` DCM or CDF, ``facts`` by key, and its numbers.

    ``prefix`` of the labels of the table, ``table`` its id: as the head has it, or by the labels.
    """

    format: str
    facts: dict[str, str]
    units: dict[str, str]
    content: Content
    prefix: str
    table: str

    @property
    def unchanged(self) -> bool | None:
        """Whether the numbers agree with the checksum; None where the file states none."""
        stated = self.facts.get("checksum")
        return None if stated is None else stated == self.content.checksum


def read_back(path: Path) -> Returned:
    """The content of a DCM or CDF file; its first character tells which of them it is.

    Raises ExchangeError when it cannot be read, is cut off or damaged, or names no table.
    """
    data = bytes_of(path, CALIBRATION, ExchangeError, "DCM or CDF")
    if data.lstrip(b"\xef\xbb\xbf \r\n\t").startswith(b"<"):
        return _returned(path, "CDF", *_read_cdf(path, data))
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ExchangeError(
            f"not text ({error.reason})", where=path, expected="DCM or CDF"
        ) from error
    return _returned(path, "DCM", *_read_dcm(path, text))


def _returned(
    path: Path, form: str, facts: dict[str, str], units: dict[str, str], content: Content
) -> Returned:
    firsts = [name.removesuffix(VERSION) for name in content.scalars if name.endswith(VERSION)]
    firsts = [first for first in firsts if f"{first}_D" in content.curves]
    if len(firsts) != 1:
        raise ExchangeError(
            f"{form} with the labels of {len(firsts)} tables, such as NAME{VERSION} and NAME_D",
            where=path,
            expected="an export of one table, or that file as another tool has saved it",
        )
    first = firsts[0]
    found = len(content.axes) + len(content.curves) + len(content.scalars)
    if facts.get("objects", str(found)) != str(found):
        raise ExchangeError(
            f"holds {found} objects and states {facts['objects']}: cut off, or joined",
            where=path,
            do="export the table again",
        )
    table = facts.get("table", f"{first}@{content.scalars[first + VERSION]:.0f}")
    return Returned(form, facts, units, content, first, table)


AXIS, GROUP, LINE, VALUE = "STUETZSTELLENVERTEILUNG", "GRUPPENKENNLINIE", "KENNLINIE", "FESTWERT"
FORMAT, FUNCTIONS, END = "KONSERVIERUNG_FORMAT", "FUNKTIONEN", "END"
X, Y = "ST/X", "WERT"
_ARRAYS = {AXIS: (X,), GROUP: (X, Y), LINE: (X, Y), VALUE: (Y,), FUNCTIONS: ()}
"""Arrays that an object of each kind must have."""

_TEXTS = ("LANGNAME", "DISPLAYNAME", "FUNKTION", "EINHEIT_X", "EINHEIT_W", "FKT")


@dataclass
class _Block:
    """One object of a DCM file, with the line at which it begins."""

    where: str
    kind: str
    name: str
    size: int
    axis: str = ""
    unit: str = ""
    numbers: dict[str, list[float]] = field(default_factory=dict)


def _read_dcm(path: Path, text: str) -> tuple[dict[str, str], dict[str, str], Content]:
    lines = [line.strip() for line in text.splitlines()]
    start = next((i for i, line in enumerate(lines) if line.startswith(FORMAT)), None)
    if start is None or lines[start].split() != [FORMAT, "2.0"]:
        what = f"no line {FORMAT}" if start is None else repr(lines[start])
        raise _bad(
            f"{path}:{(start or 0) + 1}", what, f"DCM with {FORMAT} 2.0, or CDF, which is XML"
        )
    head = (line.removeprefix("* ").partition(": ") for line in lines[:start] if line[:2] == "* ")
    facts = {key: value for key, colon, value in head if colon}
    blocks = [b for b in _blocks(path, lines, start + 1) if b.kind != FUNCTIONS]
    names = [b.name for b in blocks]
    if twice := sorted({n for n in names if names.count(n) > 1}):
        raise ExchangeError(f"{twice[0]} is in it twice", where=path)
    axes = {b.name: tuple(b.numbers[X]) for b in blocks if b.kind == AXIS}
    curves = [b for b in blocks if b.kind in (GROUP, LINE)]
    for b in curves:
        if b.kind == GROUP and axes.get(b.axis) != tuple(b.numbers[X]):
            what = f"{b.name} is over {b.axis or 'no axis'}, which is missing or differs"
            raise _bad(b.where, what, f"the axis it repeats, as {AXIS}")
    content = Content(
        axes,
        {b.name: (tuple(b.numbers[X]), tuple(b.numbers[Y])) for b in curves},
        {b.name: b.numbers[Y][0] for b in blocks if b.kind == VALUE},
    )
    return facts, {b.name: b.unit for b in blocks}, content


def _blocks(path: Path, lines: list[str], start: int) -> Iterator[_Block]:
    """The objects of the file, each complete up to its END."""
    block: _Block | None = None
    for i, line in enumerate(lines[start:], start + 1):
        word, _, rest = line.partition(" ")
        if block is not None and word.startswith("*SSTX"):
            block.axis = line.split()[-1]
        elif not word or word[0] in "*!.":
            continue
        elif word in _ARRAYS and block is None:
            block = _opened(f"{path}:{i}", word, rest)
        elif block is None:
            raise _bad(f"{path}:{i}", f"{word!r} outside of every object", "an object or a comment")
        elif word == END:
            yield _complete(block)
            block = None
        elif word in _ARRAYS:
            break
        else:
            _take(f"{path}:{i}", word, rest, block)
    if block is not None:
        raise _bad(block.where, f"{block.kind} {block.name} has no {END}", "the whole object")


def _opened(where: str, kind: str, rest: str) -> _Block:
    size = r"\s+(\d+)" if kind in (AXIS, GROUP, LINE) else "()"
    found = re.fullmatch(r"\s*()()" if kind == FUNCTIONS else rf"\s*(\S+){size}", rest)
    if found is None:
        raise _bad(where, repr(f"{kind} {rest}"), f"{kind} NAME" + " SIZE" * (size != "()"))
    return _Block(where, kind, found[1], int(found[2] or 1))


def _take(where: str, word: str, rest: str, block: _Block) -> None:
    if word in _ARRAYS[block.kind]:
        try:
            numbers = [float(number.replace(",", ".")) for number in rest.split()]
        except ValueError as error:
            raise _bad(where, str(error), f"numbers after {word}") from error
        block.numbers.setdefault(word, []).extend(numbers)
    elif word not in _TEXTS:
        raise _bad(where, f"{word!r} within {block.kind} {block.name}", ", ".join(_TEXTS))
    elif not re.fullmatch(r'".*"|\S+|\S+ ".*" ".*"', rest):
        raise _bad(where, f"{rest!r} after {word}", "a name or a text in quotes")
    elif word == ("EINHEIT_X" if block.kind == AXIS else "EINHEIT_W"):
        block.unit = rest.strip('"')


def _complete(block: _Block) -> _Block:
    for word in _ARRAYS[block.kind]:
        count = len(block.numbers.get(word, []))
        if count != block.size:
            what = f"{block.kind} {block.name} has {count} of {block.size} numbers {word}"
            raise _bad(block.where, what, "as many as it says")
    return block


def _bad(where: str, what: str, expected: str) -> ExchangeError:
    return ExchangeError(what, where=where, expected=expected)


TREE = "SW-SYSTEMS/SW-SYSTEM/SW-INSTANCE-SPEC/SW-INSTANCE-TREE"


def _read_cdf(path: Path, text: bytes) -> tuple[dict[str, str], dict[str, str], Content]:
    root = _root(path, text)
    tree = root.find(TREE)
    if root.tag != "MSRSW" or root.findtext("CATEGORY") != "CDF20" or tree is None:
        expected = f"MSRSW, CDF20, {TREE}"
        raise _bad(str(path), f"no CDF 2.0: its root is {root.tag}", expected)
    facts = {
        sd.get("GID", ""): sd.text or "" for sd in root.findall("SDGS/SDG[@GID='brake-cal']/SD")
    }
    units: dict[str, str] = {}
    values: dict[str, dict[str, Numbers]] = {"COM_AXIS": {}, "CURVE": {}, "VALUE": {}}
    instances = tree.findall("SW-INSTANCE")
    for one in instances:
        name, kind = one.findtext("SHORT-NAME") or "", one.findtext("CATEGORY") or ""
        where = f"{path}: {name}"
        if not name or name in units:
            what = f"{name} is in it twice" if name else "an SW-INSTANCE without SHORT-NAME"
            raise ExchangeError(what, where=path)
        if kind not in values:
            raise _bad(where, f"category {kind}", ", ".join(values))
        units[name] = one.findtext("SW-VALUE-CONT/UNIT-DISPLAY-NAME", "")
        values[kind][name] = _numbers(where, one.find("SW-VALUE-CONT/SW-VALUES-PHYS"))
    axes, curves = values["COM_AXIS"], {}
    for one in instances:
        name = one.findtext("SHORT-NAME", "")
        if name in values["CURVE"]:
            y = values["CURVE"][name]
            curves[name] = _over(f"{path}: {name}", one, axes, len(y)), y
    return facts, units, Content(axes, curves, {n: v[0] for n, v in values["VALUE"].items()})


def _root(path: Path, text: bytes) -> ET.Element:
    def refuse(*_: object) -> None:
        raise ExchangeError("declares an entity", where=path, expected="XML without entities")

    try:
        first = expat.ParserCreate()
        first.EntityDeclHandler = refuse  # a few bytes of entities can stand for gigabytes
        first.Parse(text, True)
        return ET.fromstring(text)
    except (expat.ExpatError, ET.ParseError, LookupError, ValueError) as error:
        raise ExchangeError(
            f"cut off or damaged: {error}", where=path, expected="XML that ends with </MSRSW>"
        ) from error


def _over(where: str, curve: ET.Element, axes: dict[str, Numbers], count: int) -> Numbers:
    """The axis of a curve of ``count`` values: its own, or one that it names."""
    over = curve.find("SW-AXIS-CONTS/SW-AXIS-CONT")
    if over is None:
        raise ExchangeError("a curve without SW-AXIS-CONT", where=where)
    name = over.findtext("SW-INSTANCE-REF")
    if name is not None and name not in axes:
        raise ExchangeError(f"is over {name}, which is missing", where=where)
    x = _numbers(where, over.find("SW-VALUES-PHYS")) if name is None else axes[name]
    if len(x) != count:
        raise ExchangeError(f"{count} values over an axis of {len(x)}", where=where)
    return x


def _numbers(where: str, values: ET.Element | None) -> Numbers:
    texts = [] if values is None else [v.text or "" for v in values.findall("V")]
    if not texts:
        raise ExchangeError("no SW-VALUES-PHYS with a V", where=where)
    try:
        return tuple(float(text) for text in texts)
    except ValueError as error:
        raise _bad(where, str(error), "numbers in V") from error
