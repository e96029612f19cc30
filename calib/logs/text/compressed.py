"""Unpack compressed logs."""

import zlib

from calib.errors import LogError
from calib.files.bounded import LOG

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
            raise LogError(
                f"the gzip file is cut off: it ends within the data, {got} bytes of text unpacked",
                where=where,
                expected="length and check sum at the end",
                do="copy the log again",
            )
        data = stream.unused_data.lstrip(b"\0")
    return b"".join(parts)


def too_large(where: str) -> LogError:
    """The error for a log that unpacks to more than a log may have."""
    return LogError(LOG.excess(what="it unpacks to"), where=where, do=LOG.advice)


def _damaged(data: bytes, later: bool, cause: Exception, where: str) -> LogError:
    if not later and not data.startswith(b"\x1f\x8b"):
        return LogError("not gzip", where=where, expected="a gzip file, as its ending says")
    return LogError(f"the gzip file is damaged: {cause}", where=where, do="copy the log again")
