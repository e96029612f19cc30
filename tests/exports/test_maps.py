"""Maps in every format as readers of others see them, and as a compiler and a program have them.

ln of the pads' ratio is A + B_Z z + B_SHIFT shift + B_SLIP slip; the axes have 4, 5 and 3 values.
"""

import json
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from lxml import etree

from calib.base.errors import ExchangeError
from calib.exports.addresses import find_addresses
from calib.exports.build import build
from calib.exports.compare import difference
from calib.exports.read import read_back
from calib.exports.write import FORMATS
from calib.store.store import Store
from calib.table.exported import Precision, as_exported
from tests.exports.test_a2l import a2ltool, needs_a2ltool
from tests.exports.test_formats import TREE, dcm_reader, frame_of
from tests.support.a2l import cells, decoded, read_a2l, without_epk
from tests.support.programs import linked, memory_of, needs_gcc
from tests.support.tables import B_SHIFT, B_SLIP, B_Z, SHIFT, SLIP, A, Z, made_map, made_table

OFF = {"ratio": 0.0, "ratio_lower": -0.1, "ratio_upper": 0.2, "change": -0.05}
"""By column: its difference from the ratio."""


@pytest.fixture
def mapped(tmp_path):
    return Store(tmp_path / "mapped").save(made_table())


def truth(column="ratio"):
    """Values by (z, shift, slip)."""
    return {
        (z, x, s): A + B_Z * z + B_SHIFT * x + B_SLIP * s + OFF[column]
        for z, x, s in product(Z, SHIFT, SLIP)
    }


def is_near(cells, column="ratio"):
    """Whether all cells, and no others, have their true values."""
    true = truth(column)
    return cells.keys() == true.keys() and all(abs(cells[x] - true[x]) <= 1e-12 for x in true)


def written(stored, form, **how):
    data = build(stored, most_axes=FORMATS[form].most_axes, **how)
    return data, FORMATS[form].write(data)


def test_dcmReader_sees_each_map_over_its_two_distributions(mapped, tmp_path):
    maps = dcm_reader(written(mapped, "dcm")[1], tmp_path)["maps"]
    flat = {"sedan_log_slip", "sedan_log_slip_sigma", "sedan_share"}
    thick = {name for name in made_map().names if f"sedan_{name}" not in flat}
    assert maps.keys() == flat | {f"sedan_{name}_s{i}" for name in thick for i in (1, 2, 3)}
    for column in OFF:
        by_place = {}
        for i, slip in enumerate(SLIP):
            *head, rows = maps[f"sedan_{column}_s{i + 1}"]
            assert head == ["sedan_shift", "sedan_z", 5, 4, "1"]
            by_place |= {(z, x, slip): value for z, x, value in rows}
        assert is_near(by_place, column)
    for z, x, value in maps["sedan_log_slip"][-1]:
        assert value == pytest.approx(z - 3.0 - x, abs=1e-12)


def nested(element):
    """The values of a group, as deep as its groups are."""
    inner = element.findall("VG")
    return [nested(group) for group in inner] if inner else [float(v.text) for v in element]


def test_lxml_sees_maps_and_a_cuboid_in_a_cdf(mapped):
    root = etree.fromstring(written(mapped, "cdfx")[1])
    instances = {i.findtext("SHORT-NAME"): i for i in root.findall(f"{TREE}/SW-INSTANCE")}
    axis = "SW-AXIS-CONTS/SW-AXIS-CONT/SW-INSTANCE-REF"
    value = "SW-VALUE-CONT/SW-VALUES-PHYS"
    kinds = {name: x.findtext("CATEGORY") for name, x in instances.items()}
    names = ("ratio", "log_slip", "level", "shift", "slip_apart")
    assert [kinds[f"sedan_{n}"] for n in names] == [
        "CUBOID", "MAP", "CURVE", "COM_AXIS", "COM_AXIS",
    ]  # fmt: skip
    cuboid, flat = instances["sedan_change"], instances["sedan_log_slip"]
    over = ["sedan_slip_apart", "sedan_shift", "sedan_z"]
    assert [ref.text for ref in cuboid.findall(axis)] == over
    assert [ref.text for ref in flat.findall(axis)] == over[1:]
    cells = nested(cuboid.find(value))  # a group is a row over X, the first axis
    places = product(range(4), range(5), range(3))
    assert is_near({(Z[i], SHIFT[j], SLIP[k]): cells[i][j][k] for i, j, k in places}, "change")
    true = np.array(Z)[:, None] - 3.0 - np.array(SHIFT)
    np.testing.assert_allclose(nested(flat.find(value)), true, atol=1e-12)


def test_json_has_maps_nested_with_their_bounds(mapped):
    document = json.loads(written(mapped, "json")[1])
    maps = {x["label"]: x for x in document["maps"]}
    axes = {x["label"]: x["values"] for x in document["axes"]}
    ratio = maps["sedan_ratio"]
    assert [axes[axis] for axis in ratio["axes"]] == [[*Z], [*SHIFT], [*SLIP]]
    for name, column in (("values", "ratio"), ("lower", "ratio_lower"), ("upper", "ratio_upper")):
        flat = np.ravel(ratio[name]).tolist()
        assert is_near(dict(zip(product(Z, SHIFT, SLIP), flat, strict=True)), column)
    assert np.shape(maps["sedan_log_slip"]["values"]) == (4, 5)
    assert maps["sedan_change_0"]["axes"] == maps["sedan_level"]["axes"] == ["sedan_z_level"]
    assert "lower" not in maps["sedan_prior"]


