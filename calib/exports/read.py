"""Read DCM and CDF files back, also files that another tool has saved; refuse damaged ones.

A tool keeps labels and numbers, but seldom the head of the file. So the name of the table comes
from the head if there is one, else from the labels. The readers of DCM stand first, then those of
CDF.
"""

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree as ET

from calib.base.bounded import CALIBRATION, bytes_of
from calib.base.errors import ExchangeError
from calib.exports.dataset import Cells, Content, Numbers
from calib.exports.symbols import prefix

DCM, CDF = "DCM", "CDF"
_VERSION = "_version"  # end of the label of the table's version
_Parts = tuple[dict[str, str], dict[str, str], Content]  # facts by key, units by label, numbers


@dataclass(frozen=True)
class Returned:
    """A file that was read back."""

    format: str  # DCM or CDF
    facts: dict[str, str]  # of its head, by key
    units: dict[str, str]  # by label
    content: Content
    prefix: str  # first part of the labels
    table: str  # id of the table, by the head or by the labels

    @property
    def unchanged(self) -> bool | None:
        """Whether the numbers agree with the checksum in the file; None if it has none."""
        checksum = self.facts.get("checksum")
        return None if checksum is None else checksum == self.content.checksum


def read_back(path: Path) -> Returned:
    """Return the content of a file: CDF if its first character is that of XML, else DCM.

    Raises ExchangeError when the file cannot be read, is cut off or damaged, or names no table.
    """
    data = bytes_of(path, CALIBRATION, ExchangeError, "DCM or CDF")
    is_xml = data.lstrip(b"\xef\xbb\xbf \r\n\t").startswith(b"<")
    form, read = (CDF, _read_cdf) if is_xml else (DCM, _read_dcm)
    facts, units, content = read(path, data)
    # an ECU may have other objects with NAME_version: a table has NAME_D, its code NAME_level
    versions = [name for name in content.scalars if name.endswith(_VERSION)]
    names = [name.removesuffix(_VERSION) for name in versions]
    names = [x for x in names if f"{x}_D" in content.grids or f"{x}_level" in content.grids]
    if not names and "table" in facts:  # the file has only a part of the table
        names = [prefix(facts["table"].partition("@")[0])]
    if len(names) != 1:
        labels = f"the labels of {len(names)} tables: NAME{_VERSION}, NAME_D or NAME_level"
        expected = "an export of one table, or that file as another tool saved it"
        raise _bad(path, f"{form} with {labels}", expected)
    if facts.get("objects", str(len(content))) != str(len(content)):
        flaw = f"holds {len(content)} objects and states {facts['objects']}: cut off, or joined"
        raise ExchangeError(flaw, where=path, do="export the table again")
    (first,) = names
    table = facts.get("table") or f"{first}@{content.scalars[first + _VERSION]:.0f}"
    return Returned(form, facts, units, content, first, table)


_AXIS, _VALUE = "STUETZSTELLENVERTEILUNG", "FESTWERT"  # a shared axis, a scalar
_GROUP, _LINE = "GRUPPENKENNLINIE", "KENNLINIE"  # a curve over a shared axis, over an own axis
_MAP, _FUNCTIONS = "GRUPPENKENNFELD", "FUNKTIONEN"  # a map over shared axes, the list of functions
_FORMAT = "KONSERVIERUNG_FORMAT"  # in the first line after the head
_X, _Y, _W = "ST/X", "ST/Y", "WERT"  # points of the two axes, values
_ARRAYS = {
    _AXIS: (_X,), _GROUP: (_X, _W), _LINE: (_X, _W), _MAP: (_X, _Y, _W), _VALUE: (_W,),
    _FUNCTIONS: (),
}  # fmt: skip
"""Arrays that an object of each kind has: points of its axes, and values."""

_TEXTS = ("LANGNAME", "DISPLAYNAME", "FUNKTION", "EINHEIT_X", "EINHEIT_Y", "EINHEIT_W", "FKT")


class _Block(NamedTuple):
    """An object of a DCM file."""

    kind: str
    name: str
    over: dict[str, str]  # labels of the shared axes of a curve or map, by array
    unit: str
    numbers: dict[str, Numbers]  # by array


_CONTROL = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\u2028\u2029]")


