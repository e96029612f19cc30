"""Count the lines of a text log while python-can reads them."""

import re
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from calib.errors import LogError
from calib.logs.bus.dbc import Dbc
from calib.logs.bus.frames import Gathered
from calib.logs.bus.recording import gathered

if TYPE_CHECKING:
    import can


class Counted:
    """A text file that counts the lines that match ``frame`` as they are read.

    ``frames`` is their number so far; ``line`` the number of lines; ``last`` the last that was not
    empty; ``example`` a frame in words. If python-can skips a line without an error, it returns
    fewer frames than ``frames``.
    """

    def __init__(self, file: TextIO, frame: re.Pattern[str], path: Path, example: str = "a frame"):
        self.file, self.frame, self.path, self.example = file, frame, path, example
        self.frames, self.line, self.last = 0, 0, ""

    def __iter__(self) -> Iterator[str]:
        return self

    def __next__(self) -> str:
        line = next(self.file)
        self.line += 1
        if self.frame.match(line):
            self.frames += 1
        self.last = line if line.strip() else self.last
        return line

    def close(self) -> None:
        """Close the file."""
        self.file.close()

    def gathered(self, messages: "Iterable[can.Message]", dbc: Dbc) -> Gathered:
        """Frames that python-can reads from these lines.

        Raises LogError for a file that ends within a line, for a line that is not a frame, and as
        `calib.logs.bus.recording.gathered`.
        """
        try:
            found = gathered(messages, dbc, str(self.path))
        except LogError as error:
            if self.frames:
                self._require_line_end()
            if error.__cause__ is None or isinstance(error.__cause__, LogError):
                raise
            raise self._no_frame() from error.__cause__
        self._require_line_end()
        return found

    def require_all(self, found: Gathered) -> None:
        """Raise LogError if some lines that look like frames were not read."""
        read = len(found.times)
        if read != self.frames:
            raise LogError(
                f"{read} of {self.frames} lines that look like frames can be read: "
                f"{self.frames - read} are missing",
                where=self.path,
                expected="all of them",
                do="a line is damaged: copy or export the log again",
            )

    def is_whole(self, line: str) -> bool:
        """Whether the last line is not cut off: here, whether it has an end of line."""
        return line.endswith("\n")

    def _no_frame(self) -> LogError:
        """The error for the line at which python-can stopped; its own words help nobody."""
        whole = self.frames - bool(self.frame.match(self.last))
        return LogError(
            f"not readable after frame {whole}: line {self.line} is {self.last.strip()[:60]!r}",
            where=self.path,
            expected=self.example,
            do="a line is damaged: copy the log again"
            if whole
            else "is it a log of this format? its ending says so",
        )

    def _require_line_end(self) -> None:
        if self.last and not self.is_whole(self.last):
            whole = self.frames - bool(self.frame.match(self.last))
            raise LogError(
                f"cut off within the last line, after {whole} whole frames: "
                f"{self.last.strip()[:60]!r}",
                where=self.path,
                expected="an end of line",
                do="copy the log again; the file does not show how much is missing",
            )


def whole_frames(
    messages: "Iterable[can.Message]", stated: "Callable[[can.Message], int]", where: str
) -> "Iterator[can.Message]":
    """Yield the frames. Raises LogError for a frame with less data than its line states.

    ``stated`` returns the number of bytes that the line of a frame states.
    """
    for message in messages:
        if not message.is_remote_frame and len(message.data) < stated(message):
            raise LogError(
                f"a frame at {message.timestamp:.6f} s has {len(message.data)} of "
                f"{stated(message)} bytes",
                where=where,
                expected="all of them",
                do="the line is cut off: copy the log again",
            )
        yield message
