"""Every format as readers of others see it: the table to the last bit, and which table it is."""

import csv
import io
import json
import re
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from lxml import etree

from calib.exports.write import FORMATS
from calib.store.state import VersionState
from tests.support.curves import built

TREE = "SW-SYSTEMS/SW-SYSTEM/SW-INSTANCE-SPEC/SW-INSTANCE-TREE"
DCM_READER = """
import json, logging, sys
from dcmReader.dcm_reader import DcmReader
logging.disable(logging.NOTSET)
d = DcmReader()
d.read(sys.argv[1])
curves = [*d.get_group_characteristic_lines(), *d.get_characteristic_lines()]
print(json.dumps({
    "curves": {c.name: [list(map(float, c.values)), list(map(float, c.values.values()))]
               for c in curves},
    "scalars": {p.name: [float(p.value), p.unit] for p in d.get_parameters()},
    "axes": {c.name: c.x_mapping for c in d.get_group_characteristic_lines()},
    "maps": {m.name: [m.x_mapping, m.y_mapping, m.x_dimension, m.y_dimension, m.unit_values,
             [[*map(float, (y, x, v))] for y, row in m.values.items() for x, v in row.items()]]
             for m in d.get_group_characteristic_maps()},
    "functions": [[f.name, f.version, f.description] for f in d.get_functions()],
}))
"""


def dcm_reader(content, folder):
    """Read a file by DcmReader, in a process with a limit: it loops forever on a missing END."""
    (folder / "table.dcm").write_bytes(content)
    run = subprocess.run(
        [sys.executable, "-c", DCM_READER, folder / "table.dcm"],
        capture_output=True, text=True, timeout=60, check=True,
    )  # fmt: skip
    assert run.stderr == ""
    return json.loads(run.stdout)


def from_dcm(data, folder):
    read = dcm_reader(FORMATS["dcm"].write(data), folder)
    return read["curves"], read["scalars"]


def from_json(data, folder):
    document = json.loads(FORMATS["json"].write(data))
    axes = {a["label"]: a["values"] for a in document["axes"]}
    curves = {c["label"]: (axes[c["axis"]], c["values"]) for c in document["curves"]}
    return curves, {s["label"]: [s["value"], s["unit"]] for s in document["scalars"]}


NUMBERS = ("x", "value", "lower", "upper", "count", "flag", "x_2", "x_3")


def frame_of(data):
    # As text first: pandas 2 reads some numbers one bit off, and pandas 3 has no option for it.
    content = io.BytesIO(FORMATS["csv"].write(data))
    text = pd.read_csv(content, comment="#", dtype=dict.fromkeys(NUMBERS, str))
    return text.astype(dict.fromkeys([name for name in text if name in NUMBERS], float))


def by_label(frame):
    curves = {
        label: (part["x"].tolist(), part["value"].tolist())
        for label, part in frame[frame["axis"].notna()].groupby("label")
    }
    scalars = frame[frame["axis"].isna()]
    pairs = zip(scalars["value"], scalars["unit"], strict=True)
    return curves, dict(zip(scalars["label"], map(list, pairs), strict=True))


def cdf_of(data):
    root = etree.fromstring(FORMATS["cdfx"].write(data))
    return root, {i.findtext("SHORT-NAME"): i for i in root.findall(f"{TREE}/SW-INSTANCE")}


def from_cdf(data, folder):
    _, instances = cdf_of(data)
    numbers = {
        name: [float(v.text) for v in i.findall("SW-VALUE-CONT/SW-VALUES-PHYS/V")]
        for name, i in instances.items()
    }
    curves = {}
    for name, instance in instances.items():
        axis = instance.find("SW-AXIS-CONTS/SW-AXIS-CONT")
        if axis is not None:
            own_points = [float(v.text) for v in axis.findall("SW-VALUES-PHYS/V")]
            curves[name] = own_points or numbers[axis.findtext("SW-INSTANCE-REF")], numbers[name]
    unit = "SW-VALUE-CONT/UNIT-DISPLAY-NAME"
    return curves, {
        name: [numbers[name][0], instances[name].findtext(unit)]
        for name in instances
        if instances[name].findtext("CATEGORY") == "VALUE"
    }


READERS = {
    "json": from_json,
    "csv": lambda data, folder: by_label(frame_of(data)),
    "dcm": from_dcm,
    "cdfx": from_cdf,
}


def bits(curve):
    return [[float(v).hex() for v in values] for values in curve]


