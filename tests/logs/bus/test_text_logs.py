"""Text logs of a bus: whole ones are read, others refused."""

import numpy as np
import pytest

from calib.base.errors import LogError
from calib.logs.read import read_log
from tests.support.recordings import MAP, write_bus
from tests.support.refusals import refusal

MAP_TEXT = MAP.format(dbc='dbc = "chassis.dbc"\n')


@pytest.fixture(scope="module")
def folder(bus_folder):
    write_bus(bus_folder / "whole.log", 1.7e9)
    return bus_folder


@pytest.fixture(scope="module")
def lines(folder):
    return (folder / "whole.log").read_text().splitlines(keepends=True)


def read(folder, lines, map_file="map.toml"):
    path = folder / "other.log"
    path.write_text("".join(lines))
    return read_log(path, folder / map_file)


def refused(folder, lines):
    return refusal(read, folder, lines, kind=LogError)


LATE = "(1700000000.5)"


@pytest.mark.parametrize(
    "line",
    [
        f"{LATE} can0 100#0",
        f"{LATE} can0 100#00\n{LATE} can0 10",
        f"{LATE} can0\n",
        f"{LATE} can0 100#5Z\n",
        "(x) can0 100#00\n",
        "hello world\n",
        "  can0  123   [8]  11 22 33 44 55 66 77 88\n",
    ],
)
def test_a_line_that_is_no_frame(folder, lines, line):
    message = refused(folder, [*lines[:1000], line])
    assert "1000" in message or "1001" in message
    assert not any(word in message for word in ("unpack", "invalid literal", "convert", "base 16"))


def test_a_second_run_in_the_file(folder, lines):
    refused(folder, [*lines, *lines])


def test_a_message_on_two_buses_must_be_chosen(folder, lines):
    both = [x for line in lines for x in (line, line.replace("can0", "can1"))]
    refused(folder, both)
    map_text = MAP_TEXT
    for name, message in (("Whl", "WHEELS"), ("PMc", "BRAKE"), ("Ax", "IMU"), ("VRef", "IMU")):
        map_text = map_text.replace(f'"{name}', f'"can1.{message}.{name}')
    (folder / "can1.toml").write_text(map_text)
    log, whole = read(folder, both, "can1.toml"), read(folder, lines)
    np.testing.assert_array_equal(log["omega_fl"], whole["omega_fl"])
