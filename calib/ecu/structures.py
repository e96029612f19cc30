"""The structures of the C code: their text, and where a calibration tool finds their members.

    `header`                   bte.h with the names, units and meanings of Python, and its checksum
    `code`                     bte.c from calib/estimation/equations.py
    `calibrated`, `measured`   numbers of a car, and members of `bte_state`, as entries of the A2L

BTE is the brake torque estimator. bte.h and bte.c are the same for every car of a precision.
"""

import inspect
import re
import zlib
from collections.abc import Iterable, Iterator
from dataclasses import fields, is_dataclass
from functools import cache
from importlib import resources
from typing import Any, NamedTuple

import numpy as np

from calib.base.names import AXLES
from calib.base.templates import templates
from calib.ecu.translation import structure, translated
from calib.estimation import constants, state
from calib.estimation.online import ANSWERS, CHANNELS
from calib.estimation.reasons import CHECKS, Reason
from calib.estimation.state import Sample, State
from calib.exports.dataset import Scalar
from calib.exports.symbols import Measured, Within, label
from calib.exports.write import MOST
from calib.table.exported import Precision

_SERIES = {32: {"terms": 8, "largest": 87}, 64: {"terms": 14, "largest": 700}}
"""By bits of the floating point: terms of the series of exp and ln, largest argument of exp."""
_NOT_IN_C = {"Sample": ["v", "log_odds", "driven"], "State": ["waiting", "held_ratio", "zero_slip"]}
"""Members by class that are not generated: those that only serve an estimate with v, and those that
the template of bte.h declares itself."""
_STATE = "bte_estimator"  # name that an ECU's project must give its variable of the type bte_state
_BYTES = {"UWORD": 2, "ULONG": 4, "FLOAT32_IEEE": 4, "FLOAT64_IEEE": 8}  # by type of A2L


class Number(NamedTuple):
    """A number of the car, or several."""

    name: str
    value: float | list[float]
    comment: str  # what it is, with its unit in brackets
    parts: tuple[str, ...] = ()  # names of several numbers: the axles, or the inputs

    @property
    def values(self) -> list[float]:
        """The numbers, in the order of ``parts``."""
        return self.value if isinstance(self.value, list) else [self.value]


def source(name: str, /, **facts: Any) -> str:
    """Return a file of the code in C, made from the template ``name``."""
    return templates("calib.ecu", markup=False).get_template(name).render(facts)


def code(precision: Precision) -> str:
    """Return bte.c."""
    equations = (resources.files("calib.estimation") / "equations.py").read_text(encoding="utf-8")
    bits = precision.floating
    return source("bte.c", equations=translated(equations), floating=bits, **_SERIES[bits])


def header(numbers: Iterable[Number], precision: Precision) -> tuple[str, str]:
    """Return bte.h with the ``numbers`` of a car, and its layout, the checksum of the text."""
    structures = {type(x).__name__: x for _, x in members_of(State()) if is_dataclass(x)}
    facts = {
        "real": "float" if precision.floating == 32 else "double", "cell": cell(precision),
        "reasons": [*Reason], "checks": [*CHECKS],
        "inputs": CHANNELS.values(), "answers": ANSWERS.values(), "numbers": numbers,
        # sizes of arrays by `Number.parts`
        "sizes": {AXLES: "[BTE_AXLES]", tuple(CHANNELS): "[BTE_INPUTS]", (): ""},
        "structures": {structure(name): _declared(x) for name, x in structures.items()},
        "filters": _declared(State()),
        "block": [name for name in Sample._fields if name not in _NOT_IN_C["Sample"]],
    }  # fmt: skip
    # the checksum of the text with the word LAYOUT then takes the place of that word
    text = source("bte.h", layout="LAYOUT", **facts)
    layout = f"0x{zlib.crc32(text.encode()):08X}U"
    return text.replace("BTE_LAYOUT LAYOUT", f"BTE_LAYOUT {layout}"), layout


def _declared(part: Any) -> Iterator[tuple[str, str, str]]:
    """Return type, name and comment of each member of a part of the state."""
    for name, x in members_of(part):
        kind = "bool" if isinstance(x, bool) else "bte_real"
        kind = structure(type(x).__name__) if is_dataclass(x) else kind
        yield kind, name, comments(type(part).__name__)[name]


def members_of(part: Any) -> list[tuple[str, Any]]:
    """Return the members of a part of the state with their values, booleans last, as in C."""
    hidden = _NOT_IN_C.get(type(part).__name__, [])
    members = [(x.name, getattr(part, x.name)) for x in fields(part) if x.name not in hidden]
    return sorted(members, key=lambda member: isinstance(member[1], bool))


@cache
def comments(class_name: str) -> dict[str, str]:
    """Return the comment behind each member of a class, `Constants` or a part of the state."""
    text = inspect.getsource({**vars(constants), **vars(state)}[class_name])
    row = r"^    (\w+): [^#\n]*(?:# (.*(?:\n    # .*)*))?$"  # a name, and its lines of comment
    return {name: x.replace("\n    #", "") for name, x in re.findall(row, text, re.MULTILINE)}


