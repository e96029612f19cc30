"""Text logs of a bus: whole ones are read, others refused."""

import io
import re
from pathlib import Path

import can
import numpy as np
import pytest

from calib.base.errors import ChannelMapError, LogError
from calib.logs.bus.dbc import Dbc
from calib.logs.bus.text_logs import Counted
from calib.logs.read import read_log
from tests.support.recordings import MAP, write_bus
from tests.support.refusals import refusal

NOTHING = Dbc({}, ())


class Lines(Counted):
    frame = re.compile("frame")


def counted(text):
    return Lines(io.StringIO(text), Path("run.log"))


def test_a_frame_that_the_library_passed_over_is_missed():
    lines = counted("frame 1\nframe 2\n")
    list(lines)
    one = can.Message(timestamp=0.0)
    with pytest.raises(LogError, match="1 of 2 lines"):
        lines.gathered([one], NOTHING)
    assert len(lines.gathered([one, one], NOTHING).times) == 2


@pytest.mark.parametrize(("end", "whole"), [("frame 2", 1), ("fra", 1), ("frame 2\nfr", 2)])
def test_whole_frames_before_a_line_without_end(end, whole):
    lines = counted("frame 1\n" + end)
    with pytest.raises(LogError, match=f"cut off within the last line, after {whole} whole"):
        lines.gathered(iter(list(lines)[:0]), NOTHING)


@pytest.fixture(scope="module")
def folder(bus):
    write_bus(bus / "whole.log", 1.7e9)
    return bus


@pytest.fixture(scope="module")
def lines(folder):
    return (folder / "whole.log").read_text().splitlines(keepends=True)


def read(folder, lines, chart="map.toml"):
    path = folder / "other.log"
    path.write_text("".join(lines))
    return read_log(path, folder / chart)


def refused(folder, lines):
    return refusal(read, folder, lines, kind=LogError)


def test_it_says_what_cannot_be_seen(folder, lines):
    log = read(folder, lines)
    assert any("no footer" in note for note in log.notes)
    assert any("written at 1700000000.000000 s" in note for note in log.notes)
    assert log.time[0] < 0.02


@pytest.mark.parametrize("cut", [1, 22, 43])
def test_a_last_line_that_is_cut_off(folder, lines, cut):
    message = refused(folder, [*lines[:1000], lines[1000][:-cut]])
    assert "cut off within the last line, after 1000 whole frames" in message


@pytest.mark.parametrize(
    "line",
    [
        "(1700000000.5) can0 100#00\n(1700000000.5) can0 10",
        "garbage\n",
        "(1700000000.5) can0\n",
        "  can0  123   [8]  11 22 33 44 55 66 77 88\n",
    ],
)
def test_what_is_no_frame(folder, lines, line):
    message = refused(folder, [*lines[:1000], line])
    assert "not readable after frame 100" in message or "cut off" in message


@pytest.mark.parametrize(
    "line",
    ["hello world\n", "(x) can0 100#00\n", "(1700000000.5) can0 100#5Z\n", "(1700000000.5) can0\n"],
)
def test_a_line_that_is_no_frame_is_shown(folder, lines, line):
    """And not the words of the interpreter on how it failed."""
    message = refused(folder, [*lines[:1000], line])
    assert f"line 1001 is {line.strip()!r}" in message
    assert "such as '(1436509052.249713) can0 044#2A366C2BBA'" in message
    assert not any(word in message for word in ("unpack", "invalid literal", "convert", "base 16"))


def test_a_clock_that_wraps(folder, lines):
    """16 bits of milliseconds, which begin again twice a minute or so."""

    def wrapped(line):
        time, rest = line[1:].split(")", 1)
        return f"({(float(time) - 1.7e9 + 60.0) % 65.536:.6f}){rest}"

    log, whole = read(folder, [wrapped(x) for x in lines]), read(folder, lines)
    assert any("16 bits of milliseconds" in note for note in log.notes)
    np.testing.assert_allclose(log.time, whole.time, atol=2e-6)
    np.testing.assert_array_equal(log["omega_fl"], whole["omega_fl"])


def test_a_second_run_in_the_file(folder, lines):
    assert "time goes back by" in refused(folder, [*lines, *lines])


def test_a_message_on_two_buses_must_be_chosen(folder, lines):
    both = [x for line in lines for x in (line, line.replace("can0", "can1"))]
    with pytest.raises(LogError, match=r"'can0\.WHEELS\.WhlFL', 'can1\.WHEELS\.WhlFL'"):
        read(folder, both)
    chart = MAP.format(dbc='dbc = "chassis.dbc"\n')
    for name, message in (("Whl", "WHEELS"), ("PMc", "BRAKE"), ("Ax", "IMU"), ("VRef", "IMU")):
        chart = chart.replace(f'"{name}', f'"can1.{message}.{name}')
    (folder / "can1.toml").write_text(chart)
    log, whole = read(folder, both, "can1.toml"), read(folder, lines)
    np.testing.assert_array_equal(log["omega_fl"], whole["omega_fl"])


def test_a_dbc_of_another_bus(folder, lines):
    (folder / "foreign.dbc").write_text(
        'VERSION ""\nNS_ :\nBS_:\nBU_: A\nBO_ 5 DOORS: 8 A\n SG_ Open : 0|1@1+ (1,0) [0|1] "" A\n'
    )
    (folder / "foreign.toml").write_text(MAP.format(dbc='dbc = ["foreign.dbc"]\n'))
    with pytest.raises(LogError, match="no frame of the log is in the DBC; expected one of DOORS"):
        read(folder, lines, "foreign.toml")


def test_a_signal_that_the_dbc_does_not_have(folder, lines):
    (folder / "typo.toml").write_text(
        MAP.format(dbc='dbc = "chassis.dbc"\n').replace('"PMc"', '"PMC"')
    )
    with pytest.raises(ChannelMapError, match=r"is 'PMc' meant\?"):
        read(folder, lines, "typo.toml")


def test_no_dbc(folder):
    with pytest.raises(LogError, match=r'write `dbc = "FILE\.dbc"` into a channel map'):
        read_log(folder / "whole.log")
