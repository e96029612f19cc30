"""Checks of recordings: a run that is known by its formulas, written byte by byte, and read."""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np

from calib.errors import BrakeCalError
from calib.logs.channel_map import ChannelMap, DatabaseFile, Mapping
from calib.logs.log import Array, Log
from calib.logs.read import read_log
from calib.qualification import written
from calib.qualification.check import COUNT, Check
from calib.qualification.material import Material

G, PSI = 9.80665, 0.45359237 * 9.80665 / 0.0254**2
"""m/s^2 and Pa, by the definitions of the units."""

BUS = {"run.asc": written.asc, "run.blf": written.blf, "run.log": written.candump}
MDF = {"run.mf4": written.mdf}


def _true(log: Log) -> dict[str, Array]:
    """The channels at the times of a log [SI], by the formulas of `calib.qualification.written`."""
    i = (log.time - log.time[0]) / written.STEP
    return {
        **dict.fromkeys(written.WHEELS, (600.0 - 0.5 * i) * 2.0 * np.pi / 60.0),
        "p_mc": 0.5 * i * PSI,
        "a_x": -0.001 * i * G,
        "v": (90.0 - 0.05 * i) / 3.6,
    }


def _map(folder: Path) -> ChannelMap:
    """A map with the DBC; signals have the names of channels."""
    path = folder / "run.dbc"
    path.write_text(written.DBC)
    names = {name: Mapping(name) for name in written.UNITS}
    return ChannelMap("map of the check", names, dbc=(DatabaseFile(path),))


def _error(make: Callable[[], bytes], name: str) -> Callable[[Material], float]:
    """Largest error of a channel over its largest value [1]; infinite if samples are missing."""

    def measure(material: Material) -> float:
        path = material.scratch / name
        path.write_bytes(make())
        log = read_log(path, _map(material.scratch))
        if log.time.size != written.LAST + 1:
            return math.inf
        true = _true(log)
        return max(float(np.abs(log[c] - x).max() / np.abs(x).max()) for c, x in true.items())

    return measure


def _refused(files: dict[str, Callable[[], bytes]]) -> Callable[[Material], float]:
    """How many of ``files`` are refused after their second half and one byte more are cut off."""

    def measure(material: Material) -> float:
        chart, count = _map(material.scratch), 0
        for name, make in files.items():
            path = material.scratch / f"cut_{name}"
            content = make()
            path.write_bytes(content[: len(content) // 2 - 1])
            try:
                read_log(path, chart)
            except BrakeCalError as error:
                count += path.name in str(error)
        return float(count)

    return measure


def _of_file(name: str, make: Callable[[], bytes], needs: tuple[str, ...]) -> Check:
    kind = name.partition(".")[2]
    return Check(
        f"read_{kind}", f"largest relative error of a run in {name}", "1", 0.0, 1e-9,
        "formulas of the run, which the check itself writes byte by byte", _error(make, name),
        needs,
    )  # fmt: skip


def _of_cut(name: str, files: dict[str, Callable[[], bytes]], needs: tuple[str, ...]) -> Check:
    return Check(
        name, f"refused of recordings cut in half: {', '.join(files)}", "files", len(files), COUNT,
        "each file was cut by this check", _refused(files), needs,
    )  # fmt: skip


NEEDS_OF_BUS, NEEDS_OF_MDF = ("can", "cantools"), ("asammdf", "cantools")

CHECKS = (
    *(_of_file(name, make, NEEDS_OF_BUS) for name, make in BUS.items()),
    *(_of_file(name, make, NEEDS_OF_MDF) for name, make in MDF.items()),
    _of_cut("broken_bus_logs", BUS, NEEDS_OF_BUS),
    _of_cut("broken_mdf", MDF, NEEDS_OF_MDF),
)