def cell(precision: Precision) -> str:
    """Return the type of the cells of the maps in C."""
    return f"int{precision.bits}_t" if precision.bits else "bte_real"


def initial(value: Any, bits: int) -> str:
    """Return an initial value in C; its numbers read back to the same floats of ``bits``."""
    if isinstance(value, dict):  # members of a structure
        return f"{{{', '.join(f'.{name} = {initial(x, bits)}' for name, x in value.items())}}}"
    if isinstance(value, list):
        return f"{{{', '.join(initial(x, bits) for x in value)}}}"
    if isinstance(value, float):
        return f"{np.float32(value)!s}F" if bits == 32 else repr(value)
    return str(value)


def calibrated(numbers: Iterable[Number], first: str, size: int) -> list[Scalar]:
    """Return an entry of the A2L for each number of a car, with its place.

    Labels are FIRST_c_NUMBER, that of the version FIRST_version; a number takes ``size`` bytes.
    """
    scalars = list[Scalar]()
    for x in numbers:
        meaning, unit = _meaning_and_unit(x.comment, x.name)
        for i, value in enumerate(x.values):
            part, member = (x.parts[i], f"{x.name}[{i}]") if x.parts else ("", x.name)
            name = "version" if x.name == "version" else f"c_{x.name}_{part}".removesuffix("_")
            unit = CHANNELS[part].unit if part in CHANNELS else unit
            head = label(first, name), meaning, unit
            place = Within(f"{first}_numbers", member, size * len(scalars))
            scalars.append(Scalar(*head, np.array([value]), None, sigma=None, within=place))
    return scalars


def measured(first: str, size: int) -> Iterator[Measured]:
    """Return what a tool can measure in `bte_state`, as FIRST_NAME; numbers have ``size`` bytes.

    The order is that of the members in the template of bte.h, so that the offsets are right.
    """
    offset, kind = 0, "FLOAT32_IEEE" if size == 4 else "FLOAT64_IEEE"
    for x in (*_counters(), *_numbers(kind)):
        offset += -offset % _BYTES[x.kind]  # as a compiler aligns it
        place = x.within._replace(offset=offset)
        yield x._replace(label=f"{first}_{x.label}", within=place)
        offset += _BYTES[x.kind]


def _counters() -> Iterator[Measured]:
    """Return reason, layout and bits of what fails; then by cause how long and how often it did."""
    causes = {**{name: f"sensor of {name}" for name in CHANNELS}, **CHECKS}
    reasons = "; ".join(f"{int(x)} {x.words}" for x in Reason)[:250]
    bits = f"bits of what fails, from the lowest: {' '.join(causes)}"[:250]
    for name, meaning, high in (
        ("reason", reasons, 255.0),
        ("layout", "checksum of the structures in bte.h", 2.0**32 - 1),
        ("diagnosis", bits, 2.0 ** len(causes) - 1.0),
    ):
        yield Measured(name, meaning, "1", "ULONG", 0.0, high, Within(_STATE, name))
    for counter, words, kind in (
        ("lasted", "calls in which it failed", "ULONG"),
        ("often", "how often it began to fail", "UWORD"),
    ):
        high = 2.0 ** (8 * _BYTES[kind]) - 1.0
        for i, (name, cause) in enumerate(causes.items()):
            meaning, place = f"{words}: {cause}", Within(_STATE, f"{counter}[{i}]")
            yield Measured(f"{counter}_{name}", meaning, "1", kind, 0.0, high, place)


def _numbers(kind: str) -> Iterator[Measured]:
    """Return the inputs, the answers with their bounds and the states of the filters."""
    for x in CHANNELS.values():
        place = Within(_STATE, f"last.{x.name}")
        yield Measured(x.name, x.meaning, x.unit, kind, x.low, x.high, place)
    for y in ANSWERS.values():
        for end, part in (("", "median"), ("_lower", "lower"), ("_upper", "upper")):
            meaning, place = f"{y.meaning}, {part}", Within(_STATE, f"answers.{y.name}.{part}")
            yield Measured(y.name + end, meaning, y.unit, kind, 0.0, MOST, place)
    for path, comment in _states(State()):
        meaning, unit = _meaning_and_unit(comment, path[-1])
        name, place = "_".join(("state", *path)), Within(_STATE, ".".join(("filters", *path)))
        yield Measured(name, meaning, unit, kind, -MOST, MOST, place)


def _states(part: Any, *path: str) -> Iterator[tuple[tuple[str, ...], str]]:
    """Return each number of a part of the state: the names on the way to it, its comment."""
    for name, x in members_of(part):
        if is_dataclass(x):
            yield from _states(x, *path, name)
        elif not isinstance(x, bool):
            yield (*path, name), comments(type(part).__name__)[name]


def _meaning_and_unit(comment: str, name: str) -> tuple[str, str]:
    """Return a comment and the last unit in it; if it is empty the name in words, and SI."""
    units = re.findall(r"\[([^\]]+)\]", comment)
    return comment or name.replace("_", " "), units[-1] if units else "SI"
