"""Name a file that is of another kind than its ending says."""

import re

from calib.errors import LogError
from calib.files.bounded import POINTER

MDF = (".mf4", ".mdf", ".dat")

_ROWS: tuple[tuple[bytes, str, tuple[str, ...]], ...] = (
    (rb"PAR1", "a Parquet file", (".parquet",)),
    (rb"MDF  |UnFin", "an MDF file", MDF),
    (rb"LOGG", "a BLF file", (".blf",)),
    (rb"\(\d+\.\d+\) +\S+ +[0-9a-f]+#", "a candump log", (".log",)),
    (rb"date [^,;\t\n]+\r?\nbase +(hex|dec)", "a Vector ASC log", (".asc",)),
    (rb";\$fileversion=", "a PEAK TRC log", (".trc",)),
    (rb"file created on ", "a VBO log", (".vbo",)),
    (rb"PK\x03\x04", "a zip archive or a workbook", ()),
    (rb"%PDF", "a PDF file", ()),
    (rb"\x89PNG", "a picture", ()),
    (rb"\x89HDF", "an HDF5 file", ()),
    (rb"MATLAB ", "a MATLAB file", ()),
    (rb"SQLite", "a database", ()),
    (rb"<!doctype html|<html", "a web page", ()),
    (rb"<\?xml", "an XML file", ()),
    (rb"\{", "a JSON file", ()),
)
"""Beginning in any case, what it is, and the endings under which it is right."""

KINDS = tuple((re.compile(begin, re.IGNORECASE), name, ends) for begin, name, ends in _ROWS)

Kind = tuple[str, tuple[str, ...]]
"""What a file is, and the endings under which it is right; none for what is no log."""


def kind_of(head: bytes) -> Kind | None:
    """What a file is that begins with ``head``, 64 bytes or more if it has them; None: unknown.

    >>> kind_of(b"(1700000000.000400) can0 101#0000D4FF")
    ('a candump log', ('.log',))
    """
    text = head.lstrip(b"\xef\xbb\xbf \t\r\n")
    for begin, name, endings in KINDS:
        if begin.match(text):
            return name, endings
    return None


def refuse_other_kind(head: bytes, ending: str, where: object) -> None:
    """Raise LogError if a file begins as one of another kind than its ``ending``.

    ``head`` as for `kind_of`. A file of an unknown kind passes.
    """
    if head.startswith(POINTER):
        raise LogError(
            "a pointer of git LFS, not the log itself",
            where=where,
            expected=f"the bytes of a {ending} file",
            do="get the file: git lfs pull",
        )
    name, endings = kind_of(head) or ("", (ending,))
    if ending not in endings:
        raise LogError(
            f"{name}, not a {ending} file",
            where=where,
            expected=f"a log that is what its ending {ending} says",
            do=f"rename it to {endings[0]}" if endings else "export or copy the log again",
        )
