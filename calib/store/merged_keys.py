"""What a person may set in a table, and how it is written.

    pad_friction_f=0.39   pad_friction_r=0.37     pads of the calibration [1]
    D[1.00250]=0.081                              D in the row at this eta [1]
    f1[1.00250]=0.031   f2[1.00250]=-0.050        the same row by f1 or f2 [1]

One value fixes a row: D, f1 and f2 are tied by (18). Eta is written with as many digits as tell the
row from its neighbours.
"""

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from calib.base.errors import RevisionError
from calib.base.toml import did_you_mean
from calib.plausibility.limits import PLAUSIBLE
from calib.table.table import Table

PADS = ("pad_friction_f", "pad_friction_r")
CURVES = ("D", "f1", "f2")
KNOWN = (*PADS, *(f"{curve}[ETA]" for curve in CURVES))

EXACT = 1e-9
"""Distance [1] within which an eta is that of a row: of what is written, all digits agree."""

WRITTEN = re.compile(r"(?P<curve>\w+)\[(?P<eta>[^\]]*)\]")


@dataclass(frozen=True)
class HandSetting:
    """A ``value`` [1] for a pad or for a curve in a ``row``; ``name`` one of `PADS` or `CURVES`.

    ``row`` is None for a pad.
    """

    name: str
    row: int | None
    value: float


def settings_of(table: Table, written: Iterable[str]) -> list[HandSetting]:
    """Settings from ``KEY=VALUE``. Raises RevisionError for one that means nothing in ``table``."""
    found = [_setting(table, one) for one in written]
    if not found:
        raise RevisionError("nothing to set", expected="KEY=VALUE, " + ", ".join(KNOWN))
    places = [s.name if s.row is None else f"row {s.row}" for s in found]
    for place, setting in zip(places, found, strict=True):
        if places.count(place) > 1:
            key = setting.name if setting.row is None else key_of(table, "eta", setting.row)
            raise RevisionError(
                f"{key} is set twice", do="one value fixes a pad or a row: D, f1 and f2 are tied"
            )
    return found


def key_of(table: Table, name: str, row: int | None) -> str:
    """The key as it is kept: `pad_friction_f`, `D[1.0025]`."""
    return name if row is None else f"{name}[{float(table.difference.eta[row]):.8g}]"


def _setting(table: Table, written: str) -> HandSetting:
    key, equals, number = (part.strip() for part in written.partition("="))
    if not equals:
        raise RevisionError(f"{written!r} sets nothing", expected="KEY=VALUE")
    match = WRITTEN.fullmatch(key)
    name = match["curve"] if match else key
    if (name not in CURVES) if match else (name not in PADS):
        near = did_you_mean(name, [*PADS, *CURVES])
        raise RevisionError(
            f"{key!r} cannot be set" + (f"; {near}" if near else ""),
            expected="one of " + ", ".join(KNOWN),
        )
    row = _row(table, key, match["eta"].strip()) if match else None
    return HandSetting(name, row, _value(name, key, number))


def _value(name: str, key: str, written: str) -> float:
    low, high = PLAUSIBLE.pads_possible if name in PADS else (-1.0, 1.0)
    try:
        value = float(written)
    except ValueError:
        value = math.nan
    if not low <= value <= high:
        raise RevisionError(
            f"{written!r} has no meaning for {key}", expected=f"{low:g} to {high:g}"
        )
    return value


def _row(table: Table, key: str, written: str) -> int:
    eta = table.difference.eta
    if not np.array_equal(eta, table.paper.eta):
        raise RevisionError(
            f"{key} cannot be set: D has other rows than f1 and f2 in this table",
            do="fit the table again",
        )
    try:
        wanted = float(written)
    except ValueError:
        raise RevisionError(f"{key}: {written!r} is no eta", expected="a number") from None
    digits = len(written.partition(".")[2])
    near = np.argsort(np.abs(eta - wanted), kind="stable")
    fits = [i for i in near[:2].tolist() if abs(round(float(eta[i]), digits) - wanted) < EXACT]
    if len(fits) == 1 or abs(eta[near[0]] - wanted) < EXACT:
        return _set_row(eta[fits[0]], fits[0], key)
    shown = " and ".join(f"{x:.8g}" for x in sorted(eta[near[:2]].tolist()))
    if fits:
        raise RevisionError(f"{key} fits two rows, {shown}", do="write more digits")
    raise RevisionError(f"{key}: no row has this eta", expected=f"the nearest rows are at {shown}")


def _set_row(eta: float, row: int, key: str) -> int:
    if eta == 1.0:
        raise RevisionError(f"{key} cannot be set: D = 0 where the wheels turn alike")
    return row
