"""Unpack a log, and convert text to UTF-8: byte order marks, UTF-16, Western encodings."""

import codecs
import zlib

from calib.base.bounded import LOG
from calib.base.errors import LogError
from calib.logs.source import damaged

_GZIP = 31
"""Window bits of zlib for a gzip file."""


def gunzip(data: bytes, where: str) -> bytes:
    """The content of all members of a gzip file.

    Raises LogError for a file that is cut off (with the size of the unpacked part), damaged (wrong
    length or check sum), not gzip, or larger than a log may be; no more than that is unpacked.
    """
    parts: list[bytes] = []
    got = 0
    while data or not parts:
        stream = zlib.decompressobj(wbits=_GZIP)
        try:
            parts.append(stream.decompress(data, LOG.most + 1 - got))
        except zlib.error as cause:
            raise _damaged(data, bool(parts), cause, where) from cause
        got += len(parts[-1])
        if got > LOG.most:
            raise too_large(where)
        if not stream.eof:
            raise damaged(
                where,
                f"the gzip file is cut off: it ends within the data, {got} bytes of text unpacked",
                "length and check sum at the end",
            )
        data = stream.unused_data.lstrip(b"\0")
    return b"".join(parts)


def too_large(where: str) -> LogError:
    """The error for a log that unpacks to more than a log may have."""
    return LogError(LOG.excess(what="it unpacks to"), where=where, do=LOG.advice)


def _damaged(data: bytes, later: bool, cause: Exception, where: str) -> LogError:
    if not later and not data.startswith(b"\x1f\x8b"):
        return LogError("not gzip", where=where, expected="a gzip file, as its ending says")
    return damaged(where, f"the gzip file is damaged: {cause}")


MARKS = (
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)
HEAD = 4096
"""Number of bytes used to detect the encoding; a header is shorter."""


def to_utf8(data: bytes, where: str, encoding: str | None = None) -> bytes:
    """Convert the text of a file to UTF-8 without a byte order mark.

    Parameters
    ----------
    data : the whole file.
    where : its path, for messages.
    encoding : name of the encoding, or None to detect it.

    If ``encoding`` is None, UTF-16 is detected by its byte order mark, or if every other byte at
    the beginning is zero. Other bytes are not changed: `head_text` decodes the header, and numbers
    are the same in all 8-bit encodings. Raises LogError for bytes that are not text.
    """
    for mark, name in MARKS:
        if data.startswith(mark):
            data, encoding = data[len(mark) :], name
            break
    encoding = encoding or _unmarked_utf16(data[:HEAD])
    if encoding is None or codecs.lookup(encoding).name == "utf-8":
        _refuse_binary(data[:HEAD], where)
        return data
    try:
        return data.decode(encoding).encode()
    except UnicodeDecodeError as cause:
        cut = "the last character is cut off" if "truncated" in cause.reason else str(cause)
        raise damaged(where, f"not {encoding}: {cut}", "complete text") from cause


def _unmarked_utf16(head: bytes) -> str | None:
    head = head[: len(head) // 2 * 2]
    if len(head) >= 16 and b"\0" in head:
        if not any(head[1::2]) and all(head[0::2]):
            return "utf-16-le"
        if not any(head[0::2]) and all(head[1::2]):
            return "utf-16-be"
    return None


def _refuse_binary(head: bytes, where: str) -> None:
    lines = head.rstrip(b"\0") if b"\n" in head else head  # a short log may end with zero bytes
    if b"\0" in lines:
        raise LogError("not text", where=where, expected="text with separated columns")


def head_text(head: bytes, where: str) -> tuple[str, str | None]:
    """A header as text, with a note if it is in Windows-1252 and not in UTF-8.

    Windows-1252 includes all printable signs of ISO 8859-1, so ``°`` and ``²`` are correct in both.
    Raises LogError if neither encoding fits.
    """
    try:
        return head.decode("utf-8"), None
    except UnicodeDecodeError:
        pass
    try:
        return head.decode("cp1252"), "the header is not UTF-8; read as Latin-1 (Windows-1252)"
    except UnicodeDecodeError as cause:
        raise LogError(
            f"the header is neither UTF-8 nor Latin-1: {cause}",
            where=where,
            expected="text",
            do='name its encoding in a channel map: [text] encoding = "..."',
        ) from cause
