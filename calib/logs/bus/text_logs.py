"""Text logs of a bus, read with python-can while their lines are counted: ASC, candump and TRC.

candump   (1436509052.249713) vcan0 044#2A366C2BBA
          (1436509052.449847) vcan0 0F6##1112233     two #: CAN FD, then one digit of flags
TRC       ;$FILEVERSION=2.1                          none in version 1.0
          ;$COLUMNS=N,O,T,B,I,d,R,L,D                from version 2.0 on
                1    17535.400 DT 1      0100 Rx -  8    00 00 00 00 00 00 00 00
"""

import logging
import re
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, TextIO, TypeVar

from calib.base.errors import LogError
from calib.logs.bus.dbc import Dbc
from calib.logs.bus.frames import Gathered
from calib.logs.bus.recording import gathered, recording, require_dbc
from calib.logs.channel_map import Databases
from calib.logs.source import Recording, need

if TYPE_CHECKING:
    import can


AnyLines = TypeVar("AnyLines", bound="Counted")


class Counted:
    """A text file that counts the lines that match ``frame`` as they are read.

    ``frames`` is their number so far; ``line`` the number of lines; ``last`` the last that was not
    empty; ``example`` a frame in words. If python-can skips a line without an error, it returns
    fewer frames than ``frames``.
    """

    frame: re.Pattern[str]
    example = "a frame"

    def __init__(self, file: TextIO, path: Path):
        self.file, self.path = file, path
        self.frames, self.line, self.last = 0, 0, ""

    def __iter__(self) -> Iterator[str]:
        return self

    def __next__(self) -> str:
        line = next(self.file)
        self.line += 1
        self.frames += bool(self.frame.match(line))
        self.last = line if line.strip() else self.last
        return line

    def close(self) -> None:
        """Close the file, as python-can asks for it."""
        self.file.close()

    def gathered(self, messages: "Iterable[can.Message]", dbc: Dbc) -> Gathered:
        """Frames that python-can reads from these lines.

        Raises LogError for a file that ends within a line, for a line that is not a frame or that
        was skipped, and as `calib.logs.bus.recording.gathered`.
        """
        try:
            found = gathered(self._whole(messages), dbc, str(self.path))
        except LogError as error:
            if self.frames:
                self._require_line_end()
            if error.__cause__ is None or isinstance(error.__cause__, LogError):
                raise
            raise self._no_frame() from error.__cause__
        self._require_line_end()
        self._require_end(found)
        read = len(found.times)
        if read != self.frames:
            raise self._error(
                f"{read} of {self.frames} lines that look like frames can be read: "
                f"{self.frames - read} are missing",
                "all of them",
                "a line is damaged: copy or export the log again",
            )
        return found

    def is_whole(self, line: str) -> bool:
        """Whether the last line is not cut off: here, whether it has an end of line."""
        return line.endswith("\n")

    def stated(self, message: "can.Message") -> int:
        """Bytes of data that the line of a frame states; 0 if it does not."""
        return 0

    def _require_end(self, found: Gathered) -> None:
        """Raise LogError for a file without the end that its format asks for."""

    def _whole(self, messages: "Iterable[can.Message]") -> "Iterator[can.Message]":
        """Yield the frames. Raises LogError for a frame with less data than its line states."""
        for message in messages:
            if not message.is_remote_frame and len(message.data) < self.stated(message):
                raise self._error(
                    f"a frame at {message.timestamp:.6f} s has {len(message.data)} of "
                    f"{self.stated(message)} bytes",
                    "all of them",
                    "the line is cut off: copy the log again",
                )
            yield message

    def _error(self, what: str, expected: str, do: str) -> LogError:
        return LogError(what, where=self.path, expected=expected, do=do)

    def _before(self) -> int:
        """Frames before the last line."""
        return self.frames - bool(self.frame.match(self.last))

    def _no_frame(self) -> LogError:
        """The error for the line at which python-can stopped; its own words help nobody."""
        whole = self._before()
        return self._error(
            f"not readable after frame {whole}: line {self.line} is {self.last.strip()[:60]!r}",
            self.example,
            "a line is damaged: copy the log again"
            if whole
            else "is it a log of this format? its ending says so",
        )

    def _require_line_end(self) -> None:
        if self.last and not self.is_whole(self.last):
            raise self._error(
                f"cut off within the last line, after {self._before()} whole frames: "
                f"{self.last.strip()[:60]!r}",
                "an end of line",
                "copy the log again; the file does not show how much is missing",
            )


