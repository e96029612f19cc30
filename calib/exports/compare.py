"""A DCM or CDF file that was read back, compared with the table that it names."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import chain, product
from typing import NamedTuple

import numpy as np

from calib.base.errors import ExchangeError, TableNotFound
from calib.exports.build import build, maps_of, sliced
from calib.exports.dataset import Content, Grid
from calib.exports.read import CDF, Returned
from calib.exports.symbols import prefix
from calib.exports.write import FORMATS
from calib.store.folders import names_in
from calib.store.store import Store
from calib.store.version import Stored
from calib.table.exported import BITS, Precision

_DIGITS = range(17, 2, -1)  # significant ones or decimals that a tool may have kept
_EDITED = "the numbers do not agree with its checksum"


class Pair(NamedTuple):
    """A number as read in a file, with what the table has there; ``where`` its label and place."""

    where: str
    read: float
    true: float


def _best_rounding(pairs: Sequence[Pair]) -> tuple[str, list[Pair]]:
    """The way in which the numbers read were rounded, and those that it does not explain.

    The way is empty where the numbers are those of the table to the last bit.

    >>> _best_rounding([Pair("a", 0.333333, 1 / 3), Pair("b", 666.667, 2000 / 3)])
    ('to 6 significant digits', [])
    >>> _best_rounding([Pair("a", 0.25, 0.25), Pair("b", 0.4, 0.38)])
    ('', [Pair(where='b', read=0.4, true=0.38)])
    """
    ways = {f"to {n} significant digits": f".{n - 1}e" for n in _DIGITS}
    ways |= {f"to {n} decimals": f".{n}f" for n in _DIGITS}
    unexplained = {
        "": [pair for pair in pairs if pair.read.hex() != pair.true.hex()],
        "to single precision": [p for p in pairs if np.float32(p.read) != np.float32(p.true)],
    }
    for way, form in ways.items() if all(unexplained.values()) else ():
        unexplained[way] = [pair for pair in pairs if not _rounds(pair, form)]
    best = min(unexplained, key=lambda way: len(unexplained[way]))
    return best, unexplained[best]


def _rounds(pair: Pair, form: str) -> bool:
    return pair.read in (float(f"{x:{form}}") for x in (pair.true, float(np.float32(pair.true))))


def parent(file: Returned, store: Store) -> Stored | None:
    """The version that the head of a file names, or its labels; None where the store has none.

    Raises DamagedTable, and ExchangeError where several tables have such labels.
    """
    name, _, version = file.table.partition("@")
    if "table" not in file.facts:
        alike = [one for one in names_in(store.folder) if prefix(one) == name]
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
    """Contradictions of a file in words, and how its numbers were ``rounded``, "" if not at all."""

    wrong: list[str]
    rounded: str = ""
    missing: tuple[str, ...] = ()  # labels of the table that are not in the file


def difference(file: Returned, stored: Stored | None) -> Difference:
    """Contradictions in a file: to the table of the store, or to its own checksum without one.

    Rounded numbers agree, and so does a selection of the rows. Raises ExchangeError where there is
    neither table nor checksum.
    """
    edited = [_EDITED] if file.unchanged is False else []
    if stored is None:
        if file.unchanged is None:
            flaw = f"{file.table} is not in this store, and the file has no checksum to hold it to"
            raise ExchangeError(flaw, do="give the store of that table with --store")
        rounds = f"so does a tool that rounds them: give the store of {file.table} with --store"
        return Difference([f"{_EDITED}; {rounds}"] if edited else [])
    tried = list[Difference]()
    for content in _candidates(stored, file):
        tried.append(_compared(file, content, edited))
        if not tried[-1].wrong:
            break
    result = min(tried, key=lambda one: len(one.wrong))
    claimed = file.facts.get("digest", stored.digest)
    if claimed != stored.digest:
        flaw = f"claims digest {claimed[:12]}, {stored.id} has {stored.digest[:12]}"
        result.wrong.insert(0, flaw)
    return result


def _compared(file: Returned, content: Content, edited: list[str]) -> Difference:
    rounded, changed = _best_rounding(list(_pairs(file.content, content)))
    wrong = [f"{one.where}: {one.read!r}, the table has {one.true!r}" for one in changed]
    absent = tuple(sorted(_labels(content) - _labels(file.content)))
    return Difference(
        [*([] if rounded else edited), *wrong, *_gaps(file, content)], rounded, absent
    )


def _labels(content: Content) -> set[str]:
    return {*content.axes, *content.grids, *content.scalars}


def _candidates(stored: Stored, file: Returned) -> Iterator[Content]:
    """The numbers of a table, its maps in the slices that the file has; then as C code reads it."""
    most = FORMATS["cdfx" if file.format == CDF else "dcm"].most_axes
    data = build(stored, first=file.prefix)
    whole: list[Grid] = []
    for one in data.maps:
        rows = one.axis.numbers
        near = _nearest(file.content.axes.get(one.axis.label, rows), rows)
        whole += sliced(one, near) if len(one.axes) > most else [one]
    yield replace(data, maps=tuple(whole)).content()
    points = max((len(x) for x in file.content.axes.values()), default=None)
    for bits in (None, *BITS):  # the axes of code are rounded first
        how = Precision(points, bits, single=bits is None, code=True)
        axes, maps = zip(*maps_of(stored.table, file.prefix, how, most), strict=True)
        over = tuple(chain.from_iterable(axes))
        yield replace(data, axes=over, maps=tuple(chain.from_iterable(maps))).content()


def _pairs(read: Content, whole: Content) -> Iterator[Pair]:
    """Every number of the labels that both have, with that of the nearest row of the table."""
    for name in sorted(read.scalars.keys() & whole.scalars.keys()):
        yield Pair(name, read.scalars[name], whole.scalars[name])
    axes, theirs = (
        one.axes | {f"{n}, axis": x[0] for n, (x, _) in one.grids.items() if len(x) == 1}
        for one in (read, whole)
    )
    for name in sorted(axes.keys() & theirs.keys()):
        near = _nearest(axes[name], theirs[name])
        yield from (Pair(name, x, row) for x, row in zip(axes[name], near, strict=True))
    for name in sorted(read.grids.keys() & whole.grids.keys()):
        (over, values), (whole_over, cells) = read.grids[name], whole.grids[name]
        by_place = dict(zip(product(*whole_over), cells, strict=True))
        rows = product(*(_nearest(x, row) for x, row in zip(over, whole_over, strict=True)))
        for place, value, cell in zip(product(*over), values, rows, strict=True):
            yield Pair(
                f"{name} at {place if len(place) > 1 else place[0]!r}", value, by_place[cell]
            )


def _nearest(points: Sequence[float], rows: Sequence[float]) -> Sequence[float]:
    """The row of the table that each point is; rounded points of eta may be alike."""
    if len(points) == len(rows):
        return rows
    return [min(rows, key=lambda row: abs(row - x)) for x in points]


def _gaps(file: Returned, whole: Content) -> list[str]:
    """Labels that the table lacks, and curves that end before the table does.

    A tool may save other objects of an ECU along; labels of this table begin with its name.
    """
    more = _labels(file.content) - _labels(whole)
    gaps = [f"{name}: only in the file" for name in more if name.startswith(f"{file.prefix}_")]
    for name in file.content.grids.keys() & whole.grids.keys():
        for x, rows in zip(file.content.grids[name][0], whole.grids[name][0], strict=True):
            row = _nearest(x, rows)
            if (row[0], row[-1]) != (rows[0], rows[-1]):
                gaps.append(f"{name}: does not reach both ends of the table")
            elif len(set(row)) != len(row):
                gaps.append(f"{name}: two of its points are one row of the table")
    return sorted(gaps)
