"""What a calibration tool finds in the memory of an ECU beside the maps: numbers and measurements.

Numbers of the car stand one behind the other in NAME_numbers; inputs, answers and states of the
filters in a `bte_state`, which the ECU's project calls `bte_estimator`.
"""

import re
from collections.abc import Iterable, Iterator
from dataclasses import is_dataclass

import numpy as np

from calib.ecu.car_data import Number
from calib.ecu.car_source import Member, comments, members_of
from calib.estimation.online import ANSWERS, CHANNELS
from calib.estimation.reasons import Reason
from calib.estimation.state import State
from calib.exports.dataset import Measured, Scalar, Within, label
from calib.exports.write import MOST

_STATE = "bte_estimator"  # of the ECU's project
_ENDS = {"": "median", "_lower": "lower", "_upper": "upper"}


def calibrated(numbers: Iterable[Number], first: str, size: int) -> list[Scalar]:
    """Each number of a car, of ``size`` bytes, under NAME_c_ and its own; the version is NAME's."""
    made = list[Scalar]()
    for x in numbers:
        values = x.value if isinstance(x.value, list) else [x.value]
        for i, value in enumerate(values):
            part, place = (f"_{x.parts[i]}", f"[{i}]") if x.parts else ("", "")
            unit = CHANNELS[x.parts[i]].unit if place and x.parts[0] in CHANNELS else None
            at = Within(f"{first}_numbers", f"{x.name}{place}", size * len(made))
            named = "version" if x.name == "version" else f"c_{x.name}{part}"
            meaning, own = _parted(x.comment, x.name)
            of = label(first, named), meaning, unit or own, np.array([value]), None
            made.append(Scalar(*of, sigma=None, within=at))
    return made


def measured(first: str, size: int) -> Iterator[Measured]:
    """What a tool can measure, in numbers of ``size`` bytes: by the names of every other place."""
    reasons = "; ".join(f"{int(x)} {x.words}" for x in Reason)
    yield Measured(f"{first}_reason", reasons[:250], "1", "ULONG", 0.0, 255.0,
                   Within(_STATE, "reason", 0))  # fmt: skip
    kind, at = ("FLOAT32_IEEE" if size == 4 else "FLOAT64_IEEE"), 8
    for name, member, meaning, unit, low, high in _members():
        place = Within(_STATE, member, at)
        yield Measured(f"{first}_{name}", meaning, unit, kind, low, high, place)
        at += size


def _members() -> Iterator[tuple[str, str, str, str, float, float]]:
    for x in CHANNELS.values():
        yield x.name, f"last.{x.name}", x.meaning, x.unit, x.low, x.high
    for x in ANSWERS.values():
        for end, word in _ENDS.items():
            meaning = f"{x.meaning}, {word}"
            yield x.name + end, f"answers.{x.name}.{word}", meaning, x.unit, 0.0, MOST
    for path, comment in _states(State()):
        meaning, unit = _parted(comment, path[-1])
        member = f"filters.{'.'.join(path)}"
        yield "_".join(("state", *path)), member, meaning, unit, -MOST, MOST


def _states(of: Member, *path: str) -> Iterator[tuple[tuple[str, ...], str]]:
    """Places of the numbers of the filters, with what the source says of them."""
    for name, x in members_of(of):
        if is_dataclass(x):
            yield from _states(x, *path, name)
        elif not isinstance(x, bool):
            yield (*path, name), comments(type(of).__name__)[name]


def _parted(comment: str, name: str) -> tuple[str, str]:
    """Meaning and unit of a comment; of a number without one, its name in words, and "SI"."""
    units = re.findall(r"\[([^\]]+)\]", comment)
    return comment or name.replace("_", " "), units[-1] if units else "SI"
