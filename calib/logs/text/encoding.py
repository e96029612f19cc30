"""Unpack a text log, and convert its text to UTF-8."""

import codecs
import gzip
import io
import zlib

from calib.base.bounded import LOG
from calib.base.errors import LogError
from calib.logs.source import damaged

GZIP = b"\x1f\x8b"  # first bytes of a gzip file


def gunzip(data: bytes, where: str) -> bytes:
    """Unpack a gzip file. Raises LogError for a file that is damaged or too large."""
    try:
        with gzip.GzipFile(fileobj=io.BytesIO(data)) as file:
            content = file.read(LOG.max_bytes + 1)
    except EOFError as cause:
        flaw = "the gzip file is cut off: it ends within the data"
        raise damaged(where, flaw, "length and check sum at the end") from cause
    except (OSError, zlib.error) as cause:
        raise damaged(where, f"the gzip file is damaged: {cause}") from cause
    if len(content) > LOG.max_bytes:
        raise LogError(LOG.size_message("it unpacks to"), where=where)
    return content


_MARKS = {
    codecs.BOM_UTF8: "utf-8",
    codecs.BOM_UTF16_LE: "utf-16-le",
    codecs.BOM_UTF16_BE: "utf-16-be",
}
_HEAD = 4096  # number of first bytes that must be text; a header is shorter


def to_utf8(data: bytes, where: str, encoding: str | None = None) -> bytes:
    """Convert text to UTF-8 without a byte order mark. Raises LogError for bytes that are no text.

    Text with neither mark nor ``encoding`` is not converted: it is UTF-8, or has an encoding of 8
    bits, in which numbers are the same. `text_of` decodes its header.
    """
    for mark, name in _MARKS.items():
        if data.startswith(mark):
            data, encoding = data[len(mark) :], name
            break
    if encoding is None or codecs.lookup(encoding).name == "utf-8":
        head = data[:_HEAD]
        # zeros after a loss of power may begin within the head; a binary file has no lines
        text = head.rstrip(b"\0") if b"\n" in head else head
        if b"\0" in text:
            raise LogError("not text", where=where, expected="text with separated columns")
        return data
    try:
        return data.decode(encoding).encode()
    except UnicodeDecodeError as cause:
        flaw = "the last character is cut off" if "truncated" in cause.reason else str(cause)
        raise damaged(where, f"not {encoding}: {flaw}", "complete text") from cause


def text_of(data: bytes) -> tuple[str, str | None]:
    """Decode UTF-8, or else Windows-1252, which has all letters of ISO 8859-1, with a note."""
    try:
        return data.decode("utf-8"), None
    except UnicodeDecodeError:
        note = "the header is not UTF-8; read as Latin-1 (Windows-1252)"
        return data.decode("cp1252", errors="replace"), note
