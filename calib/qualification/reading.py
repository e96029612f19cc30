"""Checks of what is read: units and dialects by definition, and damaged files refused."""

from collections.abc import Callable
from pathlib import Path

import numpy as np

from calib.errors import BrakeCalError
from calib.logs.log import Log
from calib.logs.read import read_log
from calib.qualification.check import COUNT, Check
from calib.qualification.material import Material

SAMPLES = 200
UNITS = ("s", "psi", "g", "rpm", "rpm", "rpm", "rpm", "km/h")
NAMES = ("time", "p_mc", "a_x", "omega_fl", "omega_fr", "omega_rl", "omega_rr", "v")
WRITTEN = (100.0, -0.5, 600.0, 600.0, 600.0, 600.0, 90.0)
TRUE = {
    "p_mc": 100.0 * 0.45359237 * 9.80665 / 0.0254**2,
    "a_x": -0.5 * 9.80665,
    "omega_rr": 600.0 * 2.0 * np.pi / 60.0,
    "v": 90.0 / 3.6,
}
"""The same in Pa, m/s^2, rad/s and m/s, by the definitions of the units."""


def _text(separator: str, decimal: str, units: tuple[str, ...] = UNITS) -> str:
    head = separator.join(f"{name} [{unit}]" for name, unit in zip(NAMES, units, strict=True))
    lines = [(i / 200.0, *WRITTEN) for i in range(SAMPLES)]
    rows = [separator.join(str(x).replace(".", decimal) for x in line) for line in lines]
    return "\n".join((head, *rows)) + "\n"


def _worst(log: Log) -> float:
    """Largest relative error of the channels of `TRUE` [1]."""
    return float(max(np.max(np.abs(log[name] / true - 1.0)) for name, true in TRUE.items()))


def _read(separator: str, decimal: str, name: str) -> Callable[[Material], float]:
    def measure(material: Material) -> float:
        path = material.scratch / name
        path.write_text(_text(separator, decimal))
        return _worst(read_log(path))

    return measure


def _refused(material: Material) -> float:
    """How many of four broken logs are refused for what is wrong in them."""
    whole = (material.samples / "third_party/cal_ramp.parquet").read_bytes()
    text = _text(",", ".")
    backwards = text.splitlines()
    backwards[5], backwards[9] = backwards[9], backwards[5]
    broken = {
        "cut_in_half.parquet": (whole[: len(whole) // 2], "cut_in_half"),
        "no_such_unit.csv": (_text(",", ".", ("s", "furlong", *UNITS[2:])).encode(), "furlong"),
        "no_unit.csv": (text.replace("p_mc [psi]", "p_mc", 1).encode(), "unit"),
        "time_runs_back.csv": ("\n".join(backwards).encode(), "time"),
    }
    for name, (content, _) in broken.items():
        (material.scratch / name).write_bytes(content)
    return float(sum(word in _refusal(material.scratch / n) for n, (_, word) in broken.items()))


def _refusal(path: Path) -> str:
    """The message with which a log is refused; empty if it is read."""
    try:
        read_log(path)
    except BrakeCalError as error:
        return str(error)
    return ""


CHECKS = (
    Check(
        "read_units", "largest relative error of a log in psi, g, rpm and km/h", "1", 0.0, 1e-12,
        "definitions of the units", _read(",", ".", "units.csv"),
    ),
    Check(
        "read_dialect", "the same log with semicolons and decimal commas", "1", 0.0, 1e-12,
        "definitions of the units", _read(";", ",", "dialect.csv"),
    ),
    Check(
        "broken_logs", "refused of four broken logs", "files", 4, COUNT,
        "each file breaks one stated rule of a log", _refused,
    ),
)  # fmt: skip