def test_rows_have_every_axis_and_the_bounds_beside_the_median(mapped):
    frame = frame_of(written(mapped, "csv")[0])
    ratio = frame[frame["label"] == "sedan_ratio"]
    axes = ratio["axis"] + ratio["axis_2"] + ratio["axis_3"]
    assert set(axes) == {"sedan_zsedan_shiftsedan_slip_apart"}
    for cell, column in (("value", "ratio"), ("lower", "ratio_lower"), ("upper", "ratio_upper")):
        places = zip(ratio["x"], ratio["x_2"], ratio["x_3"], strict=True)
        assert is_near(dict(zip(places, ratio[cell], strict=True)), column)
    flat = frame[frame["label"] == "sedan_log_slip"]
    assert (len(flat), flat["x_3"].notna().sum()) == (20, 0)
    level = frame[frame["label"] == "sedan_level"]
    assert (level["value"] / level["x"]).tolist() == pytest.approx([0.01] * 3)
    assert (level["upper"] - level["lower"]).tolist() == pytest.approx([0.04] * 3)
    assert not [name for name in frame["label"] if "lower" in name]


WIDTHS = [{}, {"single": True}, {"bits": 8}, {"bits": 16}, {"bits": 32}]


@needs_a2ltool
@needs_gcc
@pytest.mark.parametrize("how", WIDTHS, ids=str)
def test_a_program_holds_what_the_a2l_says(mapped, tmp_path, how):
    """a2ltool accepts it, finds the same types in the program, and the bytes are the map."""
    data, header = written(mapped, "c-header", **how)
    elf = linked(tmp_path, header, data.prefix)
    content = FORMATS["a2l"].write(replace(data, addresses=find_addresses(elf, data)))
    update = ("--elffile", elf, "--update", "FULL", "--update-mode", "STRICT")
    ours = without_epk(a2ltool(tmp_path, content))
    theirs = a2ltool(tmp_path, FORMATS["a2l"].write(data), *update)
    assert without_epk(theirs) == ours
    module = read_a2l(content).only("MODULE")
    lower = cells(module, memory_of(elf), "sedan_ratio_lower")
    pad_map = as_exported(mapped.table, Precision(**how)).map
    places = zip(pad_map.slip, pad_map.shift, pad_map.z, strict=True)
    assert lower == dict(zip(places, pad_map.ratio_lower, strict=True))
    flat = cells(module, memory_of(elf), "sedan_log_slip")
    places = zip(pad_map.shift, pad_map.z, strict=True)
    assert flat == dict(zip(places, pad_map.log_slip, strict=True))
    mass = decoded(module, memory_of(elf))["sedan_mass"][0]
    assert mass == pytest.approx(1744.0, rel=4e-5)  # 16 bits at least
    level = decoded(module, memory_of(elf))["sedan_level"]
    assert level == as_exported(mapped.table, Precision(**how)).level_map.level.tolist()


@pytest.mark.parametrize("form", ["dcm", "cdfx"])
def test_one_changed_cell_is_found_and_where(mapped, tmp_path, form):
    name, place, index = {
        "dcm": ("sedan_ratio_upper_s2", "(0.45, 0.007)", (2, 3, 1)),
        "cdfx": ("sedan_ratio_upper", "(0.1, 0.007, -1.0)", (0, 3, 0)),
    }[form]
    head, name, end = written(mapped, form)[1].decode().partition(name)
    old = repr(float(made_map().grid("ratio_upper")[index]))
    (tmp_path / "a").write_text(head + name + end.replace(old, "0.25", 1))
    wrong = difference(read_back(tmp_path / "a"), mapped).wrong
    assert len(wrong) == 2
    assert wrong[1].startswith(f"{name} at {place}: 0.25,")


DAMAGE = [
    ("dcm", "  ST/Y 0.45\n", ""),
    ("dcm", "*SSTY sedan_z\n", ""),
    ("dcm", "KENNFELD sedan_ratio_s1 5 4", "KENNFELD sedan_ratio_s1 4 5"),
    ("dcm", "KENNFELD sedan_ratio_s1 5 4", "KENNFELD sedan_ratio_s1 20"),
    ("cdfx", "                  <VG>\n", "                  <VG><V>0.1</V>\n"),
    ("cdfx", ">sedan_shift</SW-INSTANCE-REF>", ">sedan_z</SW-INSTANCE-REF>"),
    ("cdfx", "<CATEGORY>CUBOID<", "<CATEGORY>MAP<"),
]


@pytest.mark.parametrize(("form", "old", "new"), DAMAGE)
def test_a_damaged_map_is_refused(mapped, tmp_path, form, old, new):
    text = written(mapped, form)[1].decode()
    assert old in text
    (tmp_path / "a").write_text(text.replace(old, new, 1))
    with pytest.raises(ExchangeError):
        read_back(tmp_path / "a")
