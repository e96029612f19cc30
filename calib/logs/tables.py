"""Formats whose channels share one clock: how each file ending is opened."""

from collections.abc import Callable
from pathlib import Path

from calib.logs.parquet import open_parquet
from calib.logs.source import ColumnSource
from calib.logs.text.csv import open_csv
from calib.logs.text.dialect import TextFormat
from calib.logs.text.vbo import open_vbo
from calib.printable import printable

TABLES: dict[str, Callable[[bytes, str, TextFormat], ColumnSource]] = {
    ".csv": open_csv,
    ".csv.gz": open_csv,
    ".tsv": open_csv,
    ".txt": open_csv,
    ".parquet": open_parquet,
    ".vbo": open_vbo,
}
"""Opening function by file ending."""


def ending_of(path: Path) -> str:
    """The ending that gives the format, in lower case: ``.csv.gz`` for ``run.csv.gz``."""
    both = "".join(path.suffixes[-2:]).lower()
    return both if path.suffix.lower() == ".gz" else path.suffix.lower()


def stem_of(path: Path) -> str:
    """The name of a log: the file name without the ending, safe to print.

    >>> stem_of(Path("runs/ramp.2.csv.gz")), stem_of(Path("ramp.2.csv"))
    ('ramp.2', 'ramp.2')
    """
    path = Path(path)
    ending = ending_of(path)
    return printable(path.name[: -len(ending)] if ending else path.name)
