"""J1939 frames are found by parameter group; priority and destination do not matter."""

import numpy as np
import pytest

from calib.base.errors import LogError
from calib.logs.bus.frames import group_of, source_of
from calib.logs.bus.text_logs import open_candump
from calib.logs.channel_map import DatabaseFile, Databases
from tests.support.databases import DBC_HEAD

DBC = f"""{DBC_HEAD}BO_ 2566844926 CCVS1: 8 ESP
 SG_ Speed : 8|16@1+ (0.00390625,0) [0|250] "km/h" ESP
BO_ 2147483902 TSC1: 8 ESP
 SG_ Torque : 0|8@1+ (1,-125) [-125|125] "%" ESP
BO_ 256 Plain: 8 ESP
 SG_ Level : 0|8@1+ (1,0) [0|0] "%" ESP
"""
"""CCVS1 (65265) from address 0xFE at priority 6, TSC1 (0) to 0, priority 0; as public DBC files."""


@pytest.mark.parametrize(
    ("identifier", "group"),
    [
        (0x18FEF1FE, 65265),
        (0x0CFEF100, 65265),
        (0x0CF00400, 61444),
        (0x18EAFF00, 59904),  # request, to all
        (0x18EA0B21, 59904),  # request, to 0x0B
        (0x19F80100, 0x1F801),  # data page 1
    ],
)
def test_parameter_groups(identifier, group):
    """Numbers of SAE J1939-71 and of NMEA 2000 (129025)."""
    assert group_of(identifier) == group
    assert source_of(identifier) == identifier & 255


def frame(time, identifier, speed):
    raw = round(speed * 256)
    name = f"{identifier:08X}" if identifier > 0x7FF else f"{identifier:03X}"
    return f"({time:.6f}) can0 {name}#00{raw & 255:02X}{raw >> 8:02X}0000000000\n"


def opened(folder, frames, sources=(), dbc=DBC):
    """The values by the name of each signal."""
    (folder / "j.dbc").write_text(dbc)
    (folder / "run.log").write_text("".join(frame(*row) for row in frames))
    databases = Databases((DatabaseFile(folder / "j.dbc"),), (), sources)
    found = open_candump(folder / "run.log", databases)
    traces = found.read(range(1, len(found.columns)))
    return {c.full: t.values for c, t in zip(found.columns[1:], traces, strict=True)}


ONE = [(0.1 * i, 0x18FEF10B, 50.0) for i in range(60)]
TWO = [(0.1 * i, 0x18FEF100 + s, 50.0 + s) for i in range(60) for s in (0x0B, 0x21)]
OTHERS = [  # priorities 6 and 3; TSC1 to 0 and to 0x29
    *((0.1 * i, 0x18FEF10B if i % 2 else 0x0CFEF10B, 50.0) for i in range(60)),
    *((0.1 * i + 0.05, 0x0C000003 if i % 3 else 0x0C002903, 125 / 256) for i in range(60)),
]
SHORT = [(0.1 * i, 0x100, 50.0) for i in range(60)] + [(7.0, 0x101, 50.0)]
OWN = 'BO_ 2566844683 OWN: 8 A\n SG_ Speed : 8|8@1+ (1,0) [0|250] "km/h" A\n'


@pytest.mark.parametrize(
    ("rows", "sources", "dbc", "expected"),
    [
        (ONE, (), DBC, {"CCVS1.Speed": 50.0}),
        (TWO, (0x21,), DBC, {"CCVS1.Speed": 83.0}),
        (TWO, (), DBC, {"CCVS1@0B.Speed": 61.0, "CCVS1@21.Speed": 83.0}),
        (sorted(OTHERS), (), DBC, {"TSC1.Torque": -125.0, "CCVS1.Speed": 50.0}),
        (SHORT, (), DBC, {"Plain.Level": 0.0}),
        (ONE, (), DBC + OWN, {"OWN.Speed": 0.0}),
    ],
    ids=["any", "one of two", "two", "priority and destination", "11 bits", "equal identifier"],
)
def test_signals_by_parameter_group(tmp_path, rows, sources, dbc, expected):
    found = opened(tmp_path, rows, sources, dbc)
    assert found.keys() == expected.keys()
    for name, value in expected.items():
        np.testing.assert_array_equal(found[name], np.full(found[name].size, value))


@pytest.mark.parametrize(("rows", "sources"), [(ONE, None), (TWO, (0x22,))])
def test_no_group_is_taken_that_the_map_does_not_ask_for(tmp_path, rows, sources):
    with pytest.raises(LogError):
        opened(tmp_path, rows, sources)