def _read_dcm(path: Path, data: bytes) -> _Parts:
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise _bad(path, f"not text ({error.reason})", "DCM or CDF") from error
    odd = _CONTROL.search(text)
    if odd:
        line = text.count("\n", 0, odd.start()) + 1
        raise _bad(path, f"the control character U+{ord(odd[0]):04X} in line {line}", "text")
    lines = [line.strip() for line in text.splitlines()]
    begin = next((i for i, line in enumerate(lines) if line.split() == [_FORMAT, "2.0"]), None)
    if begin is None:
        raise _bad(path, f"no line {_FORMAT} 2.0", "DCM 2.0, or CDF, which is XML")
    head = (line.removeprefix("* ").partition(": ") for line in lines[:begin] if line[:2] == "* ")
    facts = {key: value for key, colon, value in head if colon}
    *parts, remainder = re.split(r"^END$", "\n".join(lines[begin + 1 :]), flags=re.MULTILINE)
    if _words(remainder):
        raise _bad(path, f"{' '.join(_words(remainder)[0])} has no END", "the whole object")
    blocks = [b for b in (_block(path, part) for part in parts) if b.kind != _FUNCTIONS]
    units = _once(path, ((b.name, b.unit) for b in blocks))
    axes = {b.name: b.numbers[_X] for b in blocks if b.kind == _AXIS}
    grids = {b.name: _cells(path, b, axes) for b in blocks if b.kind in (_GROUP, _LINE, _MAP)}
    scalars = {b.name: b.numbers[_W][0] for b in blocks if b.kind == _VALUE}
    return facts, units, Content(axes, scalars, grids)


def _cells(path: Path, block: _Block, axes: dict[str, Numbers]) -> Cells:
    """Return axes and values of a curve or map. It repeats the points of the shared ``axes``."""
    arrays = [array for array in (_Y, _X) if array in block.numbers]
    for array in arrays:
        axis = block.over.get(array, "no axis")
        if block.kind != _LINE and axes.get(axis) != block.numbers[array]:
            message = f"{block.name} is over {axis}, which is missing or differs"
            raise _bad(path, message, f"the axis it repeats, as {_AXIS}")
    return tuple(block.numbers[array] for array in arrays), block.numbers[_W]


def _words(part: str) -> list[list[str]]:
    """Return the words of each line that is no comment."""
    return [line.split() for line in part.splitlines() if line and line[0] not in "*!."]


def _block(path: Path, part: str) -> _Block:
    """Read the object in front of an END: its first line, its texts, and its numbers."""
    first, *lines = _words(part) or [[""]]
    kind, (name, *sizes) = first[0], first[1:] or [""]  # the list of functions has no name
    if kind not in _ARRAYS or (not name and kind != _FUNCTIONS):
        raise _bad(path, f"{' '.join(first)!r} begins no object", f"one of {', '.join(_ARRAYS)}")
    where, unit = f"{path}: {name}", ""
    arrays: dict[str, list[str]] = {word: [] for word in _ARRAYS[kind]}
    for word, *words in lines:
        if word in arrays:
            arrays[word] += [number.replace(",", ".") for number in words]
        elif word not in _TEXTS:
            raise _bad(where, f"{word!r} within {kind}", ", ".join((*arrays, *_TEXTS)))
        elif word == ("EINHEIT_X" if kind == _AXIS else "EINHEIT_W"):
            unit = " ".join(words).strip('"')
    axes = [array for array in (_X, _Y) if array in arrays]
    if len(sizes) != len(axes) or not all(size.isdecimal() for size in sizes):
        raise _bad(where, " ".join(first), "the number of its points along each axis")
    counts = [int(size) for size in sizes]
    declared = dict(zip(axes, counts, strict=True)) | {_W: math.prod(counts)}
    numbers = {word: _floats(where, texts) for word, texts in arrays.items()}
    for word, read in numbers.items():
        if len(read) != declared[word]:
            raise _bad(where, f"{len(read)} of {declared[word]} numbers {word}", "as many as said")
    # the lines *SSTX NAME and *SSTY NAME, comments to other readers, name shared axes
    over = re.findall(r"^\*SST([XY]).*\s(\S+)$", part, flags=re.MULTILINE)
    return _Block(kind, name, {f"ST/{axis}": label for axis, label in over}, unit, numbers)


