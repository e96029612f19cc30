"""Every column of a log, named and valued as the file and the map say."""

import numpy as np
import pytest

from calib.base.errors import ChannelMapError, LogError
from calib.logs.channel_map_file import read_channel_map
from calib.logs.read import read_log
from calib.logs.whole import channels_log, cut, in_si, inventory, read_whole
from tests.support.recordings import RAMP, ramp, write_bus, write_dbc, write_map, write_mdf

FOREIGN = """Zeit [s];Druck [kPa];Gang;p_mc [bar];Text;Druck [kPa]
0.00;100;1;7;a;1
0.01;200;2;8;b;2
0.02;;3;9;c;3
"""
MAP = """schema = 1
ignore = ["p_mc"]
[channels.time]
source = "Zeit"
[channels.v]
source = "Gang"
unit = "km/h"
sign = -1
scale = 2.0
offset = 1.0
"""


@pytest.fixture
def foreign(tmp_path):
    (tmp_path / "run.csv").write_text(FOREIGN)
    (tmp_path / "map.toml").write_text(MAP)
    return tmp_path / "run.csv", read_channel_map(tmp_path / "map.toml")


def columns(log):
    return {c.name: (c.unit, c.values.tolist()) for c in log.columns}


def test_a_map_names_columns_and_all_others_stay(foreign):
    path, channel_map = foreign
    values = columns(read_whole(path, channel_map))
    assert values["v"] == ("km/h", [-3.0, -5.0, -7.0])
    assert values["Druck"][0] == "kPa"
    assert np.isnan(values["Druck"][1][2])
    assert values["Druck#2"] == ("kPa", [1.0, 2.0, 3.0])
    assert set(values) == {"time", "v", "Druck", "Druck#2"}
    notes = " ".join(read_whole(path, channel_map).notes)
    assert "p_mc" in notes
    assert "Text" in notes


@pytest.mark.parametrize("name", ["run.mf4", "bus.blf"])
def test_a_recording_has_the_clock_and_the_values_that_are_read(tmp_path, name):
    if name == "run.mf4":
        path, map_file = write_mdf(tmp_path / name), write_map(tmp_path)
    else:
        path, map_file = write_bus(tmp_path / name, 1.7e9), write_dbc(tmp_path)
    ours, log = read_whole(path, read_channel_map(map_file)), read_log(path, map_file)
    for channel, values in log.channels.items():
        np.testing.assert_array_equal(channels_log(ours)[channel], values, err_msg=channel)
    if name == "bus.blf":  # signals that are no channel stay
        page = next(c for c in ours.columns if c.name == "Page")
        assert set(page.values[np.isfinite(page.values)]) <= {1.0, 2.0}  # held, not interpolated
    rates = {c.name: c.rate for c in inventory(ours)}
    assert rates["omega_fl"] == pytest.approx(200.0, rel=1e-3)
    assert rates["p_mc"] == pytest.approx(100.0, rel=1e-3)


def test_the_clock_of_a_recording_cannot_be_mapped(tmp_path):
    map_file = write_map(tmp_path)
    map_file.write_text(map_file.read_text() + '\n[channels.time]\nsource = "WhlFL"\nunit = "s"\n')
    with pytest.raises(ChannelMapError, match="time"):
        read_whole(write_mdf(tmp_path / "run.mf4"), read_channel_map(map_file))


def test_a_cut_keeps_the_rows_between_both_times():
    whole = read_whole(RAMP)
    part = cut(whole, 2.5, 4.0)
    assert part.time[[0, -1]].tolist() == [2.5, 4.0]
    inside = (ramp().time >= 2.5) & (ramp().time <= 4.0)
    np.testing.assert_array_equal(channels_log(part)["p_mc"], ramp()["p_mc"][inside])
    with pytest.raises(LogError):
        cut(whole, 50.0, 60.0)


def test_an_optional_channel_of_an_unknown_unit_is_a_column_only(tmp_path):
    path = tmp_path / "run.csv"
    rows = "".join(f"{0.01 * i:.2f},{i},{i}\n" for i in range(60))
    path.write_text("time [ms],v [furlong/h],T_disc_f [K]\n" + rows)
    log = read_whole(path)
    assert list(channels_log(log).channels) == ["time", "T_disc_f"]
    assert [c.unit for c in in_si(log).columns] == ["s", "furlong/h", "degC"]


def test_the_inventory_tells_range_rate_and_gaps(tmp_path):
    rows = [f"{0.01 * i:.2f},{i}," + ("" if 20 <= i < 40 else "1") for i in range(100)]
    path = tmp_path / "gaps.csv"
    path.write_text("time [s],v [m/s],Gang\n" + "\n".join(rows) + "\n")
    v, gear = inventory(read_whole(path))
    assert (v.unit, v.low, v.high, v.samples, v.gaps) == ("m/s", 0.0, 99.0, 100, ())
    assert v.rate == pytest.approx(100.0)
    assert (gear.unit, gear.samples) == (None, 80)
    assert gear.gaps == ((pytest.approx(0.19), pytest.approx(0.21)),)
