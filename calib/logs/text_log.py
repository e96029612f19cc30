"""Lines of a text log, counted while a library reads them."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import TextIO

from calib.errors import LogError


class Counted:
    """A text file that counts the lines like ``frame`` as they are read.

    ``frames`` of them so far; ``last`` line read. Anything that python-can passes over in silence
    shows as a difference between ``frames`` and what it gave.
    """

    def __init__(self, file: TextIO, frame: re.Pattern[str]):
        self.file, self.frame = file, frame
        self.frames, self.last = 0, ""

    def __iter__(self) -> Iterator[str]:
        return self

    def __next__(self) -> str:
        line = next(self.file)
        if self.frame.match(line):
            self.frames += 1
        self.last = line if line.strip() else self.last
        return line

    def close(self) -> None:
        """Close the file."""
        self.file.close()


def require_all(read: int, there: int, path: Path) -> None:
    """Raise LogError if fewer or more frames were read than lines look like frames."""
    if read != there:
        raise LogError(
            f"{read} of {there} lines that look like frames can be read",
            where=path,
            expected="all of them",
            do="a line is damaged: copy or export the log again",
        )


def require_line_end(last: str, frames: int, path: Path) -> None:
    """Raise LogError for a file whose last line has no end."""
    if not last.endswith("\n"):
        raise LogError(
            f"cut off within the last line, after {frames - 1} whole frames: {last.strip()[:60]!r}",
            where=path,
            expected="a line that ends",
            do="copy the log again; how much is missing the file does not say",
        )
