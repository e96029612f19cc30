"""The estimator in C: bte.h and bte.c, the same for every car of a precision.

Names, units and meanings of inputs, answers, states and numbers are those of Python.
"""

import inspect
import re
import zlib
from collections.abc import Iterable, Iterator
from dataclasses import fields, is_dataclass
from functools import cache
from importlib import resources
from pathlib import Path
from string import Template
from typing import Any, TypeAlias

import numpy as np

from calib.ecu.translation import structure, translated
from calib.estimation import constants, state
from calib.estimation.online import ANSWERS, CHANNELS
from calib.estimation.reasons import CHECKS, Reason
from calib.estimation.state import Sample, State
from calib.table.exported import Precision

SOURCE = Path(__file__).parent / "source"
_MATH = {  # by bits: the name of sqrt in C, terms of exp and ln, largest argument of exp
    32: {"function": "name##f", "terms": 8, "largest": 87},
    64: {"function": "name", "terms": 14, "largest": 700},
}
_IN_PYTHON = {"v", "log_odds", "driven"}  # of a `Sample`: the code has no such member
_BY_HAND = {
    "waiting",
    "held_ratio",
    "zero_slip",
}  # of a `State`: bte.h declares them, or they serve v

Member: TypeAlias = Any
"""A member of a structure: a float, an int (a count), text as in C, a list, or a structure."""


def code(precision: Precision) -> str:
    """bte.c in a precision."""
    equations = (resources.files("calib.estimation") / "equations.py").read_text(encoding="utf-8")
    facts = {"equations": translated(equations), "floating": precision.floating}
    return source("bte.c").substitute(_MATH[precision.floating], **facts)


def header(numbers: Iterable[tuple[str, str]], precision: Precision) -> tuple[str, str]:
    """bte.h, and the checksum of its layout; ``numbers``: name and comment of each of a car."""
    structures = {type(x): x for _, x in members_of(State()) if is_dataclass(x)}
    read, answered = (((x.name, f"{x.meaning} [{x.unit}]") for x in of.values())
                      for of in (CHANNELS, ANSWERS))  # fmt: skip
    text = source("bte.h").safe_substitute(
        real="float" if precision.floating == 32 else "double",
        cell=cell(precision),
        reasons="\n".join(f"    BTE_{x.name} = {int(x)}, /* {x.words} */" for x in Reason),
        count=len(CHANNELS),
        checks=", ".join(f"BTE_{x.upper()}" for x in CHECKS).replace(",", " = BTE_INPUTS,", 1),
        inputs=_declared("bte_real", read),
        answers=_declared("bte_interval", answered),
        numbers=_declared("bte_real", numbers),
        structures="\n\n".join(map(_structure, structures.values())),
        filters="\n".join(_members(State())),
        block=", ".join(name for name in Sample._fields if name not in _IN_PYTHON),
    )
    layout = f"0x{zlib.crc32(text.encode()):08X}U"
    return Template(text).substitute(layout=layout), layout


def source(name: str) -> Template:
    """The template of that name among the sources."""
    return Template((SOURCE / name).read_text(encoding="utf-8"))


def cell(precision: Precision) -> str:
    """Type of the cells of the maps in C."""
    return f"int{precision.bits}_t" if precision.bits else "bte_real"


def members_of(owner: Member) -> list[tuple[str, Member]]:
    """Members of a structure with their values, in the order of C: booleans come last."""
    names = (x.name for x in fields(owner) if x.name not in _BY_HAND)
    members = [(name, getattr(owner, name)) for name in names]
    return sorted(members, key=lambda member: isinstance(member[1], bool))


@cache
def comments(class_name: str) -> dict[str, str]:
    """What the source says of each member of `Constants` or of the state, its unit in brackets."""
    row = r"^    (\w+): [^#\n]*(?:# (.*(?:\n    # .*)*))?$"
    rows = re.findall(
        row, inspect.getsource({**vars(constants), **vars(state)}[class_name]), re.MULTILINE
    )
    return {name: text.replace("\n    #", "") for name, text in rows}


def _structure(value: Member) -> str:
    name = structure(type(value).__name__)
    return "\n".join(("typedef struct {", *_members(value), f"}} {name};"))


def _members(value: Member) -> Iterator[str]:
    about = comments(type(value).__name__)
    for name, x in members_of(value):
        kind = structure(type(x).__name__) if is_dataclass(x) else "bte_real"
        yield _declared("bool" if isinstance(x, bool) else kind, [(name, about[name])])


def _declared(kind: str, rows: Iterable[tuple[str, str]]) -> str:
    return "\n".join(f"    {kind} {name};{f' /* {about} */' * bool(about)}" for name, about in rows)


def initial(x: Member, bits: int) -> str:
    """The initial value of a member in C, which reads back to the same float of ``bits``."""
    if is_dataclass(x) and not isinstance(x, type):
        x = dict(members_of(x))
    if isinstance(x, dict):
        return f"{{{', '.join(f'.{name} = {initial(y, bits)}' for name, y in x.items())}}}"
    if isinstance(x, list | tuple):
        return f"{{{', '.join(initial(y, bits) for y in x)}}}"
    if not isinstance(x, float):
        return str(x).lower() if isinstance(x, bool) else str(x)
    return f"{np.float32(x)!s}F" if bits == 32 else repr(float(x))
