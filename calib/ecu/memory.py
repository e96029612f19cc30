"""What a calibration tool finds in the memory of an ECU beside the maps: numbers and measurements.

Numbers of the car follow each other in NAME_numbers; counters, inputs, answers and states of the
filters are in the `bte_state` that the project of the ECU calls `bte_estimator`.
"""

import re
from collections.abc import Iterable, Iterator
from dataclasses import is_dataclass

import numpy as np

from calib.ecu.car_data import Number
from calib.ecu.car_source import Member, comments, members_of
from calib.estimation.online import ANSWERS, CHANNELS
from calib.estimation.reasons import CHECKS, Reason
from calib.estimation.state import State
from calib.exports.dataset import Scalar
from calib.exports.symbols import Measured, Within, label
from calib.exports.write import MOST

_STATE = "bte_estimator"  # of the ECU's project
_ENDS = {"": "median", "_lower": "lower", "_upper": "upper"}


def calibrated(numbers: Iterable[Number], first: str, size: int) -> list[Scalar]:
    """Numbers of a car, of ``size`` bytes each, as NAME_c_NUMBER; the version is NAME_version."""
    scalars = list[Scalar]()
    for x in numbers:
        values = x.value if isinstance(x.value, list) else [x.value]
        meaning, unit = _parted(x.comment, x.name)
        for i, value in enumerate(values):
            part, index = (f"_{x.parts[i]}", f"[{i}]") if x.parts else ("", "")
            name = label(first, "version" if x.name == "version" else f"c_{x.name}{part}")
            if index and x.parts[0] in CHANNELS:
                unit = CHANNELS[x.parts[i]].unit
            place = Within(f"{first}_numbers", f"{x.name}{index}", size * len(scalars))
            number = np.array([value])
            scalars.append(Scalar(name, meaning, unit, number, None, sigma=None, within=place))
    return scalars


def measured(first: str, size: int) -> Iterator[Measured]:
    """What a tool can measure, by the names of every other place; numbers have ``size`` bytes."""
    offset, floating = 0, "FLOAT32_IEEE" if size == 4 else "FLOAT64_IEEE"
    for name, member, meaning, unit, low, high, kind in (*_counters(), *_numbers(floating)):
        width = _BYTES[kind]
        offset += -offset % width  # as a compiler aligns it
        if name:
            place = Within(_STATE, member, offset)
            yield Measured(f"{first}_{name}", meaning, unit, kind, low, high, place)
        offset += width


_BYTES = {"UWORD": 2, "ULONG": 4, "FLOAT32_IEEE": 4, "FLOAT64_IEEE": 8}  # of the types of A2L
_Row = tuple[str, str, str, str, float, float, str]  # name, member, meaning, unit, range, type


def _counters() -> Iterator[_Row]:
    """The reason, the bits of what fails, and how often and how long it did."""
    causes = {**{name: f"sensor of {name}" for name in CHANNELS}, **CHECKS}
    reasons = "; ".join(f"{int(x)} {x.words}" for x in Reason)[:250]
    yield "reason", "reason", reasons, "1", 0.0, 255.0, "ULONG"
    yield "", "layout", "", "1", 0.0, 0.0, "ULONG"
    fails = f"bits of what fails, from the lowest: {' '.join(causes)}"
    yield "diagnosis", "diagnosis", fails[:250], "1", 0.0, 2.0 ** len(causes) - 1.0, "ULONG"
    for counter, meaning, bits, kind in (
        ("lasted", "calls in which it failed", 32, "ULONG"),
        ("often", "how often it began to fail", 16, "UWORD"),
    ):
        for i, (name, cause) in enumerate(causes.items()):
            about, most = f"{meaning}: {cause}", 2.0**bits - 1.0
            yield f"{counter}_{name}", f"{counter}[{i}]", about, "1", 0.0, most, kind


def _numbers(kind: str) -> Iterator[_Row]:
    for x in CHANNELS.values():
        yield x.name, f"last.{x.name}", x.meaning, x.unit, x.low, x.high, kind
    for x in ANSWERS.values():
        for end, word in _ENDS.items():
            member, meaning = f"answers.{x.name}.{word}", f"{x.meaning}, {word}"
            yield x.name + end, member, meaning, x.unit, 0.0, MOST, kind
    for path, comment in _states(State()):
        meaning, unit = _parted(comment, path[-1])
        member = f"filters.{'.'.join(path)}"
        yield "_".join(("state", *path)), member, meaning, unit, -MOST, MOST, kind


def _states(structure: Member, *path: str) -> Iterator[tuple[tuple[str, ...], str]]:
    for name, x in members_of(structure):
        if is_dataclass(x):
            yield from _states(x, *path, name)
        elif not isinstance(x, bool):
            yield (*path, name), comments(type(structure).__name__)[name]


def _parted(comment: str, name: str) -> tuple[str, str]:
    """Meaning and unit of a comment; of a number without one, its name in words, and "SI"."""
    units = re.findall(r"\[([^\]]+)\]", comment)
    return comment or name.replace("_", " "), units[-1] if units else "SI"
