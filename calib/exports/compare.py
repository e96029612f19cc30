"""Compare a DCM or CDF file that was read back with the table that it names.

Another tool may have saved the file: it keeps labels, may round numbers and drop rows.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import chain, product
from typing import NamedTuple

import numpy as np

from calib.base.errors import ExchangeError, TableNotFound
from calib.exports.build import build, maps_of, sliced
from calib.exports.dataset import Content, Grid, Numbers
from calib.exports.read import CDF, Returned
from calib.exports.symbols import prefix
from calib.exports.write import FORMATS
from calib.store.folders import names_in
from calib.store.store import Store
from calib.store.version import Stored
from calib.table.exported import BITS, Precision

_DIGITS = range(17, 2, -1)  # significant digits, or decimals, that a tool may have kept
_EDITED = "the numbers do not agree with its checksum"


class Pair(NamedTuple):
    """A number that was ``read`` in a file, and the ``true`` one of the table."""

    where: str  # label and place
    read: float
    true: float


def _best_rounding(pairs: Sequence[Pair]) -> tuple[str, list[Pair]]:
    """Return the rounding that explains most of the numbers, and the pairs that are left.

    The rounding is "" if the numbers are those of the table to the last bit.

    >>> _best_rounding([Pair("a", 0.333333, 1 / 3), Pair("b", 666.667, 2000 / 3)])
    ('to 6 significant digits', [])
    """
    formats = {f"to {n} significant digits": f".{n - 1}e" for n in _DIGITS}
    formats |= {f"to {n} decimals": f".{n}f" for n in _DIGITS}
    unexplained = {
        "": [x for x in pairs if x.read.hex() != x.true.hex()],
        "to single precision": [x for x in pairs if np.float32(x.read) != np.float32(x.true)],
    }
    if all(unexplained.values()):  # each of the two leaves some pairs
        for rounding, form in formats.items():
            unexplained[rounding] = [x for x in pairs if x.read not in _rounded(x.true, form)]
    best = min(unexplained, key=lambda rounding: len(unexplained[rounding]))
    return best, unexplained[best]


def _rounded(x: float, form: str) -> list[float]:
    """Return a number in double and in single precision, as text of a format has it."""
    return [float(f"{number:{form}}") for number in (x, float(np.float32(x)))]


def parent(file: Returned, store: Store) -> Stored | None:
    """Return the version that a file names in its head or else by its labels; None if unknown.

    Raises DamagedTable, and ExchangeError where several tables have such labels.
    """
    name, _, version = file.table.partition("@")
    if "table" not in file.facts:
        alike = [table for table in names_in(store.folder) if prefix(table) == name]
        if len(alike) > 1:
            flaw = f"its labels begin with {name}_, as those of {' and '.join(alike)} do"
            do = "export the table again, and keep the head of the file"
            raise ExchangeError(flaw, where=store.folder, do=do)
        name = alike[0] if alike else name
    try:
        return store.load(f"{name}@{version}")
    except TableNotFound:
        return None


class Difference(NamedTuple):
    """Where a file differs from its table."""

    wrong: list[str]  # contradictions, in words
    rounded: str = ""  # how the numbers were rounded; "" if they were not
    missing: tuple[str, ...] = ()  # labels of the table that are not in the file


def difference(file: Returned, stored: Stored | None) -> Difference:
    """Compare a file with a version, or without a version with the checksum in the file.

    Rounded numbers agree, and so does a selection of the rows. Raises ExchangeError where there is
    neither a version nor a checksum.
    """
    edited = [_EDITED] if file.unchanged is False else []
    if stored is None:
        if file.unchanged is None:
            flaw = f"{file.table} is not in this store, and the file has no checksum to hold it to"
            raise ExchangeError(flaw, do="give the store of that table with --store")
        advice = f"or were only rounded by a tool: give the store of {file.table} with --store"
        return Difference([f"{_EDITED}, {advice}"] if edited else [])
    tried = list[Difference]()
    for content in _candidates(stored, file):
        tried.append(_compared(file, content, edited))
        if not tried[-1].wrong:
            break
    result = min(tried, key=lambda difference: len(difference.wrong))
    claimed = file.facts.get("digest", stored.digest)
    if claimed != stored.digest:
        flaw = f"claims digest {claimed[:12]}, {stored.id} has {stored.digest[:12]}"
        result.wrong.insert(0, flaw)
    return result


def _compared(file: Returned, content: Content, edited: list[str]) -> Difference:
    """Compare a file with the numbers of a table; ``edited``: its contradiction to its checksum."""
    rounded, changed = _best_rounding(list(_pairs(file.content, content)))
    wrong = [] if rounded else edited.copy()  # rounding explains another checksum
    wrong += [f"{x.where}: {x.read!r}, the table has {x.true!r}" for x in changed]
    wrong += _structural_flaws(file, content)
    return Difference(wrong, rounded, tuple(sorted(_labels(content) - _labels(file.content))))


def _labels(content: Content) -> set[str]:
    return {*content.axes, *content.grids, *content.scalars}


def _candidates(stored: Stored, file: Returned) -> Iterator[Content]:
    """Yield the numbers of a table as an export to this format has them, then as for C code.

    A map with more axes than the format allows is sliced at the rows of the file.
    """
    most = FORMATS["cdfx" if file.format == CDF else "dcm"].most_axes
    data = build(stored, first=file.prefix)
    maps: list[Grid] = []
    for grid in data.maps:
        rows = grid.axis.numbers
        near = _nearest(file.content.axes.get(grid.axis.label, rows), rows)
        maps += sliced(grid, near) if len(grid.axes) > most else [grid]
    yield replace(data, maps=tuple(maps)).content()
    points = max((len(x) for x in file.content.axes.values()), default=None)
    for bits in (None, *BITS):  # maps for code have rounded axes, which depend on the precision
        how = Precision(points, bits, single=bits is None, code=True)
        axes, grids = zip(*maps_of(stored.table, file.prefix, how, most), strict=True)
        flat_axes, flat_maps = (tuple(chain.from_iterable(x)) for x in (axes, grids))
        yield replace(data, axes=flat_axes, maps=flat_maps).content()


def _pairs(read: Content, table: Content) -> Iterator[Pair]:
    """Pair each number of a file with that of the same label at the nearest row of the table."""
    for name in sorted(read.scalars.keys() & table.scalars.keys()):
        yield Pair(name, read.scalars[name], table.scalars[name])
    read_axes, table_axes = _all_axes(read), _all_axes(table)
    for name in sorted(read_axes.keys() & table_axes.keys()):
        near = _nearest(read_axes[name], table_axes[name])
        yield from (Pair(name, x, row) for x, row in zip(read_axes[name], near, strict=True))
    for name in sorted(read.grids.keys() & table.grids.keys()):
        (axes, values), (axes_rows, cells) = read.grids[name], table.grids[name]
        cell_at = dict(zip(product(*axes_rows), cells, strict=True))
        near_rows = [_nearest(x, rows) for x, rows in zip(axes, axes_rows, strict=True)]
        for place, rows, value in zip(product(*axes), product(*near_rows), values, strict=True):
            where = place if len(place) > 1 else place[0]
            yield Pair(f"{name} at {where!r}", value, cell_at[rows])


def _all_axes(content: Content) -> dict[str, Numbers]:
    """Return the shared axes by label, and the axis of each curve."""
    grids = content.grids.items()
    return content.axes | {f"{name}, axis": x[0] for name, (x, _) in grids if len(x) == 1}


def _nearest(points: Sequence[float], rows: Sequence[float]) -> Sequence[float]:
    """Return the row of the table for each point of a file.

    As many points as rows are paired in order, since rounded points may coincide.
    """
    if len(points) == len(rows):
        return rows
    return [min(rows, key=lambda row: abs(row - x)) for x in points]


def _structural_flaws(file: Returned, table: Content) -> list[str]:
    """Return labels that the table does not have, and curves that do not span the table.

    A tool may save other objects of an ECU, too; the labels of this table begin with its name.
    """
    unknown = _labels(file.content) - _labels(table)
    flaws = [f"{name}: only in the file" for name in unknown if name.startswith(f"{file.prefix}_")]
    for name in file.content.grids.keys() & table.grids.keys():
        for x, rows in zip(file.content.grids[name][0], table.grids[name][0], strict=True):
            near = _nearest(x, rows)
            if (near[0], near[-1]) != (rows[0], rows[-1]):
                flaws.append(f"{name}: does not reach both ends of the table")
            elif len(set(near)) != len(near):
                flaws.append(f"{name}: two of its points are one row of the table")
    return sorted(flaws)
