"""A DCM or CDF file read back, and compared with the table that it names."""

from pathlib import Path

from calib.errors import DamagedTable, ExchangeError, TableNotFound
from calib.exports.build import build
from calib.exports.cdfx_reader import read_cdfx
from calib.exports.dataset import Content
from calib.exports.dcm_reader import read_dcm
from calib.exports.returned import Returned
from calib.files.bounded import CALIBRATION, bytes_of
from calib.store.store import Store
from calib.store.version import Stored


def read_back(path: Path) -> Returned:
    """The content of a DCM or CDF file; its first character tells which of them it is.

    Raises ExchangeError when it cannot be read, is cut off or damaged, or is no export of this
    program.
    """
    data = bytes_of(path, CALIBRATION, ExchangeError, "DCM or CDF")
    if data.lstrip(b"\xef\xbb\xbf \r\n\t").startswith(b"<"):
        return read_cdfx(path, data)
    try:
        return read_dcm(path, data.decode("utf-8-sig"))
    except UnicodeDecodeError as error:
        raise ExchangeError(
            f"not text ({error.reason})", where=path, expected="DCM or CDF"
        ) from error


def parent(found: Returned, store: Store) -> Stored | None:
    """The version that the file names, None where the store does not have it.

    Raises DamagedTable where that version is damaged.
    """
    try:
        return store.load(found.facts["table"])
    except TableNotFound:
        return None


def differences(found: Returned, stored: Stored | None) -> list[str]:
    """Contradictions in a file: to its checksum, and to the table of the store if there is one.

    A file on fewer breakpoints agrees when each of its rows equals a row of the table to the last
    bit.
    """
    wrong = [] if found.unchanged else ["the numbers do not agree with its checksum"]
    if stored is None:
        return wrong
    if found.facts["digest"] != stored.digest:
        wrong.append(
            f"claims digest {found.facts['digest'][:12]}, {stored.id} has {stored.digest[:12]}"
        )
    return wrong + _gaps(found.content, build(stored).content())


def _gaps(found: Content, whole: Content) -> list[str]:
    gaps = [f"{name}: only in the file" for name in _labels(found) - _labels(whole)]
    gaps += [f"{name}: only in the table" for name in _labels(whole) - _labels(found)]
    gaps += [
        f"{name}: {found.scalars[name]!r}, the table has {whole.scalars[name]!r}"
        for name in found.scalars.keys() & whole.scalars.keys()
        if found.scalars[name].hex() != whole.scalars[name].hex()
    ]
    for name in found.axes.keys() & whole.axes.keys():
        foreign = sorted(set(found.axes[name]) - set(whole.axes[name]))
        gaps += [f"{name}: {x!r} is no row of the table" for x in foreign[:1]]
    for name in found.curves.keys() & whole.curves.keys():
        gaps += _curve_gap(name, found.curves[name], whole.curves[name])
    return sorted(gaps)


def _curve_gap(
    name: str, found: tuple[tuple[float, ...], ...], whole: tuple[tuple[float, ...], ...]
) -> list[str]:
    """The first row that is not in the table, or a missing end of the axis; None if it agrees."""
    table = dict(zip(*whole, strict=True))
    for x, y in zip(*found, strict=True):
        if x not in table or table[x].hex() != y.hex():
            has = f"the table has {table[x]!r}" if x in table else "no row of the table"
            return [f"{name}: {y!r} at {x!r}, {has}"]
    ends = (found[0][0], found[0][-1]) == (whole[0][0], whole[0][-1])
    return [] if ends else [f"{name}: does not reach both ends of the table"]


def _labels(content: Content) -> set[str]:
    return {*content.axes, *content.curves, *content.scalars}


def refuse(path: Path, wrong: list[str]) -> DamagedTable:
    """The error for a file that contradicts its checksum or its table."""
    more = f" (and {len(wrong) - 1} more)" if len(wrong) > 1 else ""
    return DamagedTable(
        f"{wrong[0]}{more}", where=path, do="it was edited or damaged: export the table again"
    )
