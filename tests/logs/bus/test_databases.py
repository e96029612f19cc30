"""A database for each bus of a log."""

import numpy as np
import pytest

from calib.base.errors import ChannelMapError
from calib.logs.bus.text_logs import open_candump
from calib.logs.channel_map import DatabaseFile, Databases
from calib.logs.read import read_log
from tests.support.databases import ARXML, DBC, KCD
from tests.support.recordings import MAP, write_bus, write_dbc

OTHER = DBC.replace("WHEELS", "DOORS").replace("WhlFL", "Left").replace("WhlFR", "Right")

CAR = KCD.replace(
    "</Bus>",
    """</Bus>
  <Bus name="body">
    <Message id="0x100" name="DOORS" length="8">
      <Signal name="Left" offset="0" length="16"><Value slope="0.01" unit="rad/s"/></Signal>
    </Message>
  </Bus>""",
)
"""Two buses in one file, with 0x100 on both."""


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
    (tmp_path / "car.kcd").write_text(CAR)
    (tmp_path / "doors.dbc").write_text(OTHER)
    return tmp_path


def opened(folder, buses):
    """The log with files by bus; a pair is a file and the bus of it that is meant."""
    files = {
        bus: tuple(
            DatabaseFile(folder / name)
            if isinstance(name, str)
            else DatabaseFile(folder / name[0], name[1])
            for name in names
        )
        for bus, names in buses.items()
    }
    return open_candump(folder / "run.log", Databases(buses=tuple(files.items())))


def test_one_identifier_with_a_meaning_on_each_bus(folder):
    buses = {"can0": ["wheels.kcd"], "can1": ["doors.dbc"]}
    found = opened(folder, buses)
    names = [column.full for column in found.columns[1:]]
    assert names == ["WHEELS.WhlFL", "WHEELS.WhlFR", "DOORS.Left", "DOORS.Right"]
    assert any(n.startswith("bus can1: frames decoded by doors.dbc (SHA-256") for n in found.notes)
    np.testing.assert_allclose(found.read([1])[0].values, 0.005 * np.arange(60))


def test_a_bus_without_a_database_is_left_out(folder):
    buses = {"can1": ["wheels.kcd"], "can7": ["doors.dbc"]}
    found = opened(folder, buses)
    assert [c.full for c in found.columns[1:]] == ["WHEELS.WhlFL", "WHEELS.WhlFR"]
    assert "no frames on bus can7, which the map names; the log has bus can0, can1" in found.notes


def test_two_files_of_one_bus_may_not_describe_one_frame(folder):
    buses = {"can0": ["wheels.kcd", "doors.dbc"]}
    with pytest.raises(ChannelMapError, match="DOORS has the identifier 0x100 of WHEELS"):
        opened(folder, buses)


@pytest.mark.parametrize(("name", "bus"), [("run.log", "can0"), ("run.asc", "0"), ("run.mf4", "0")])
def test_a_map_names_the_buses_as_the_columns_do(tmp_path, name, bus):
    plain = read_log(write_bus(tmp_path / name), write_dbc(tmp_path))
    (tmp_path / "one.toml").write_text(MAP.format(dbc=f'dbc = {{{bus} = "chassis.dbc"}}\n'))
    log = read_log(tmp_path / name, tmp_path / "one.toml")
    np.testing.assert_array_equal(log["p_mc"], plain["p_mc"])


def test_each_bus_of_one_file(folder):
    found = opened(folder, {"can0": [("car.kcd", "body")], "can1": [("car.kcd", "chassis")]})
    names = [column.full for column in found.columns[1:]]
    assert names == ["DOORS.Left", "WHEELS.WhlFL", "WHEELS.WhlFR"]
    left, wheel = found.read([1, 2])
    np.testing.assert_allclose(left.values, 0.01 * np.arange(60))
    np.testing.assert_allclose(wheel.values, 0.005 * np.arange(60))
    assert any(n.startswith("bus can0: frames decoded by car.kcd, bus body (") for n in found.notes)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("car.kcd", r"DOORS \(bus body\) has the identifier 0x100 of WHEELS \(bus chassis\).*"
                    r'dbc = \{1 = \{file = "car.kcd", bus = "body"\}\}'),
        (("car.kcd", "engine"), "no messages of a bus 'engine'.* one of 'body', 'chassis'"),
        (("doors.dbc", "body"), "no messages of a bus 'body'.* it names none"),
    ],
)  # fmt: skip
def test_a_file_with_several_buses_needs_the_name_of_one(folder, name, message):
    with pytest.raises(ChannelMapError, match=message):
        opened(folder, {"can0": [name]})


def test_the_buses_of_an_arxml_have_names(folder):
    (folder / "car.arxml").write_text(ARXML)
    found = opened(folder, {"can1": [("car.arxml", "chassis")]})
    assert [c.full for c in found.columns[1:]] == ["WHEELS.WhlFL", "WHEELS.WhlFR"]
