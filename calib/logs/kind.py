"""Name a file that is of another kind than its ending says."""

from calib.bounded import POINTER
from calib.errors import LogError

MDF = (".mf4", ".mdf", ".dat")

KINDS: tuple[tuple[bytes, str, tuple[str, ...]], ...] = (
    (b"PAR1", "a Parquet file", (".parquet",)),
    (b"MDF  ", "an MDF file", MDF),
    (b"UnFin", "an MDF file", MDF),
    (b"LOGG", "a BLF file", (".blf",)),
    (b"PK\x03\x04", "a zip archive or a workbook", ()),
    (b"%PDF", "a PDF file", ()),
    (b"\x89PNG", "a picture", ()),
    (b"\x89HDF", "an HDF5 file", ()),
    (b"MATLAB ", "a MATLAB file", ()),
    (b"SQLite", "a database", ()),
    (b"<!doctype html", "a web page", ()),
    (b"<html", "a web page", ()),
    (b"<?xml", "an XML file", ()),
    (b"{", "a JSON file", ()),
)
"""Beginning in lower case or as it is, what it is, and the endings under which it is right."""


def refuse_other_kind(head: bytes, ending: str, where: object) -> None:
    """Raise LogError if a file begins as one of another kind than its ``ending``.

    ``head`` are its first bytes, 64 or more if it has them. A file of an unknown kind passes.
    """
    if head.startswith(POINTER):
        raise LogError(
            "a pointer of git LFS, not the log itself",
            where=where,
            expected=f"the bytes of a {ending} file",
            do="get the file: git lfs pull",
        )
    text = head.lstrip(b"\xef\xbb\xbf \t\r\n")
    for begin, name, endings in KINDS:
        if not (head.startswith(begin) or text.lower().startswith(begin)) or ending in endings:
            continue
        raise LogError(
            f"{name}, not a {ending} file",
            where=where,
            expected=f"a log that is what its ending {ending} says",
            do=f"rename it to {endings[0]}" if endings else "export or copy the log again",
        )
