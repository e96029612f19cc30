"""A table that a person corrected: a new version, with its parent and what was set in its record.

What is tied to a value moves with it, so that the table stays sound:

    D in a row        f1 = D F_zr/F_z, f2 = -D F_zf/F_z at the z of the row; bands keep their width
    f1, f2 in a row   D, and the other one
    a pad             level and ratio of the pads; sigmas stay the same in percent

The tyre does not move with D, nor D with the pads: they are what the ramp gave.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calib.base.errors import RevisionError
from calib.base.program import PROGRAM
from calib.car.forces import axle_loads
from calib.store.mean_pads import RATIO
from calib.store.merged_keys import HandSetting, key_of, settings_of
from calib.store.version import Stored
from calib.table.by_hand import SetByHand
from calib.table.pad_levels import pad_levels, pad_scale
from calib.table.table import (
    BY_HAND,
    Calibration,
    DifferenceCurve,
    PaperCurves,
    Table,
    TableReference,
    TyrePosterior,
    Value,
)

Array = NDArray[np.float64]

CURVES_ONLY = (
    "D, f1 and f2 are what an ECU reads; `validate` estimates with the tyre of the table, which "
    "was not set"
)
PADS_ONLY = "the curves stay those of the ramp: a pad that is set by hand does not move them"


@dataclass(frozen=True)
class Moved:
    """A value ``key`` that moved from ``old`` to ``new`` because it is tied to one that was set."""

    key: str
    old: float
    new: float


@dataclass(frozen=True)
class Derived:
    """The corrected ``table``; what was ``set_`` in it now, and what ``moved`` along."""

    table: Table
    set_: tuple[SetByHand, ...]
    moved: tuple[Moved, ...]


def derive(parent: Stored, written: Iterable[str], reason: str, by: str = "") -> Derived:
    """Set values of a table by hand; ``written`` as ``KEY=VALUE``, see `calib.store.merged_keys`.

    Raises RevisionError for a parent that is rejected, withdrawn or outside of its store, without a
    reason, for an unknown key, an eta that is no row, a value that
    means nothing, and a value that the table has already.
    """
    if not (parent.state.usable and parent.state.known):
        raise RevisionError(
            f"{parent.id} is {parent.state.words}", do="correct a version that may be used"
        )
    if not reason.strip():
        raise RevisionError("no reason was given", do="say why the values are set by hand")
    table, before = parent.table, parent.table
    settings = settings_of(table, written)
    for setting in settings:
        table = (
            _with_pad(table, setting)
            if setting.row is None
            else _with_row(table, setting, setting.row)
        )
    said = (" ".join(reason.split()), " ".join(by.split()))
    keys = [(setting.name, setting.row) for setting in settings]
    set_ = tuple(SetByHand(*_change(before, table, *key), *said) for key in keys)
    for one in set_:
        if one.old == one.new:
            raise RevisionError(f"{one.key} is {one.old:.6g} already")
    tied = dict.fromkeys(key for setting in settings for key in _tied(setting))
    moved = tuple(Moved(*_change(before, table, *key)) for key in tied if key not in keys)
    return Derived(_as_child(table, parent, set_, settings), set_, moved)


def _as_child(
    table: Table, parent: Stored, set_: tuple[SetByHand, ...], settings: list[HandSetting]
) -> Table:
    notes = [CURVES_ONLY] * any(s.row is not None for s in settings)
    notes += [PADS_ONLY] * any(s.row is None for s in settings)
    said = (f"derived from {parent.id}", *map(str, set_), *notes)
    origin = replace(
        table.provenance,
        parents=(TableReference(parent.id, parent.digest),),
        program=PROGRAM,
    )
    return replace(
        table,
        provenance=origin,
        remarks=tuple(dict.fromkeys((*table.remarks, *said))),
        by_hand=(*table.by_hand, *set_),
    )


def _tied(setting: HandSetting) -> list[tuple[str, int | None]]:
    if setting.row is None:
        return [("pad_scale", None), ("pad_log_ratio", None)]
    return [(name, setting.row) for name in ("D", "f1", "f2")]


def _change(before: Table, after: Table, name: str, row: int | None) -> tuple[str, float, float]:
    return key_of(before, name, row), _read(before, name, row), _read(after, name, row)


def _read(table: Table, name: str, row: int | None) -> float:
    if row is None:
        value: Value = getattr(table.calibration, name)
        return value.value
    return float(table.difference.D[row] if name == "D" else getattr(table.paper, name)[row])


def _with_row(table: Table, setting: HandSetting, row: int) -> Table:
    """The table with D, f1 and f2 of a row moved, and their bands along."""
    d, p = table.difference, table.paper
    F_zf, F_zr = (float(x) for x in axle_loads(table.vehicle, p.z[row]))
    F_z = F_zf + F_zr
    per = {"D": 1.0, "f1": F_z / F_zr, "f2": -F_z / F_zf}[setting.name]  # (18)
    D = setting.value * per
    if abs(D) > 1.0:
        raise RevisionError(
            f"{setting.value:g} has no meaning for {key_of(table, setting.name, row)}: D would be "
            f"{D:.3g}",
            expected="a D of -1 to 1",
        )
    forces = {"f1": D * F_zr / F_z, "f2": -D * F_zf / F_z, setting.name: setting.value}
    d = replace(
        d,
        D=_at(d.D, row, D),
        flag=_at(d.flag, row, BY_HAND),
        **{end: _at(band, row, float(band[row] + D - d.D[row])) for end, band in _bands(d, "")},
    )
    moved = {"flag": _at(p.flag, row, BY_HAND)}
    for name in ("f1", "f2"):
        old = getattr(p, name)
        moved[name] = _at(old, row, forces[name])
        step = forces[name] - old[row]
        moved |= {
            end: _at(band, row, float(band[row] + step)) for end, band in _bands(p, f"{name}_")
        }
    return replace(table, difference=d, paper=replace(p, **moved))


def _bands(curve: DifferenceCurve | PaperCurves, first: str) -> list[tuple[str, Array]]:
    names = (f"{first}lower", f"{first}upper")
    return [(name, getattr(curve, name)) for name in names]


def _at(column: Array, row: int, value: float) -> Array:
    """A column with one value replaced."""
    return np.asarray(np.where(np.arange(column.size) == row, value, column))


def _with_pad(table: Table, setting: HandSetting) -> Table:
    """The table with one pad moved, and with it level and ratio; the posterior has the ratio."""
    old = table.calibration
    pads = replace(old, **{setting.name: _moved(getattr(old, setting.name), setting.value)})
    levels = pad_levels(table.vehicle, pads)
    pads = replace(
        pads,
        pad_scale=_moved(old.pad_scale, pad_scale(table.vehicle, levels)),
        pad_log_ratio=Value(levels.ratio, old.pad_log_ratio.sigma),
    )
    return replace(table, calibration=pads, posterior=_with_ratio(table.posterior, pads))


def _moved(old: Value, new: float) -> Value:
    return Value(new, new * old.sigma / old.value)


def _with_ratio(posterior: TyrePosterior, pads: Calibration) -> TyrePosterior:
    mean = (
        pads.pad_log_ratio.value if name == RATIO else value
        for name, value in zip(posterior.names, posterior.mean, strict=True)
    )
    return replace(posterior, mean=tuple(mean))
