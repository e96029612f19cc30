"""CDF 2.0 of ASAM (`.cdfx`): XML with one SW-INSTANCE per axis, curve and scalar.

    MSRSW  SHORT-NAME CATEGORY=CDF20
      SW-SYSTEMS / SW-SYSTEM / SW-INSTANCE-SPEC / SW-INSTANCE-TREE / SW-INSTANCE
        COM_AXIS   breakpoints that curves share
        CURVE      values, and an axis: a COM_AXIS by reference, or a STD_AXIS with its points
        VALUE      a scalar
        SW-CS-HISTORY / CS-ENTRY   the quality state and its reason
      SDGS / SDG   facts of the table: id, version, digest, ends, checksum

The order of elements within each is that of the standard. Dates are those of the export, since a
table has none.
"""

from pathlib import Path
from xml.etree import ElementTree as ET
from xml.parsers import expat

from calib.base.errors import ExchangeError
from calib.exports.dataset import (
    BY_A_PERSON,
    Axis,
    Content,
    Curve,
    Dataset,
    Returned,
    Scalar,
    placed,
    printable,
    returned,
    span,
)
from calib.store.evidence import CALIBRATED

DOCTYPE = (
    "<!DOCTYPE MSRSW PUBLIC "
    '"-//ASAM//DTD CALIBRATION DATA FORMAT:V2.0.0:LAI:IAI:XML:CDF200.XSD//EN" '
    '"cdf_v2.0.0.sl.dtd">'
)
FACTS = "brake-cal"
"""GID of the group of special data that holds the table's facts."""


def write_cdfx(data: Dataset, date: str) -> bytes:
    """CDF 2.0 file of ``data``; ``date`` of the export as ISO 8601."""
    root = ET.Element("MSRSW", {"CREATOR": printable(data.program)})
    _text(root, "SHORT-NAME", data.prefix)
    _text(root, "CATEGORY", "CDF20")
    system = ET.SubElement(ET.SubElement(root, "SW-SYSTEMS"), "SW-SYSTEM")
    _text(system, "SHORT-NAME", data.prefix)
    tree = ET.SubElement(ET.SubElement(system, "SW-INSTANCE-SPEC"), "SW-INSTANCE-TREE")
    _text(tree, "SHORT-NAME", data.prefix)
    _text(tree, "CATEGORY", "NO_VCD")
    _text(ET.SubElement(tree, "SW-INSTANCE-TREE-ORIGIN"), "DATA-FILE", data.id)
    for axis in data.axes:
        if axis.shared:
            _axis(tree, axis, data, date)
    for curve in data.curves:
        _curve(tree, curve, data, date)
    for scalar in data.scalars:
        _scalar(tree, scalar, data, date)
    _facts(root, data)
    ET.indent(root)
    body = ET.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{DOCTYPE}\n{body}\n'.encode()


def _axis(tree: ET.Element, axis: Axis, data: Dataset, date: str) -> None:
    instance = _instance(tree, axis.label, axis.meaning, "COM_AXIS")
    _values(instance, "SW-VALUE-CONT", axis.unit, axis.values.tolist())
    _history(instance, data, date, "fitted", f"{span(axis.values)}; {placed(axis)}")


def _curve(tree: ET.Element, curve: Curve, data: Dataset, date: str) -> None:
    axis = data.axis(curve.axis)
    instance = _instance(tree, curve.label, curve.meaning, "CURVE")
    _values(instance, "SW-VALUE-CONT", curve.unit, curve.values.tolist())
    over = ET.SubElement(instance, "SW-AXIS-CONTS")
    if axis.shared:
        content = ET.SubElement(over, "SW-AXIS-CONT")
        _text(content, "CATEGORY", "COM_AXIS")
        _text(content, "SW-INSTANCE-REF", axis.label)
    else:
        _values(over, "SW-AXIS-CONT", axis.unit, axis.values.tolist(), "STD_AXIS")
    made = "fitted" + f", then {BY_A_PERSON} in part" * curve.meaning.endswith(BY_A_PERSON)
    _history(instance, data, date, made, f"{span(curve.values)}; {placed(axis)}")


def _scalar(tree: ET.Element, scalar: Scalar, data: Dataset, date: str) -> None:
    instance = _instance(tree, scalar.label, scalar.meaning, "VALUE")
    _values(instance, "SW-VALUE-CONT", scalar.unit, [scalar.value])
    known = "" if scalar.sigma is None else f"one standard deviation {scalar.sigma!r}"
    made = BY_A_PERSON if scalar.meaning.endswith(BY_A_PERSON) else "fitted"
    _history(instance, data, date, made, known)


def _instance(tree: ET.Element, label: str, meaning: str, category: str) -> ET.Element:
    instance = ET.SubElement(tree, "SW-INSTANCE")
    _text(instance, "SHORT-NAME", label)
    _text(instance, "LONG-NAME", meaning)
    _text(instance, "CATEGORY", category)
    return instance


def _values(
    parent: ET.Element, tag: str, unit: str, values: list[float], category: str = ""
) -> None:
    content = ET.SubElement(parent, tag)
    if category:
        _text(content, "CATEGORY", category)
    _text(content, "UNIT-DISPLAY-NAME", unit)
    numbers = ET.SubElement(content, "SW-VALUES-PHYS")
    for value in values:
        _text(numbers, "V", repr(value))