def _read(
    path: Path, dbc: Databases, kind: Callable[[TextIO, Path], AnyLines], reader: str
) -> tuple[AnyLines, Callable[[str], Recording]]:
    """The lines of a log that a ``reader`` of python-can read, and what makes its recording."""
    can = need("can", "can", str(path))
    known = require_dbc(dbc, "can", str(path))
    with path.open(encoding="utf-8", errors="replace") as file:
        lines = kind(file, path)
        found = lines.gathered(getattr(can, reader)(lines), known)
    return lines, lambda note: recording(found, known, (note,) if note else (), str(path))


_CANDUMP_END = "candump writes no footer: a log cut at the end of a line looks like a complete one"


class _CandumpLines(Counted):
    frame = re.compile(r"\s*\(\d+\.\d+\)\s")
    example = "a frame of `candump -L`, such as '(1436509052.249713) can0 044#2A366C2BBA'"


def open_candump(path: Path, dbc: Databases) -> Recording:
    """Open a log of candump.

    The format has no count and no footer. Raises LogError for a last line that is cut off, for
    a line that is not a frame, if python-can or a DBC is missing, and if no frame is described by
    the DBC.
    """
    return _read(path, dbc, _CandumpLines, "CanutilsLogReader")[1](_CANDUMP_END)


_ASC = re.compile(
    r"\s*\d+\.\d+\s+(\d+\s+(\w+\s+(Tx|Rx)\b|ErrorFrame)|CANFD\s+\d+\s+(Tx|Rx)\b)", re.IGNORECASE
)
_ASC_LENGTH = re.compile(r"\s*\S+\s+\d+\s+\w+\s+(?:Tx|Rx)\s+d\s+(\w{2,})\s", re.IGNORECASE)
"""A frame of classic CAN whose code of length is no single digit."""
_HEADER = re.compile(r"\s*(date|base|//|(no\s+)?internal\s+events)", re.IGNORECASE)
_EVENTS = re.compile(r"\s*(no\s+)?internal\s+events", re.IGNORECASE)
_DELTA = re.compile(r"\s*base\s+\w+\s+timestamps\s+relative", re.IGNORECASE)
_BEGIN = re.compile(r"\s*begin\s+triggerblock", re.IGNORECASE)
_END = re.compile(r"\s*end\s+triggerblock", re.IGNORECASE)

_ASC_END = "no trigger block: a file cut at the end of a line looks like a complete one"


class _AscLines(Counted):
    """Lines of an ASC file.

    python-can skips the line after the header if the header has no line on internal events. If the
    file lacks this line, it is inserted here, so that no frame is lost.
    """

    frame = _ASC

    def __init__(self, file: TextIO, path: Path):
        super().__init__(file, path)
        self.begun = self.ended = self._headed = False
        self._kept: str | None = None

    def __next__(self) -> str:
        if self._kept is not None:
            line, self._kept = self._kept, None
            return line
        line = super().__next__()
        if self._headed:
            self._mark(line)
            self._require_code(line)
            return line
        if _DELTA.match(line):
            raise self._error(
                "its timestamps are relative to the line before ('timestamps relative')",
                "timestamps absolute",
                "export it again so: with relative ones a missing line would shift all later ones",
            )
        if _EVENTS.match(line):
            self._headed = True
            return line
        if not line.strip() or _HEADER.match(line):
            return line
        self._headed = True
        self._mark(line)
        self._kept = line
        return "no internal events logged\n"

    def stated(self, message: "can.Message") -> int:
        """In classic CAN the codes 9 to F stand for 8 bytes (ISO 11898-1)."""
        return int(message.dlc if message.is_fd else min(message.dlc, 8))

    def _require_code(self, line: str) -> None:
        """Raise LogError for a classic frame of more than 8 bytes: python-can drops the others."""
        if found := _ASC_LENGTH.match(line):
            raise self._error(
                f"line {self.line} states a length of {found[1]!r} for a frame of classic CAN",
                "a digit from 0 to F, and 8 bytes at most",
                "export the log again; CAN FD is written as CANFD",
            )

    def _require_end(self, found: Gathered) -> None:
        if self.begun and not self.ended:
            raise self._error(
                f"the end is missing: {len(found.times)} frames up to {found.times[-1]:.3f} s were "
                "read, but no 'End TriggerBlock'",
                "a block with its end",
                "copy the log again; the file does not show how much is missing",
            )

    def _mark(self, line: str) -> None:
        if not line[:1].isdigit() and not line[:1].isspace():
            self.begun |= bool(_BEGIN.match(line))
            self.ended = bool(_END.match(line)) or (self.ended and not _BEGIN.match(line))


