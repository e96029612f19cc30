"""The maps that the code of an ECU reads, by the labels of every other format.

A calibration tool finds them under the same names in A2L, DCM and CDF. Cells are as the export
writes them; axes are in the floating point that the code computes with.
"""

from dataclasses import replace

from calib.ecu.width import Width
from calib.estimation.constants import LEVEL, PADS, SLIP
from calib.exports.dataset import MOST_AXES, Axis, Dataset, Grid, build, maps_of
from calib.store.evidence import UNPROVED, Quality
from calib.store.version import Stored
from calib.table.table import Table

READ = frozenset((*(names[0] for names in PADS), *SLIP, *LEVEL))
"""Columns of the maps that the code reads."""


def code_maps(
    table: Table, first: str, width: Width, most_axes: int = MOST_AXES
) -> tuple[tuple[Axis, ...], tuple[Grid, ...]]:
    """Axes and maps with labels that begin with ``first``; sliced where they have more axes.

    Raises ExchangeError as `calib.table.exported.Precision`.
    """
    axes, grids = dict[str, Axis](), list[Grid]()
    for of_map, made in maps_of(table, first, width.how, most_axes):
        axes |= {one.label: _real(one, width) for one in of_map}
        read = (grid for grid in made if grid.column in READ)
        grids += [replace(g, axes=tuple(axes[a.label] for a in g.axes)) for g in read]
    return tuple(axes.values()), tuple(grids)


def _real(axis: Axis, width: Width) -> Axis:
    read = axis.values if axis.fixed is None else axis.fixed.values
    return replace(axis, values=width.rounded(read), fixed=None)


def code_data(
    stored: Stored,
    first: str,
    width: Width,
    date: str,
    quality: Quality = UNPROVED,
    most_axes: int = MOST_AXES,
) -> Dataset:
    """What a calibration tool sees of the code of a version: its number and the maps."""
    how = width.how
    whole = build(stored, how.points, quality, how.bits, date, first=first, most_axes=most_axes)
    axes, grids = code_maps(stored.table, first, width, most_axes)
    versions = (one for one in whole.scalars if one.label == version_label(first))
    return replace(
        whole,
        axes=axes,
        curves=(),
        grids=grids,
        scalars=tuple(replace(one, fixed=None) for one in versions),
        single=width.bits == 32,
    )


def version_label(first: str) -> str:
    """Label of the version of the table."""
    return f"{first}_version"