def _once(path: Path, units: Iterable[tuple[str, str]]) -> dict[str, str]:
    """Return units by label. Raises ExchangeError for a label that is missing or occurs twice."""
    by_label: dict[str, str] = {}
    for name, unit in units:
        if not name or name in by_label:
            message = f"{name} is in it twice" if name else "an object without a label"
            raise ExchangeError(message, where=path)
        by_label[name] = unit
    return by_label


def _floats(where: str, texts: Iterable[str]) -> Numbers:
    try:
        return tuple(float(text) for text in texts)
    except ValueError as error:
        raise _bad(where, str(error), "numbers") from error


def _bad(where: object, message: str, expected: str) -> ExchangeError:
    return ExchangeError(message, where=where, expected=expected)


_TREE = "SW-SYSTEMS/SW-SYSTEM/SW-INSTANCE-SPEC/SW-INSTANCE-TREE"
_AXES = {"CURVE": 1, "MAP": 2, "CUBOID": 3}  # number of axes by category


def _read_cdf(path: Path, text: bytes) -> _Parts:
    root = _root(path, text)
    tree = root.find(_TREE)
    if root.tag != "MSRSW" or root.findtext("CATEGORY") != "CDF20" or tree is None:
        raise _bad(path, f"no CDF 2.0: its root is {root.tag}", f"MSRSW, CDF20, {_TREE}")
    sds = root.findall("SDGS/SDG[@GID='brake-cal']/SD")
    facts = {sd.get("GID", ""): sd.text or "" for sd in sds}
    objects = [(x.findtext("SHORT-NAME", ""), x) for x in tree.findall("SW-INSTANCE")]
    unit = "SW-VALUE-CONT/UNIT-DISPLAY-NAME"
    units = _once(path, ((name, instance.findtext(unit, "")) for name, instance in objects))
    values: dict[str, dict[str, Numbers]] = {x: {} for x in ("COM_AXIS", *_AXES, "VALUE")}
    for name, instance in objects:
        kind = instance.findtext("CATEGORY", "")
        if kind not in values:
            raise _bad(f"{path}: {name}", f"category {kind}", ", ".join(values))
        values[kind][name] = _values(path, name, instance.find("SW-VALUE-CONT"))
    axes, named = values["COM_AXIS"], dict(objects)
    grids: dict[str, Cells] = {}
    for kind, count in _AXES.items():
        for name, numbers in values[kind].items():
            its_axes = _axes_of(path, name, named[name], axes, count)
            if len(numbers) != math.prod(map(len, its_axes)):
                sizes = " by ".join(str(len(x)) for x in its_axes)
                message = f"{len(numbers)} values over axes of {sizes}"
                raise ExchangeError(message, where=f"{path}: {name}")
            grids[name] = its_axes, numbers
    scalars = {name: numbers[0] for name, numbers in values["VALUE"].items()}
    return facts, units, Content(axes, scalars, grids)


def _root(path: Path, text: bytes) -> ET.Element:
    # a few bytes of entities can expand to gigabytes; text of UTF-16 could hide an entity
    if b"<!ENTITY" in text or b"\0" in text:
        raise _bad(path, "declares an entity", "XML without entities")
    try:
        return ET.fromstring(text)
    except (ET.ParseError, LookupError, ValueError) as error:
        raise _bad(path, f"cut off or damaged: {error}", "XML that ends with </MSRSW>") from error


def _axes_of(
    path: Path, curve: str, instance: ET.Element, shared: dict[str, Numbers], count: int
) -> tuple[Numbers, ...]:
    """Return the axes of a curve or map, the slowest first: its own, or shared ones by label."""
    axes, parts = list[Numbers](), instance.findall("SW-AXIS-CONTS/SW-AXIS-CONT")  # X first
    if len(parts) != count:
        raise ExchangeError(f"has {len(parts)} of {count} axes", where=f"{path}: {curve}")
    for axis in reversed(parts):
        name = axis.findtext("SW-INSTANCE-REF")
        if name is not None and name not in shared:
            raise ExchangeError(f"is over {name}, which is missing", where=f"{path}: {curve}")
        axes.append(_values(path, curve, axis) if name is None else shared[name])
    return tuple(axes)


def _values(path: Path, name: str, part: ET.Element | None) -> Numbers:
    numbers = [] if part is None else part.findall("SW-VALUES-PHYS//V")
    if not numbers:
        raise ExchangeError("no SW-VALUES-PHYS with a V", where=f"{path}: {name}")
    return _floats(f"{path}: {name}", [number.text or "" for number in numbers])
