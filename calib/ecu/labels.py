"""The maps that the code of an ECU reads, by the labels of every other format.

A calibration tool finds them under the same names in A2L, DCM and CDF. Cells are as the export
writes them; axes are in the floating point that the code computes with.
"""

from dataclasses import replace
from datetime import UTC, datetime

from calib.estimation.constants import LEVEL, PADS, SLIP
from calib.exports.dataset import MOST_AXES, Axis, Dataset, Grid, build, maps_of
from calib.store.evidence import UNPROVED, Quality
from calib.store.version import Stored
from calib.table.exported import Precision
from calib.table.table import Table

READ = frozenset((*(names[0] for names in PADS), *SLIP, *LEVEL))
"""Columns of the maps that the code reads."""


def version_label(first: str) -> str:
    """Label of the version of the table."""
    return f"{first}_version"


def code_maps(
    table: Table, first: str, how: Precision, most_axes: int = MOST_AXES
) -> tuple[tuple[Axis, ...], tuple[Grid, ...]]:
    """Axes and maps with labels that begin with ``first``; sliced where they have more axes.

    Raises ExchangeError as `Precision`.
    """
    axes, grids = dict[str, Axis](), list[Grid]()
    for of_map, made in maps_of(table, first, how, most_axes):
        for a in of_map:
            read = a.values if a.fixed is None else a.fixed.values
            axes[a.label] = replace(a, values=how.computed(read), fixed=None)
        of = (grid for grid in made if grid.column in READ)
        grids += [replace(g, axes=tuple(axes[a.label] for a in g.axes)) for g in of]
    return tuple(axes.values()), tuple(grids)


def code_data(
    stored: Stored,
    first: str,
    how: Precision,
    quality: Quality = UNPROVED,
    most_axes: int = MOST_AXES,
) -> Dataset:
    """What a calibration tool sees of the code of a version: its number and the maps."""
    date = datetime.now(UTC).date().isoformat()
    whole = build(stored, how.points, quality, how.bits, date, first=first, most_axes=most_axes)
    axes, grids = code_maps(stored.table, first, how, most_axes)
    number = (replace(x, fixed=None) for x in whole.scalars if x.label == version_label(first))
    single = how.floating == 32
    return replace(whole, axes=axes, curves=(), grids=grids, scalars=tuple(number), single=single)
