"""Files that are either whole or not there, and their names in print."""

import os
import re
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path


def write_whole(path: Path, content: bytes) -> None:
    """Write ``content`` to ``path`` in one step: a reader sees the old file or the new one.

    Raises OSError if the directory cannot be written.
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
    """A hidden folder in ``out`` to make its files in; gone afterwards, whatever happens.

    It lies inside, since ``out`` may be another file system than the folder that it is in. ``out``
    goes too if it was made for this and nothing was put there. Raises OSError at once if nothing
    can be written there.
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
    r"""Text in one line, without the half characters of a file name that is not UTF-8.

    >>> print(printable(os.fsdecode(b"r\xfcck.csv")))
    r\udcfcck.csv
    >>> print(printable("two\nlines.csv"))
    two\x0alines.csv
    """
    whole = text.encode("utf-8", "backslashreplace").decode()
    return re.sub(r"[\x00-\x1f\x7f-\x9f]", lambda sign: f"\\x{ord(sign[0]):02x}", whole)


def _umask() -> int:
    """The mask that a plain ``open`` would apply; mkstemp makes files private instead."""
    mask = os.umask(0)
    os.umask(mask)
    return mask
