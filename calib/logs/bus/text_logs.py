"""Text logs of a bus, read with python-can while their lines are counted: ASC, candump and TRC.

candump   (1436509052.249713) vcan0 044#2A366C2BBA
          (1436509052.449847) vcan0 0F6##1112233     two #: CAN FD, then one digit of flags
TRC       ;$FILEVERSION=2.1                          none in version 1.0
          ;$COLUMNS=N,O,T,B,I,d,R,L,D                from version 2.0 on
                1    17535.400 DT 1      0100 Rx -  8    00 00 00 00 00 00 00 00

python-can (4.6) leaves out a line that it cannot read, and pads a frame that is cut off.
"""

import logging
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, TextIO

from calib.base.errors import LogError
from calib.base.extras import need
from calib.logs.bus.dbc import Dbc
from calib.logs.bus.recording import Capture, captured, recording, require_dbc
from calib.logs.channel_map import Databases
from calib.logs.source import Recording, damaged

if TYPE_CHECKING:
    import can


class _Lines:
    """The lines of a text log; those that match ``frame`` are counted as they are read."""

    reader: ClassVar[str]
    frame: ClassVar[re.Pattern[str]]

    def __init__(self, file: TextIO, path: Path):
        self.file, self.path = file, path
        self.frames, self.last = 0, ""

    def __iter__(self) -> Iterator[str]:
        return self

    def __next__(self) -> str:
        line = next(self.file)
        self.frames += bool(self.frame.match(line))
        self.last = line if line.strip() else self.last
        return line

    def close(self) -> None:
        """Close the file, as python-can asks for it."""
        self.file.close()

    def is_whole(self, line: str) -> bool:
        """Whether the last line is not cut off."""
        return line.endswith("\n")

    def data_length(self, message: "can.Message") -> int:
        """Bytes of data that a frame has by its length code; 0 where it is not written."""
        return 0

    def captured(self, messages: "Iterable[can.Message]", dbc: Dbc) -> Capture:
        """The frames that python-can reads. Raises LogError if it does not read all."""
        try:
            capture = captured(self._whole(messages), dbc, str(self.path))
        except LogError:
            if self.frames:
                self._require_line_end()
            raise
        self._require_line_end()
        self.require_end(capture)
        if len(capture.times) != self.frames:
            read = f"{len(capture.times)} of {self.frames} lines that look like frames can be read"
            raise damaged(self.path, f"{read}: others are missing or damaged", "all of them")
        return capture

    def require_end(self, capture: Capture) -> None:
        """Raise LogError if the format has an end and the file has none."""

    def _whole(self, messages: "Iterable[can.Message]") -> "Iterator[can.Message]":
        for message in messages:
            if not message.is_remote_frame and len(message.data) < self.data_length(message):
                length = f"{len(message.data)} of {self.data_length(message)} bytes"
                raise damaged(self.path, f"a frame at {message.timestamp:.6f} s has {length}")
            yield message

    def _require_line_end(self) -> None:
        if self.last and not self.is_whole(self.last):
            whole = self.frames - bool(self.frame.match(self.last))
            cut = f"cut off within the last line, {self.last.strip()[:60]!r}, after {whole} whole"
            raise damaged(self.path, f"{cut} frames", "an end of line")


class _CandumpLines(_Lines):
    """Lines without a count and without an end."""

    reader = "CanutilsLogReader"
    frame = re.compile(r"\s*\(\d+\.\d+\)\s")


_HEADER = re.compile(r"\s*(date|base|//)", re.IGNORECASE)
_EVENTS = re.compile(r"\s*(no\s+)?internal\s+events", re.IGNORECASE)
_DELTA = re.compile(r"\s*base\s+\w+\s+timestamps\s+relative", re.IGNORECASE)
_BEGIN = re.compile(r"begin\s+triggerblock", re.IGNORECASE)
_END = re.compile(r"end\s+triggerblock", re.IGNORECASE)


