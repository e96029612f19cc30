"""The formats of logs: which kind of file the bytes are, and how each file ending is opened.

The channels of a table share one clock. Those of a recording, such as bus frames, have clocks of
their own and are resampled where a table is needed.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from calib.base.arrays import Array
from calib.base.bounded import POINTER
from calib.base.errors import LogError, printable
from calib.logs.bus.blf import open_blf
from calib.logs.bus.text_logs import TEXT_LOGS, open_text_log
from calib.logs.channel_map import Assigned, Databases
from calib.logs.mdf import open_mdf
from calib.logs.parquet import open_parquet
from calib.logs.resample import on_one_clock
from calib.logs.source import ChannelTrace, Column, ColumnSource, Recording, read_each
from calib.logs.text.csv import open_csv
from calib.logs.text.dialect import TextFormat
from calib.logs.text.vbo import open_vbo

MDF = (".mf4", ".mdf", ".dat")
_KINDS: tuple[tuple[bytes, str, tuple[str, ...]], ...] = (
    (rb"PAR1", "a Parquet file", (".parquet",)),
    (rb"MDF  |UnFin", "an MDF file", MDF),
    (rb"LOGG[^\t -~]", "a BLF file", (".blf",)),  # a CSV may begin with "LOGGER"
    (rb"\(\d+\.\d+\) +\S+ +[0-9a-fA-F]+#", "a candump log", (".log",)),
    (rb"(?i:date [^,;\t\n]+\r?\nbase +(hex|dec))", "a Vector ASC log", (".asc",)),
    (rb"(?i:;\$fileversion=)", "a PEAK TRC log", (".trc",)),
    (rb"(?i:file created on )", "a VBO log", (".vbo",)),
    (rb"PK\x03\x04", "a zip archive or a workbook", ()),
    (rb"MATLAB \d|\x89HDF", "a MATLAB or HDF5 file", ()),
    (rb"(?i:<!doctype html|<html)", "a web page", ()),
    (rb"(?i:<\?xml)", "an XML file", ()),
    (rb"\{", "a JSON file", ()),
)
"""Pattern of the first bytes of a kind of file, its name, and the endings that it may have."""


def refuse_other_kind(head: bytes, ending: str, where: object) -> None:
    """Raise LogError if ``head``, the first 64 bytes, is that of another kind than ``ending``."""
    if head.startswith(POINTER):
        flaw, do = "a pointer of git LFS, not the log itself", "get the file: git lfs pull"
        raise LogError(flaw, where=where, expected=f"the bytes of a {ending} file", do=do)
    text = head.lstrip(b"\xef\xbb\xbf \t\r\n")
    for pattern, name, endings in _KINDS:
        if re.match(pattern, text) and ending not in endings:
            expected = f"a log that is what its ending {ending} says"
            do = f"rename it to {endings[0]}" if endings else "export or copy the log again"
            raise LogError(f"{name}, not a {ending} file", where=where, expected=expected, do=do)


TABLES: dict[str, Callable[[bytes, str, TextFormat], ColumnSource]] = {
    ".csv": open_csv,
    ".csv.gz": open_csv,
    ".tsv": open_csv,
    ".txt": open_csv,
    ".parquet": open_parquet,
    ".vbo": open_vbo,
}
"""By file ending: the function that opens the bytes of a table; it takes bytes, path and format."""


def ending_of(path: Path) -> str:
    """File name ending that gives the format, in lower case: ``.csv.gz`` of ``run.csv.gz``."""
    double = "".join(path.suffixes[-2:]).lower()
    return double if path.suffix.lower() == ".gz" else path.suffix.lower()


def stem_of(path: Path) -> str:
    """Name of a log, safe to print: ``ramp.2`` of ``runs/ramp.2.csv.gz``."""
    path = Path(path)
    ending = ending_of(path)
    return printable(path.name[: -len(ending)] if ending else path.name)


RECORDINGS: dict[str, Callable[[Path, Databases], Recording]] = {
    **dict.fromkeys(MDF, open_mdf),
    ".blf": open_blf,
    **dict.fromkeys(TEXT_LOGS, open_text_log),
}
"""By file ending: the function that opens a recording from its path and the files of the map."""


def as_table(
    opened: ColumnSource | Recording, where: str, assigned: Mapping[int, Assigned] | None = None
) -> ColumnSource:
    """Return a table as it is, and a recording as a table with all channels on one clock.

    ``assigned`` columns, by index, get the names of their channels. Reading a column that cannot be
    decoded raises LogError.
    """
    if isinstance(opened, ColumnSource):
        return opened
    errors, traces = dict[int, LogError](), dict[int, ChannelTrace]()
    indices = range(1, len(opened.columns))  # column 0 is the clock
    for i, trace in zip(indices, read_each(opened.read, indices), strict=True):
        if isinstance(trace, LogError):
            errors[i] = trace
        elif assigned and i in assigned:
            traces[i] = assigned[i].named(trace)
        else:
            traces[i] = _unassigned(trace, opened.columns[i])
    resampled = on_one_clock([*traces.values()], where)
    arrays = dict(zip((0, *traces), (resampled.time, *resampled.values), strict=True))

    def read(indices: Sequence[int]) -> list[Array]:
        for index in indices:
            if index in errors:
                raise errors[index]
        return [arrays[index] for index in indices]

    all_rates = resampled.rates
    rates = {i: all_rates[trace.name] for i, trace in traces.items() if trace.name in all_rates}
    return ColumnSource(opened.columns, read, opened.notes + resampled.notes, rates)


def _unassigned(trace: ChannelTrace, column: Column) -> ChannelTrace:
    """Give a trace the name of its column; whole numbers without a unit, as gears, are a state."""
    values = trace.values[np.isfinite(trace.values)]
    is_counted = not column.unit and bool(np.all(values == np.round(values)))
    return replace(trace, name=column.full_name, is_state=trace.is_state or is_counted)
