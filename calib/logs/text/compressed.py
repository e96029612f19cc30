"""Unpack compressed logs."""

import gzip
import zlib

from calib.errors import LogError


def gunzip(data: bytes, where: str) -> bytes:
    """The content of all members of a gzip file.

    Raises LogError for a file that is cut off (with the size of the unpacked part), damaged (wrong
    length or check sum) or not gzip.
    """
    try:
        return gzip.decompress(data)
    except (EOFError, zlib.error, gzip.BadGzipFile) as cause:
        raise _refusal(data, where, cause) from cause


def _refusal(data: bytes, where: str, cause: Exception) -> LogError:
    if not data.startswith(b"\x1f\x8b"):
        return LogError("not gzip", where=where, expected="a gzip file, as its ending says")
    stream = zlib.decompressobj(wbits=31)
    try:
        got, cut = len(stream.decompress(data)), not stream.eof
    except zlib.error:
        got, cut = 0, False
    if cut or isinstance(cause, EOFError):
        return LogError(
            f"the gzip file is cut off: it ends within the data, {got} bytes of text unpacked",
            where=where,
            expected="length and check sum at the end",
            do="copy the log again",
        )
    return LogError(f"the gzip file is damaged: {cause}", where=where, do="copy the log again")
