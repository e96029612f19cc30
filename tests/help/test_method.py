"""The page on the method: its constants, and its example by hand, computed by the program."""

import re
from dataclasses import fields

import numpy as np
import pytest

import calib
from calib.estimation.state import Constants
from calib.help.page import FOLDER
from calib.run.blocks import BLOCK

PAGE = (FOLDER / "method.md").read_text()
LOGS = calib.sample_logs() / "simulation_study"
AT = 7.0  # [s]
UNITS = dict.fromkeys(("bite", "untouched", "least_pressure"), 1e5)  # [bar]
UNITS |= {"steering": np.pi / 180.0}  # [deg]
NUMBER = r"-?\d+\.\d+"


def part(title: str) -> str:
    """A section of the page."""
    return PAGE.partition(f"## {title}\n")[2].partition("\n## ")[0]


def row(begins: str) -> list[float]:
    """The numbers of the cells behind the first one of a row of the example."""
    (line,) = re.findall(rf"^\| \**{re.escape(begins)}[^|]*\|(.*)\|$", PAGE, re.MULTILINE)
    return [float(number) for number in re.findall(NUMBER, line)]


def test_the_step_has_the_constants_of_the_page():
    blocks = re.findall(r"```text\n(.*?)```", part("What the ECU computes"), re.DOTALL)
    told = dict(re.findall(r"(\w+) +(-?[\d.]+)(?: |$)", blocks[1], re.MULTILINE))
    held = {one.name: one.default for one in fields(Constants) if isinstance(one.default, float)}
    assert set(told) == {"block", *held}
    assert float(told.pop("block")) == BLOCK
    for name, value in told.items():
        assert float(value) * UNITS.get(name, 1.0) == pytest.approx(held[name]), name
        assert name in blocks[0], name


def test_the_example_is_the_arithmetic_of_the_page():
    ratio, level = row("ratio of the step")[0], row("level of the step")[0]
    (share, *_, n) = [float(x) for x in re.findall(NUMBER, *re.findall("^.* n = 1.*$", PAGE, re.M))]
    assert n == pytest.approx(1.0 + share * (np.exp(ratio) - 1.0), abs=1e-3)
    filed, gain = row("mu_n [1], C [m^3]")[::2], row("mu_n [1], C [m^3]")[1::2]
    (bar,) = [float(x) for x in re.findall(r"pads, of p = ([\d.]+) bar", PAGE)]
    for i, pads in enumerate((np.exp(level + ratio) / n, np.exp(level) / n)):
        assert row("pads, of p")[i] == pytest.approx(filed[i] * pads, abs=1e-3)
        torque = row("pads, of p")[i] * gain[i] * 1e-4 * bar * 1e5
        assert row("brake torque")[i] == pytest.approx(torque, rel=2e-3)


def test_the_example_is_that_of_the_log_and_of_the_program():
    car = calib.read_vehicle(LOGS / "vehicle.toml")
    table = calib.fit(car, [calib.read_log(LOGS / "ramp_noisy.parquet")])
    log = calib.read_log(LOGS / "stop_noisy.parquet")
    ecu = calib.estimate(table, log).ecu
    at = int(np.argmin(np.abs(log.time - AT)))
    truth = [round(float(log.truth[f"true_Tb_{wheel}"][at]), 1) for wheel in ("fl", "rl")]
    assert row("truth of the simulation") == truth
    found = [float(torque.value[at]) for torque in (ecu.torque_f, ecu.torque_r)]
    assert row("brake torque") == pytest.approx(found, rel=0.02)
    assert row("brake torque") == pytest.approx(truth, rel=0.03)
