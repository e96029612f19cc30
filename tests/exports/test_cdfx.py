"""CDF as lxml sees it, against the structure that the standard asks for.

The standard's schema is not ours to hand on. Where BRAKE_CAL_CDF_SCHEMA names a copy of it (.dtd
or .xsd) the files are validated against that.
"""

import os
from pathlib import Path

import pytest
from lxml import etree

from calib.exports.build import build
from calib.exports.cdfx import write_cdfx
from calib.store.evidence import UNPROVED, Quality

SCHEMA = os.environ.get("BRAKE_CAL_CDF_SCHEMA")
TREE = "SW-SYSTEMS/SW-SYSTEM/SW-INSTANCE-SPEC/SW-INSTANCE-TREE"
ORDER = {
    "MSRSW": ["SHORT-NAME", "CATEGORY", "SW-SYSTEMS", "SDGS"],
    "SW-INSTANCE": [
        "SHORT-NAME", "LONG-NAME", "CATEGORY", "SW-VALUE-CONT", "SW-AXIS-CONTS", "SW-CS-HISTORY",
    ],
    "SW-VALUE-CONT": ["UNIT-DISPLAY-NAME", "SW-VALUES-PHYS"],
    "SW-AXIS-CONT": ["CATEGORY", "UNIT-DISPLAY-NAME", "SW-INSTANCE-REF", "SW-VALUES-PHYS"],
    "CS-ENTRY": ["STATE", "DATE", "CSUS", "CSPR", "CSDI", "REMARK", "SD"],
}  # fmt: skip
"""Children that we use, in the order of the standard."""


def parsed(stored, points=None, quality=UNPROVED):
    return etree.fromstring(write_cdfx(build(stored, points, quality), "2026-05-04"))


def instances(root):
    return {i.findtext("SHORT-NAME"): i for i in root.findall(f"{TREE}/SW-INSTANCE")}


def numbers(element, path):
    return [float(v.text) for v in element.findall(f"{path}/V")]


@pytest.mark.parametrize("points", [None, 16])
def test_another_reader_sees_the_table_to_the_last_bit(real, truth, points):
    found, first = instances(parsed(real, points)), build(real).prefix
    eta = numbers(found[f"{first}_eta"], "SW-VALUE-CONT/SW-VALUES-PHYS")
    slip = numbers(found[f"{first}_g"], "SW-AXIS-CONTS/SW-AXIS-CONT/SW-VALUES-PHYS")
    assert len(eta) == (points or len(real.table.paper.eta))
    for name, axis in (("f1", eta), ("f2", eta), ("D", eta), ("g", slip)):
        values = numbers(found[f"{first}_{name}"], "SW-VALUE-CONT/SW-VALUES-PHYS")
        seen = [(x.hex(), y.hex()) for x, y in zip(axis, values, strict=True)]
        assert seen == truth(real).at(axis)[name]


def test_elements_stand_in_the_order_of_the_standard(stored):
    for element in parsed(stored).iter():
        known = ORDER.get(element.tag)
        if known:
            places = [known.index(child.tag) for child in element]
            assert places == sorted(places), element.tag


def test_categories_and_references(stored):
    root = parsed(stored)
    found = instances(root)
    kinds = {name: i.findtext("CATEGORY") for name, i in found.items()}
    assert (root.findtext("CATEGORY"), root.tag) == ("CDF20", "MSRSW")
    assert kinds["sedan_eta"] == "COM_AXIS"
    assert kinds["sedan_mass"] == "VALUE"
    for name in ("sedan_f1", "sedan_f2", "sedan_D"):
        axis = found[name].find("SW-AXIS-CONTS/SW-AXIS-CONT")
        assert (kinds[name], axis.findtext("CATEGORY")) == ("CURVE", "COM_AXIS")
        assert axis.findtext("SW-INSTANCE-REF") == "sedan_eta"
    assert found["sedan_g"].findtext("SW-AXIS-CONTS/SW-AXIS-CONT/CATEGORY") == "STD_AXIS"
    assert found["sedan_mass"].findtext("SW-VALUE-CONT/UNIT-DISPLAY-NAME") == "kg"


@pytest.mark.parametrize(
    ("quality", "states"),
    [
        (UNPROVED, ["calibrated"]),
        (Quality("checked", "passed on 1 hold-out", "passed"), ["calibrated", "checked"]),
        (Quality("prelimCalibrated", "failed", "failed"), ["calibrated", "prelimCalibrated"]),
    ],
)
def test_every_object_has_its_history(stored, quality, states):
    for instance in instances(parsed(stored, None, quality)).values():
        entries = instance.findall("SW-CS-HISTORY/CS-ENTRY")
        assert [e.findtext("STATE") for e in entries] == states
        assert {e.findtext("DATE") for e in entries} == {"2026-05-04"}
        assert {e.findtext("CSDI") for e in entries} == {"sedan@1"}
        assert {e.findtext("SD[@GID='digest']") for e in entries} == {stored.digest}
        assert quality.verdict is None or quality.words in entries[-1].findtext("REMARK/P")


def test_facts_are_special_data(stored):
    group = {sd.get("GID"): sd.text for sd in parsed(stored).findall("SDGS/SDG/SD")}
    assert (group["table"], group["version"], group["digest"]) == ("sedan@1", "1", stored.digest)
    assert "clamped" in group["ends"]


@pytest.mark.skipif(SCHEMA is None, reason="BRAKE_CAL_CDF_SCHEMA names no copy of the standard's")
def test_the_standard_takes_it(real):
    quality = Quality("checked", "passed on 1 hold-out", "passed")
    is_dtd = Path(SCHEMA).suffix == ".dtd"
    schema = etree.DTD(SCHEMA) if is_dtd else etree.XMLSchema(file=SCHEMA)
    for points in (None, 8):
        assert schema.validate(parsed(real, points, quality)), schema.error_log
