"""Formats whose channels share one clock: which ending is which, and how the file is opened."""

from collections.abc import Callable
from pathlib import Path

from calib.files import printable
from calib.logs.parquet import open_parquet
from calib.logs.source import ColumnSource
from calib.logs.text.csv import open_csv
from calib.logs.text.dialect import TextFormat
from calib.logs.text.vbo import open_vbo

TABLES: dict[str, Callable[[bytes, str, TextFormat], ColumnSource]] = {
    ".csv": open_csv,
    ".csv.gz": open_csv,
    ".tsv": open_csv,
    ".txt": open_csv,
    ".parquet": open_parquet,
    ".vbo": open_vbo,
}
"""One opener per file ending. A new format is one file and one line here."""


def ending_of(path: Path) -> str:
    """The ending that names the format, in small letters: of ``run.csv.gz`` it is ``.csv.gz``."""
    both = "".join(path.suffixes[-2:]).lower()
    return both if path.suffix.lower() == ".gz" else path.suffix.lower()


def stem_of(path: Path) -> str:
    """The name of a log: its file's without the ending, fit to be written and printed.

    >>> stem_of(Path("runs/ramp.2.csv.gz")), stem_of(Path("ramp.2.csv"))
    ('ramp.2', 'ramp.2')
    """
    path = Path(path)
    ending = ending_of(path)
    return printable(path.name[: -len(ending)] if ending else path.name)
