"""A database for each bus of a log."""

import numpy as np
import pytest

from calib.errors import ChannelMapError, LogError
from calib.logs.bus.candump import open_candump
from calib.logs.bus.databases import Databases
from calib.logs.read import read_log
from tests.support.databases import DBC, KCD
from tests.support.recordings import MAP, write_bus, write_dbc

OTHER = DBC.replace("WHEELS", "DOORS").replace("WhlFL", "Left").replace("WhlFR", "Right")


@pytest.fixture
def folder(tmp_path):
    """Identifier 0x100 on two buses, with another meaning on each."""
    rows = [
        f"({0.01 * i:.6f}) can{b} 100#{i:02X}00{i:02X}0000000000\n"
        for i in range(60)
        for b in (0, 1)
    ]
    (tmp_path / "run.log").write_text("".join(rows))
    (tmp_path / "wheels.kcd").write_text(KCD)
    (tmp_path / "doors.dbc").write_text(OTHER)
    return tmp_path


def test_one_identifier_with_a_meaning_on_each_bus(folder):
    buses = (("can0", (folder / "wheels.kcd",)), ("can1", (folder / "doors.dbc",)))
    found = open_candump(folder / "run.log", Databases(buses=buses))
    names = [column.full for column in found.columns[1:]]
    assert names == ["WHEELS.WhlFL", "WHEELS.WhlFR", "DOORS.Left", "DOORS.Right"]
    assert any(n.startswith("bus can1: frames decoded by doors.dbc (SHA-256") for n in found.notes)
    np.testing.assert_allclose(found.read([1])[0].values, 0.005 * np.arange(60))


def test_a_bus_without_a_database_is_left_out(folder):
    buses = (("can1", (folder / "wheels.kcd",)), ("can7", (folder / "doors.dbc",)))
    found = open_candump(folder / "run.log", Databases(buses=buses))
    assert [c.full for c in found.columns[1:]] == ["WHEELS.WhlFL", "WHEELS.WhlFR"]
    assert "no frames on bus can7, which the map names; the log has bus can0, can1" in found.notes


def test_no_bus_of_the_log_has_a_database(folder):
    buses = (("1", (folder / "wheels.kcd",)),)
    with pytest.raises(LogError, match=r"no frame of the log \(its buses are can0, can1\)"):
        open_candump(folder / "run.log", Databases(buses=buses))


def test_two_files_of_one_bus_may_not_describe_one_frame(folder):
    buses = (("can0", (folder / "wheels.kcd", folder / "doors.dbc")),)
    with pytest.raises(ChannelMapError, match="DOORS has the identifier 0x100 of WHEELS"):
        open_candump(folder / "run.log", Databases(buses=buses))


@pytest.mark.parametrize(("name", "bus"), [("run.log", "can0"), ("run.asc", "0"), ("run.mf4", "0")])
def test_a_map_names_the_buses_as_the_columns_do(tmp_path, name, bus):
    plain = read_log(write_bus(tmp_path / name), write_dbc(tmp_path))
    (tmp_path / "one.toml").write_text(MAP.format(dbc=f'dbc = {{{bus} = "chassis.dbc"}}\n'))
    log = read_log(tmp_path / name, tmp_path / "one.toml")
    np.testing.assert_array_equal(log["p_mc"], plain["p_mc"])