def open_asc(path: Path, dbc: Databases) -> Recording:
    """Open an ASC file.

    Raises LogError for a block without its end, a last line or a frame that is cut off, a line that
    looks like a frame and cannot be read, timestamps relative to the line before, if python-can or
    a DBC is missing, and if no frame is described by the DBC.
    """
    lines, made = _read(path, dbc, _AscLines, "ASCReader")
    return made("" if lines.begun else _ASC_END)


VERSIONS = ("1.0", "1.1", "1.3", "2.0", "2.1")
_TRC = re.compile(
    r"\s*+(?!;|$|(\d+\)?\s+)?[\d.]+\s+(\d+\s+)?"
    r"(ST|EC|ER|EV|Warng|Error|ErrFr|Event|FFFFFFFF)\b)"
)
"""Lines that are neither empty nor a comment, a status, an event or an error."""

_FD_LENGTHS = (12, 16, 20, 24, 32, 48, 64)
"""Bytes of a CAN FD frame for the codes 9 to 15 (ISO 11898-1)."""

_VERSION = re.compile(r";\$FILEVERSION=\s*(\S+)")
_COLUMNS = re.compile(r";\$COLUMNS=(\S+)")
_LAST = re.compile(r"[0-9A-F]{2}|RTR", re.IGNORECASE)
"""Last word of a line that is whole without an end of line, if it has all bytes: PEAK-Converter
writes none after the last line."""
_NUMBER = re.compile(r"\s*(\d+)\)?\s")

_TRC_END = "PEAK TRC has no footer: a log cut at the end of a line looks like a complete one"


class _TrcLines(Counted):
    """Lines of a TRC file. The number of each message must follow that of the one before."""

    frame = _TRC

    def __init__(self, file: TextIO, path: Path):
        _check_version(file, path)
        file.seek(0)
        super().__init__(file, path)
        self._numbered, self._number = True, 0

    def __next__(self) -> str:
        line = super().__next__()
        if columns := _COLUMNS.match(line):
            self._numbered = columns[1].startswith("N,")
        if line.strip() and not line.lstrip().startswith(";") and self._numbered:
            self._follow(line)
        return line

    def is_whole(self, line: str) -> bool:
        """Whether the last line has an end of line, or cannot be a part of a longer one."""
        if super().is_whole(line) or not _TRC.match(line):
            return True
        *words, last = line.split()
        remote = "RR" in words and len(last) == 1 and last.isdigit()
        return remote or bool(_LAST.fullmatch(last))

    def stated(self, message: "can.Message") -> int:
        """Up to 8 bytes the code itself; in CAN FD up to 64."""
        if not message.is_fd:
            return int(min(message.dlc, 8))
        return int(message.dlc if message.dlc <= 8 else _FD_LENGTHS[message.dlc - 9])

    def _follow(self, line: str) -> None:
        found = _NUMBER.match(line)
        number = int(found[1]) if found else 0
        if found is None or (self._number and number != self._number + 1):
            raise self._error(
                f"after message {self._number} comes {line.strip()[:60]!r}",
                f"message {self._number + 1}",
                "a line is missing or damaged: copy or export the log again",
            )
        self._number = number


def open_trc(path: Path, dbc: Databases) -> Recording:
    """Open a TRC file of version 1.0, 1.1, 1.3, 2.0 or 2.1.

    Raises LogError for another version, a message number that does not follow the one before, a
    last line or a frame that is cut off, a line that cannot be read, if python-can or a DBC is
    missing, and if no frame is described by the DBC.
    """
    logging.getLogger("can.io.trc").setLevel(logging.CRITICAL + 1)  # what it skips is refused here
    return _read(path, dbc, _TrcLines, "TRCReader")[1](_TRC_END)


def _check_version(file: TextIO, path: Path) -> None:
    first = file.readline()
    while first and not first.strip():
        first = file.readline()
    if not first.lstrip().startswith(";"):
        raise LogError("not a TRC file", where=path, expected="a header of lines that begin with ;")
    found = _VERSION.match(first.lstrip())
    version = found[1] if found else "1.0"
    if version not in VERSIONS:
        raise LogError(
            f"version {version} of TRC",
            where=path,
            expected=f"one of {', '.join(VERSIONS)}",
            do="convert it with PEAK-Converter",
        )
