"""Write files completely or not at all; print their names safely."""

import os
import re
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path


def write_whole(path: Path, content: bytes) -> None:
    """Write ``content`` to ``path`` in one step.

    A reader gets the old file or the new one, never a part. Raises OSError if the directory cannot
    be written.
    """
    handle, name = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        os.chmod(name, 0o666 & ~_umask())
        os.replace(name, path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


@contextmanager
def workshop(out: Path) -> Iterator[Path]:
    """Make a hidden temporary folder in ``out``; it is always deleted afterwards.

    It is inside ``out``, because the parent folder may be on another file system. If ``out`` did
    not exist before and stays empty, it is deleted too. Raises OSError at once if ``out`` cannot be
    written.
    """
    made = not out.exists()
    out.mkdir(parents=True, exist_ok=True)
    try:
        with tempfile.TemporaryDirectory(prefix=".making-", dir=out) as work:
            yield Path(work)
    finally:
        if made:
            with suppress(OSError):
                out.rmdir()


def printable(text: str) -> str:
    r"""Text in one line; control characters and bytes that are not UTF-8 are escaped.

    >>> print(printable(os.fsdecode(b"r\xfcck.csv")))
    r\udcfcck.csv
    >>> print(printable("two\nlines.csv"))
    two\x0alines.csv
    """
    whole = text.encode("utf-8", "backslashreplace").decode()
    return re.sub(r"[\x00-\x1f\x7f-\x9f]", lambda sign: f"\\x{ord(sign[0]):02x}", whole)


def _umask() -> int:
    """The permission mask that ``open`` applies; mkstemp makes files private instead."""
    mask = os.umask(0)
    os.umask(mask)
    return mask
