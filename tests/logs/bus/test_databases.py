"""A database for each bus of a log."""

import numpy as np
import pytest

from calib.logs.bus.text_logs import open_text_log
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


def values_and_notes(folder, buses):
    """The names and values of the log with files by bus, and its notes."""
    files = {bus: tuple(folder / name for name in names) for bus, names in buses.items()}
    recording = open_text_log(folder / "run.log", files)
    names = [column.full for column in recording.columns[1:]]
    traces = recording.read(range(1, 1 + len(names)))
    return {name: trace.values for name, trace in zip(names, traces, strict=True)}, recording.notes


@pytest.mark.parametrize(
    ("buses", "factors"),
    [
        (
            {"can0": ["wheels.kcd"], "can1": ["doors.dbc"]},
            {"WHEELS.WhlFL": 0.005, "WHEELS.WhlFR": 0.005, "DOORS.Left": 0.005,
             "DOORS.Right": 0.005},
        ),
        # the other bus has none, and of one that is named there are no frames
        (
            {"can1": ["wheels.kcd"], "can7": ["doors.dbc"]},
            {"WHEELS.WhlFL": 0.005, "WHEELS.WhlFR": 0.005},
        ),
    ],
)  # fmt: skip
def test_one_identifier_with_a_meaning_on_each_bus(folder, buses, factors):
    values, notes = values_and_notes(folder, buses)
    assert list(values) == list(factors)
    for name, factor in factors.items():
        np.testing.assert_allclose(values[name], factor * np.arange(60), err_msg=name)
    assert all(any(f"bus {bus}" in note for note in notes) for bus in buses)


@pytest.mark.parametrize(("name", "bus"), [("run.log", "can0"), ("run.asc", "0"), ("run.mf4", "0")])
def test_a_map_names_the_buses_as_the_columns_do(tmp_path, name, bus):
    plain = read_log(write_bus(tmp_path / name), write_dbc(tmp_path))
    (tmp_path / "one.toml").write_text(MAP.format(dbc=f'dbc = {{{bus} = "chassis.dbc"}}\n'))
    log = read_log(tmp_path / name, tmp_path / "one.toml")
    np.testing.assert_array_equal(log["p_mc"], plain["p_mc"])