class _AscLines(_Lines):
    """Lines with one inserted after a header where python-can would skip a frame."""

    reader = "ASCReader"
    frame = re.compile(
        r"\s*\d+\.\d+\s+(\d+\s+(\w+\s+(Tx|Rx)\b(?!\s+d\s+\w{2,}\s)|ErrorFrame)"
        r"|CANFD\s+\d+\s+(Tx|Rx)\b)",
        re.IGNORECASE,
    )

    def __init__(self, file: TextIO, path: Path):
        super().__init__(file, path)
        self.begun = self.ended = self._headed = False
        self._delayed: str | None = None

    def __next__(self) -> str:
        if self._delayed is not None:
            line, self._delayed = self._delayed, None
            return line
        line = super().__next__()
        if not self._headed:
            if _DELTA.match(line):
                raise LogError(
                    "its timestamps are relative to the line before ('timestamps relative')",
                    where=self.path,
                    expected="timestamps absolute: a missing line would shift all later ones",
                    do="export it again with absolute timestamps",
                )
            if not line.strip() or _HEADER.match(line):
                return line
            self._headed = True
            if not _EVENTS.match(line):
                self._delayed = line
        if line[:1].isalpha():
            self.begun |= bool(_BEGIN.match(line))
            self.ended = bool(_END.match(line)) or (self.ended and not _BEGIN.match(line))
        return line if self._delayed is None else "no internal events logged\n"

    def data_length(self, message: "can.Message") -> int:
        # In classic CAN the codes 9 to F stand for 8 bytes (ISO 11898-1).
        return int(message.dlc if message.is_fd else min(message.dlc, 8))

    def require_end(self, capture: Capture) -> None:
        if self.begun and not self.ended:
            frames = f"{len(capture.times)} frames up to {capture.times[-1]:.3f} s"
            flaw = f"the end is missing: {frames}, but no 'End TriggerBlock'"
            raise damaged(self.path, flaw, "a block with its end")


_VERSIONS = ("1.0", "1.1", "1.3", "2.0", "2.1")
"""Those that python-can reads; it takes any other for 1.0."""
_VERSION = re.compile(r"\s*;\$FILEVERSION=\s*(\S+)")
_COLUMNS = re.compile(r";\$COLUMNS=(\S+)")
_LAST = re.compile(r"[0-9A-F]{2}|RTR", re.IGNORECASE)
"""Last word of a line that is whole without an end of line, if it has all bytes: PEAK-Converter
writes none after the last line."""
_NUMBER = re.compile(r"\s*(\d+)\)?\s")


class _TrcLines(_Lines):
    """Lines of one of `_VERSIONS`; the number of each message must follow the one before."""

    reader = "TRCReader"
    frame = re.compile(
        r"\s*+(?!;|$|(\d+\)?\s+)?[\d.]+\s+(\d+\s+)?"
        r"(ST|EC|ER|EV|Warng|Error|ErrFr|Event|FFFFFFFF)\b)"
    )

    def __init__(self, file: TextIO, path: Path):
        super().__init__(file, path)
        self._numbered, self._number = True, 0

    def __next__(self) -> str:
        first = not self.last
        line = super().__next__()
        comment = not line.strip() or line.lstrip().startswith(";")
        if first and not comment:
            expected = "a header of lines that begin with ;"
            raise LogError("not a TRC file", where=self.path, expected=expected)
        if (version := _VERSION.match(line)) and version[1] not in _VERSIONS:
            raise LogError(
                f"version {version[1]} of TRC",
                where=self.path,
                expected=f"one of {', '.join(_VERSIONS)}",
                do="convert it with PEAK-Converter",
            )
        if columns := _COLUMNS.match(line):
            self._numbered = columns[1].startswith("N,")
        if not comment and self._numbered:
            match = _NUMBER.match(line)
            number = int(match[1]) if match else 0
            if match is None or (self._number and number != self._number + 1):
                jump = f"after message {self._number} comes {line.strip()[:60]!r}"
                raise damaged(self.path, jump, f"message {self._number + 1}")
            self._number = number
        return line

    def is_whole(self, line: str) -> bool:
        if super().is_whole(line) or not self.frame.match(line):
            return True
        *words, last = line.split()
        remote = "RR" in words and len(last) == 1 and last.isdigit()
        return remote or bool(_LAST.fullmatch(last))

    def data_length(self, message: "can.Message") -> int:
        if not message.is_fd:
            return int(min(message.dlc, 8))
        return int(need("can", "can", str(self.path), LogError).util.dlc2len(message.dlc))


_READERS = {".asc": _AscLines, ".log": _CandumpLines, ".trc": _TrcLines}

TEXT_LOGS = tuple(_READERS)
"""File name endings of the text logs of a bus."""


def open_text_log(path: Path, dbc: Databases) -> Recording:
    """Open a log whose ending is one of `TEXT_LOGS`.

    Raises LogError for a line or frame that is cut off or cannot be read, an ASC block without its
    end, relative timestamps, a lost message of TRC; without a DBC, and if it describes no frame.
    """
    can = need("can", "can", str(path), LogError)
    logging.getLogger("can.io.trc").setLevel(logging.CRITICAL + 1)  # what it skips is refused here
    database = require_dbc(dbc, "can", str(path))
    kind = _READERS[path.suffix.lower()]
    with path.open(encoding="utf-8", errors="replace") as file:
        lines = kind(file, path)
        capture = lines.captured(getattr(can, kind.reader)(lines), database)
    has_end = isinstance(lines, _AscLines) and lines.begun
    note = "the log has no footer: one that was cut at the end of a line looks like a complete one"
    return recording(capture, database, () if has_end else (note,), str(path))
