"""Text logs of a bus: whole ones are read, others refused."""

import numpy as np
import pytest

from tests.support.recordings import MAP


@pytest.fixture(scope="module")
def lines(bus_folder):
    return (bus_folder / "whole.log").read_text().splitlines(keepends=True)


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
def test_a_line_that_is_no_frame(refused_bus, lines, line):
    message = refused_bus("other.log", "".join([*lines[:1000], line]))
    assert "1000" in message or "1001" in message
    assert not any(word in message for word in ("unpack", "invalid literal", "convert", "base 16"))


def test_a_second_run_in_the_file(refused_bus, lines):
    refused_bus("other.log", 2 * "".join(lines))


def test_a_message_on_two_buses_must_be_chosen(bus_folder, read_bus, refused_bus, lines):
    two_buses = "".join(line + line.replace("can0", "can1") for line in lines)
    refused_bus("other.log", two_buses)
    map_text = MAP.format(dbc='dbc = "chassis.dbc"\n')
    for name, message in (("Whl", "WHEELS"), ("PMc", "BRAKE"), ("Ax", "IMU"), ("VRef", "IMU")):
        map_text = map_text.replace(f'"{name}', f'"can1.{message}.{name}')
    (bus_folder / "can1.toml").write_text(map_text)
    log = read_bus("other.log", two_buses, "can1.toml")
    whole = read_bus("other.log", "".join(lines))
    np.testing.assert_array_equal(log["omega_fl"], whole["omega_fl"])