def _history(instance: ET.Element, data: Dataset, date: str, made: str, known: str) -> None:
    """History of an object: how it was made, then validated where a validation was given."""
    history = ET.SubElement(instance, "SW-CS-HISTORY")
    _entry(history, CALIBRATED, data, date, made + (f"; {known}" if known else ""))
    if data.quality.verdict is not None:
        _entry(history, data.quality.state, data, date, f"validation: {data.quality.words}")


def _entry(history: ET.Element, state: str, data: Dataset, date: str, remark: str) -> None:
    entry = ET.SubElement(history, "CS-ENTRY")
    _text(entry, "STATE", state)
    _text(entry, "DATE", date)
    _text(entry, "CSUS", data.program)
    _text(entry, "CSPR", data.vehicle)
    _text(entry, "CSDI", data.id)
    _text(ET.SubElement(entry, "REMARK"), "P", remark)
    _text(entry, "SD", data.digest).set("GID", "digest")


def _facts(root: ET.Element, data: Dataset) -> None:
    group = ET.SubElement(ET.SubElement(root, "SDGS"), "SDG", {"GID": FACTS})
    for key, value in data.facts().items():
        _text(group, "SD", value).set("GID", key)


def _text(parent: ET.Element, tag: str, text: str) -> ET.Element:
    element = ET.SubElement(parent, tag)
    element.text = printable(text)
    return element


TREE = "SW-SYSTEMS/SW-SYSTEM/SW-INSTANCE-SPEC/SW-INSTANCE-TREE"
NUMBERS = "SW-VALUE-CONT/SW-VALUES-PHYS"


def read_cdfx(path: Path, text: bytes) -> Returned:
    """Numbers and facts of a CDF 2.0 file. Raises ExchangeError naming what is missing."""
    root = _root(path, text)
    tree = root.find(TREE)
    if root.tag != "MSRSW" or root.findtext("CATEGORY") != "CDF20" or tree is None:
        raise ExchangeError(
            f"no CDF 2.0: its root is {root.tag}", where=path, expected=f"MSRSW, CDF20, {TREE}"
        )
    facts = {
        sd.get("GID", ""): sd.text or "" for sd in root.findall(f"SDGS/SDG[@GID='{FACTS}']/SD")
    }
    instances = _instances(path, tree)
    unit = "SW-VALUE-CONT/UNIT-DISPLAY-NAME"
    units = {name: i.findtext(unit, "") for name, i in instances.items()}
    return returned(path, "CDF", facts, units, _content_of(path, instances))


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


def _instances(path: Path, tree: ET.Element) -> dict[str, ET.Element]:
    found: dict[str, ET.Element] = {}
    for instance in tree.findall("SW-INSTANCE"):
        name = instance.findtext("SHORT-NAME") or ""
        if not name or name in found:
            what = f"{name} is in it twice" if name else "an SW-INSTANCE without SHORT-NAME"
            raise ExchangeError(what, where=path)
        found[name] = instance
    return found


def _content_of(path: Path, instances: dict[str, ET.Element]) -> Content:
    kinds = {name: i.findtext("CATEGORY") for name, i in instances.items()}
    odd = next((n for n, kind in kinds.items() if kind not in ("COM_AXIS", "CURVE", "VALUE")), None)
    if odd is not None:
        raise ExchangeError(
            f"category {kinds[odd]}", where=f"{path}: {odd}", expected="COM_AXIS, CURVE or VALUE"
        )
    values = {n: _numbers(f"{path}: {n}", i.find(NUMBERS)) for n, i in instances.items()}
    axes = {n: v for n, v in values.items() if kinds[n] == "COM_AXIS"}
    return Content(
        axes,
        {n: _curve_of(f"{path}: {n}", instances[n], axes, y) for n, y in values.items()
         if kinds[n] == "CURVE"},
        {n: v[0] for n, v in values.items() if kinds[n] == "VALUE"},
    )  # fmt: skip


def _curve_of(
    where: str, instance: ET.Element, axes: dict[str, tuple[float, ...]], y: tuple[float, ...]
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    over = instance.find("SW-AXIS-CONTS/SW-AXIS-CONT")
    if over is None:
        raise ExchangeError("a curve without SW-AXIS-CONT", where=where)
    name = over.findtext("SW-INSTANCE-REF")
    if name is not None and name not in axes:
        raise ExchangeError(f"is over {name}, which is missing", where=where)
    x = _numbers(where, over.find("SW-VALUES-PHYS")) if name is None else axes[name]
    if len(x) != len(y):
        raise ExchangeError(f"{len(y)} values over an axis of {len(x)}", where=where)
    return x, y


def _numbers(where: str, values: ET.Element | None) -> tuple[float, ...]:
    texts = [] if values is None else [v.text or "" for v in values.findall("V")]
    if not texts:
        raise ExchangeError("no SW-VALUES-PHYS with a V", where=where)
    try:
        return tuple(float(text) for text in texts)
    except ValueError as error:
        raise ExchangeError(str(error), where=where, expected="numbers in V") from error
