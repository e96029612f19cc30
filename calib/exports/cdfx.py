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

from xml.etree import ElementTree as ET

from calib.exports.dataset import (
    BY_A_PERSON,
    Axis,
    Curve,
    Dataset,
    Scalar,
    placed,
    span,
)
from calib.exports.labels import printable
from calib.store.quality import CALIBRATED

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
