"""MDF: units, names, states, invalid samples, and frames of a bus."""

from pathlib import Path

import asammdf
import numpy as np
import pytest
from asammdf.blocks.conversion_utils import from_dict

from calib.base.errors import LogError
from calib.base.names import G
from calib.logs.channel_map import ChannelMap, Mapping
from calib.logs.mdf import open_mdf
from calib.logs.read import read_log
from tests.support.recordings import write_bus, write_dbc, write_map

TIME = np.arange(200) * 0.01
REQUIRED = ("p_mc", "a_x", "omega_fl", "omega_fr", "omega_rl", "omega_rr")
UNITS = dict(zip(REQUIRED, ["bar", "m/s^2", *["rad/s"] * 4], strict=True))


def signal(name, unit=None, samples=None, **options):
    samples = np.linspace(1.0, 2.0, TIME.size) if samples is None else samples
    unit = UNITS[name] if unit is None else unit
    return asammdf.Signal(samples, TIME, name=name, unit=unit, **options)


def write(path: Path, *groups, version="4.10", names=()):
    with asammdf.MDF(version=version) as mdf:
        for number, group in enumerate(groups):
            mdf.append(list(group), acq_name=names[number] if names else None)
        return mdf.save(path, overwrite=True)


def required_but(*names):
    """The required channels but for ``names``."""
    return [signal(name) for name in REQUIRED if name not in names]


@pytest.mark.parametrize("version", ["3.10", "3.30", "4.00", "4.10", "4.20"])
def test_canonical_names_need_no_map_and_units_convert(tmp_path, version):
    path = tmp_path / ("run.mf4" if version > "4" else "run.mdf")
    units = {"p_mc": ("psi", 6894.757293168361), "a_x": ("g", G), "v": ("mph", 0.44704),
             "omega_fl": ("U/min", np.pi / 30), "omega_fr": ("°/s", np.pi / 180)}  # fmt: skip
    converted = [signal(name, unit) for name, (unit, _) in units.items()]
    write(path, [*required_but(*units), *converted], version=version)
    log = read_log(path)
    for name, (_, si) in units.items():
        np.testing.assert_allclose(log[name], si * np.linspace(1, 2, TIME.size), rtol=1e-12)
    np.testing.assert_allclose(log.time, TIME)
    assert log.notes == ()


CODES = np.arange(TIME.size, dtype=np.uint16)
SNA = {"val_0": 7, "text_0": "SNA", "default_addr": from_dict({"a": 0.1, "b": 0.0})}
BAD = CODES % 10 == 5


@pytest.mark.parametrize(
    ("samples", "options", "bar", "invalid"),
    [
        (CODES, {"conversion": {"a": 0.1, "b": -2.0}}, 0.1 * CODES - 2.0, 0),
        (CODES, {"conversion": from_dict(SNA)}, 0.1 * CODES, 1),
        (np.where(BAD, 1e9, TIME), {"invalidation_bits": BAD}, TIME, 20),
    ],
    ids=["conversion", "a value with a name among numbers", "invalid"],
)
def test_samples_are_converted_and_invalid_ones_bridged(tmp_path, samples, options, bar, invalid):
    p = signal("p_mc", samples=samples, **options)
    log = read_log(write(tmp_path / "run.mf4", [*required_but("p_mc"), p]))
    np.testing.assert_allclose(log["p_mc"], bar * 1e5, atol=1e-6)
    assert any(f"p_mc: {invalid} samples" in note for note in log.notes) is (invalid > 0)


def test_what_has_only_names_is_a_state(tmp_path):
    names = {f"val_{i}": i for i in range(3)} | {f"text_{i}": f"gear {i}" for i in range(3)}
    gear = signal("gear", "", (np.arange(200) // 80).astype("u1"), conversion=from_dict(names))
    opened = open_mdf(write(tmp_path / "run.mf4", [gear, signal("p_mc")]), {})
    gear, p = opened.read([1, 2])
    opened.close()
    assert (gear.is_state, p.is_state) == (True, False)
    np.testing.assert_array_equal(gear.values, np.arange(200) // 80)


def test_a_name_in_two_groups_must_be_chosen(tmp_path):
    groups = (required_but(), [signal("p_mc", samples=np.full(TIME.size, 9.0))])
    path = write(tmp_path / "run.mf4", *groups, names=("ESP", "bench"))
    with pytest.raises(LogError, match=r"'ESP\.p_mc', 'bench\.p_mc'"):
        read_log(path)
    map_file = tmp_path / "map.toml"
    map_file.write_text('schema = 1\n[channels.p_mc]\nsource = "bench.p_mc"\n')
    assert read_log(path, map_file)["p_mc"][0] == 9e5


@pytest.mark.parametrize(
    "options",
    [
        {"samples": np.asarray([b"fast"] * TIME.size), "encoding": "utf-8"},
        {"samples": np.zeros((TIME.size, 8), np.uint8)},
    ],
    ids=["text", "arrays"],
)
def test_what_is_no_number_is_no_channel_and_costs_no_other(tmp_path, options):
    path = write(tmp_path / "run.mf4", [*required_but(), signal("raw", "m/s", **options)])
    assert read_log(path)["p_mc"].size == TIME.size
    with pytest.raises(LogError, match="raw"):
        read_log(path, ChannelMap("map.toml", {"v": Mapping("raw", "m/s")}))


def test_frames_of_a_bus_are_decoded_as_asammdf_does(tmp_path):
    """Its own extraction, with canmatrix instead of cantools."""
    path, map_file = write_bus(tmp_path / "bus.mf4"), write_dbc(tmp_path)
    opened = open_mdf(path, {"": (tmp_path / "chassis.dbc",)})
    names = ["WhlFL", "WhlRR", "PMc", "Ax", "VRef"]
    index = [[c.name for c in opened.columns].index(name) for name in names]
    ours = opened.read(index)
    opened.close()
    dbc = {"CAN": [(tmp_path / "chassis.dbc", 0)]}
    with asammdf.MDF(path) as mdf, mdf.extract_bus_logging(dbc) as out:
        for name, trace in zip(names, ours, strict=True):
            theirs = out.get(name)
            np.testing.assert_allclose(trace.values, theirs.samples, rtol=1e-12, atol=1e-9)
            np.testing.assert_array_equal(trace.time, theirs.timestamps)
    assert read_log(path, map_file).time.size > 1700


@pytest.mark.parametrize(("name", "is_bus"), [("LIN_Frame.ID", True), ("CAN_FrameCounter", False)])
def test_only_the_names_of_the_standard_are_bus_frames(tmp_path, name, is_bus):
    log = read_log(write(tmp_path / "run.mf4", required_but(), [signal(name, "")]))
    assert any("LIN" in note for note in log.notes) is is_bus
    assert (name in log.ignored) is not is_bus


def test_frames_without_a_dbc_are_left_and_that_is_said(tmp_path):
    path = write_bus(tmp_path / "bus.mf4")
    with pytest.raises(LogError, match="DBC"):
        read_log(path, write_map(tmp_path), require=())
    with asammdf.MDF(path) as mdf:
        mdf.append(required_but(), acq_name="ESP")
        mdf.save(tmp_path / "both.mf4")
    log = read_log(tmp_path / "both.mf4")
    assert any("DBC" in note for note in log.notes)