@pytest.mark.smoke
@pytest.mark.parametrize("form", READERS)
@pytest.mark.parametrize("points", [None, 16])
def test_another_reader_sees_the_table_to_the_last_bit(real, tmp_path, form, points):
    t, data = real.table, built(real, points)
    curves, scalars = READERS[form](data, tmp_path)
    truth = {
        "f1": (t.paper.eta, t.paper.f1),
        "f2": (t.paper.eta, t.paper.f2),
        "D": (t.difference.eta, t.difference.D),
        "g": (t.tyre.slip, t.tyre.force),
    }
    assert curves.keys() == {f"{data.prefix}_{name}" for name in truth}
    for name, (x, y) in truth.items():
        read = curves[f"{data.prefix}_{name}"]
        rows = np.isin(x, read[0])
        assert rows.sum() == (points or len(x))
        assert bits(read) == bits((x[rows], y[rows]))
    car, gain = t.vehicle, 2 * t.vehicle.front.piston_area * t.vehicle.front.effective_radius
    assert scalars[f"{data.prefix}_mass"] == [car.mass, "kg"]
    assert scalars[f"{data.prefix}_C_f"] == [pytest.approx(gain), "m^3"]
    drag = t.effects.parameters["aerodynamic_drag"]["drag_area"]
    assert scalars[f"{data.prefix}_drag_area"] == [drag, "m^2"]


@pytest.mark.parametrize("form", FORMATS)
def test_the_head_says_which_table_it_is_and_what_holds_at_the_ends(stored, form):
    data = built(stored, 5)
    text = FORMATS[form].write(data).decode()
    for part in ("sedan@1", stored.digest, "clamped", "5 of 21 rows", data.content().checksum):
        assert part in text


def test_rows_have_their_bands_counts_and_flags(stored):
    frame, paper = frame_of(built(stored)), stored.table.paper
    part = frame[frame["label"] == "sedan_f2"]
    for column, name in (("lower", "f2_lower"), ("upper", "f2_upper"), ("count", "count")):
        assert part[column].tolist() == getattr(paper, name).tolist()
    assert part["flag"].tolist() == paper.flag.tolist()
    scale = frame.set_index("label").loc["sedan_mu_f"]
    assert scale["upper"] - scale["value"] == pytest.approx(1.96 * 0.01)


def test_no_text_of_a_csv_can_be_taken_for_a_number(stored):
    """Readers that guess types from the first rows would fail at a later one."""
    body = [
        line for line in FORMATS["csv"].write(built(stored)).decode().splitlines() if line[0] != "#"
    ]
    for row in csv.DictReader(body):
        assert row["unit"]
        for name in row.keys() - {*NUMBERS}:
            assert re.fullmatch(r"[-+0-9.eE]*[0-9][-+0-9.eE]*", row[name]) is None


def test_a_dcm_names_the_axis_of_each_curve_and_its_function(stored, tmp_path):
    read = dcm_reader(FORMATS["dcm"].write(built(stored)), tmp_path)
    assert read["axes"]["sedan_D"] == read["axes"]["sedan_f1"] == "sedan_eta"
    assert read["functions"] == [["sedan_brake_torque", "1", "sedan@1"]]


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


def test_elements_of_a_cdf_stand_in_the_order_of_the_standard(stored):
    root, instances = cdf_of(built(stored))
    for element in root.iter(*ORDER):
        places = [ORDER[element.tag].index(child.tag) for child in element]
        assert places == sorted(places), element.tag
    kinds = {name: i.findtext("CATEGORY") for name, i in instances.items()}
    assert [kinds[f"sedan_{n}"] for n in ("eta", "D", "g", "mass")] == [
        "COM_AXIS", "CURVE", "CURVE", "VALUE",
    ]  # fmt: skip
    kind_of_axis = "SW-AXIS-CONTS/SW-AXIS-CONT/CATEGORY"
    assert instances["sedan_D"].findtext(kind_of_axis) == "COM_AXIS"
    assert instances["sedan_g"].findtext(kind_of_axis) == "STD_AXIS"


@pytest.mark.parametrize(
    ("state", "verdict", "states"),
    [
        ("released", "", ["calibrated"]),
        ("released", "passed", ["calibrated", "checked"]),
        ("draft", "passed", ["calibrated", "prelimCalibrated"]),  # ASAM CDF 2.0
    ],
)
def test_every_object_of_a_cdf_has_its_history(stored, state, verdict, states):
    decided = VersionState(state, verdict=verdict, stored_at="2025-03-31T07:08:09Z")
    data = built(replace(stored, state=decided))
    assert data.facts()["state"] == states[-1]
    for instance in cdf_of(data)[1].values():
        entries = instance.findall("SW-CS-HISTORY/CS-ENTRY")
        assert [e.findtext("STATE") for e in entries] == states
        assert {e.findtext("DATE") for e in entries} == {"2025-03-31"}
        assert {e.findtext("SD[@GID='digest']") for e in entries} == {stored.digest}
