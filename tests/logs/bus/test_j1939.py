"""J1939 frames are found by parameter group; priority and destination do not matter."""

import numpy as np
import pytest

from calib.base.errors import LogError
from calib.logs.bus.frames import group_of, source_of
from calib.logs.bus.text_logs import open_candump
from calib.logs.channel_map import DatabaseFile, Databases

DBC = """VERSION ""
NS_ :
BS_:
BU_: A
BO_ 2566844926 CCVS1: 8 A
 SG_ Speed : 8|16@1+ (0.00390625,0) [0|250] "km/h" A
BO_ 2147483902 TSC1: 8 A
 SG_ Torque : 0|8@1+ (1,-125) [-125|125] "%" A
BO_ 256 Plain: 8 A
 SG_ Level : 0|8@1+ (1,0) [0|0] "%" A
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


def opened(folder, frames, sources):
    (folder / "j.dbc").write_text(DBC)
    (folder / "run.log").write_text("".join(frame(*row) for row in frames))
    return open_candump(
        folder / "run.log", Databases((DatabaseFile(folder / "j.dbc"),), (), sources)
    )


def names(found):
    return [column.full for column in found.columns[1:]]


def test_the_identifier_must_be_equal_unless_the_map_asks(tmp_path):
    rows = [(0.1 * i, 0x18FEF10B, 50.0) for i in range(60)]
    with pytest.raises(LogError, match="no frame of the log is in the DBC"):
        opened(tmp_path, rows, None)
    found = opened(tmp_path, rows, ())
    assert names(found) == ["CCVS1.Speed"]
    assert any("from any address" in note for note in found.notes)
    (trace,) = found.read([1])
    np.testing.assert_array_equal(trace.values, np.full(60, 50.0))


def test_only_the_addresses_of_the_map(tmp_path):
    rows = [(0.1 * i, 0x18FEF100 + s, 50.0 + s) for i in range(60) for s in (0x0B, 0x21)]
    found = opened(tmp_path, rows, (0x21,))
    assert names(found) == ["CCVS1.Speed"]
    assert any("from 0x21" in note for note in found.notes)
    np.testing.assert_array_equal(found.read([1])[0].values, np.full(60, 83.0))
    with pytest.raises(LogError, match="no frame of the log"):
        opened(tmp_path, rows, (0x22,))


def test_two_addresses_are_two_signals(tmp_path):
    rows = [(0.1 * i, 0x18FEF100 + s, 50.0 + s) for i in range(60) for s in (0x0B, 0x21)]
    found = opened(tmp_path, rows, ())
    assert names(found) == ["CCVS1@0B.Speed", "CCVS1@21.Speed"]
    left, right = found.read([1, 2])
    np.testing.assert_array_equal(left.values, np.full(60, 61.0))
    np.testing.assert_array_equal(right.values, np.full(60, 83.0))
    assert left.clock != right.clock


def test_priority_and_destination_make_no_other_signal(tmp_path):
    """CCVS1 at priorities 6 and 3, TSC1 to 0 and to 0x29, from one address each."""
    rows = [(0.1 * i, 0x18FEF10B if i % 2 else 0x0CFEF10B, float(i)) for i in range(60)]
    rows += [(0.1 * i + 0.05, 0x0C000003 if i % 3 else 0x0C002903, 0.0) for i in range(60)]
    found = opened(tmp_path, sorted(rows), ())
    assert sorted(names(found)) == ["CCVS1.Speed", "TSC1.Torque"]
    (speed,) = found.read([1 + names(found).index("CCVS1.Speed")])
    np.testing.assert_array_equal(speed.values, np.arange(60.0))
    np.testing.assert_allclose(speed.time, 0.1 * np.arange(60), atol=1e-6)


def test_short_identifiers_are_no_j1939(tmp_path):
    rows = [(0.1 * i, 0x100, 50.0) for i in range(60)] + [(7.0, 0x101, 50.0)]
    assert names(opened(tmp_path, rows, ())) == ["Plain.Level"]


def test_an_equal_identifier_comes_before_the_group(tmp_path):
    other = 'BO_ 2566844684 OWN: 8 A\n SG_ Speed : 8|8@1+ (1,0) [0|250] "km/h" A\n'
    rows = [(0.1 * i, 0x18FEF10C, 50.0) for i in range(60)]
    (tmp_path / "both.dbc").write_text(DBC + other)
    (tmp_path / "run.log").write_text("".join(frame(*row) for row in rows))
    found = open_candump(
        tmp_path / "run.log", Databases((DatabaseFile(tmp_path / "both.dbc"),), (), ())
    )
    assert names(found) == ["OWN.Speed"]
