"""Sources of channels that the user names, and their values."""

import numpy as np
from numpy.typing import NDArray

from calib.base.errors import InputError
from calib.base.names import CHANNELS
from calib.base.units import UnknownUnit, from_si, is_unit, unit_of
from calib.logs.channel_map import Mapping
from calib.logs.source import Column, ColumnSource, address_of, called
from calib.logs.text.cells import column_from_cell
from calib.suggest.proposal import SURE, Proposal
from calib.suggest.series import Series
from calib.suggest.wheels import rim_mapping, rim_reason

Array = NDArray[np.float64]


def told_source(
    channel: str, cell: str, source: ColumnSource, where: str, radius: float | None
) -> Proposal | None:
    """The proposal for a channel whose source the user names; None for an empty name.

    ``cell`` is the name of a column of ``source``, with or without a unit; with a ``radius`` [m] a
    wheel speed may be one at the rim. Raises InputError for a channel, column or unit that does
    not fit.
    """
    if channel not in CHANNELS:
        raise InputError(f"there is no channel {channel!r}", expected=", ".join(CHANNELS))
    if not cell:
        return None
    column = _column_called(cell, source, where)
    address, given = address_of(column, source.columns), column_from_cell(cell)
    unit = given.unit if column.name != cell and given.unit != column.unit else None
    mapping = rim_mapping(channel, address, unit or column.unit, radius)
    if mapping is not None and radius is not None:
        return Proposal(channel, mapping, SURE, ("given", rim_reason(radius)))
    _check_unit(unit or column.unit, channel, cell)
    return Proposal(channel, Mapping(address, unit), SURE, ("given",))


def _column_called(cell: str, source: ColumnSource, where: str) -> Column:
    """The column with this address, also if ``cell`` has another unit.

    Raises InputError if there is none, or more than one.
    """
    columns = source.columns
    found = called(cell, columns) or called(column_from_cell(cell).name, columns)
    if len(found) == 1:
        return columns[found[0]]
    if found:
        names = ", ".join(repr(address_of(columns[i], columns)) for i in found)
        raise InputError(f"{where} has {len(found)} columns {cell!r}", expected=f"one of {names}")
    names = ", ".join(repr(c.name) for c in columns)
    raise InputError(f"{where} has no column {cell!r}", expected=f"one of {names}")


def _check_unit(unit: str | None, channel: str, cell: str) -> None:
    """Raise InputError if the unit is missing or of another quantity."""
    si = CHANNELS[channel].si
    if unit is None:
        do = f"give it: '{channel}={cell} [{CHANNELS[channel].unit}]'"
        raise InputError(f"{cell!r} has no unit", where=channel, expected=f"one of {si}", do=do)
    try:
        unit_of(unit, si)
    except UnknownUnit as cause:
        rim = channel.startswith("omega_") and is_unit(unit, "m/s")
        radius = "give the radius with which the car computes it: --radius 0.31" if rim else ""
        raise InputError(f"{cell!r}: {cause}", where=channel, do=radius) from cause


def values_of(series: Series, proposal: Proposal | None) -> Array | None:
    """The values [SI] of a column if it is the source of ``proposal``, else None."""
    if proposal is None or series.name != proposal.mapping.source:
        return None
    mapping = proposal.mapping
    if mapping.unit is None:
        return series.values
    # A given unit overrides the file's: undo that conversion, then apply the given one.
    written = series.values
    if series.column.unit and series.si not in (None, "?"):
        written = from_si(series.values, series.column.unit, str(series.si))
    return mapping.to_si(written, mapping.unit, CHANNELS[proposal.channel].si)
