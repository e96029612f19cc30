"""PEAK TRC, read with python-can; its messages are numbered, so a lost line shows.

;$FILEVERSION=2.1                          none in version 1.0
;$COLUMNS=N,O,T,B,I,d,R,L,D                from version 2.0 on
      1    17535.400 DT 1      0100 Rx -  8    00 00 00 00 00 00 00 00
"""

import logging
import re
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from calib.errors import LogError
from calib.logs.bus.databases import Databases
from calib.logs.bus.recording import recording, require_dbc
from calib.logs.bus.text_log import Counted, whole_frames
from calib.logs.extra import need
from calib.logs.recording import Recording

if TYPE_CHECKING:
    from can import Message

VERSIONS = ("1.0", "1.1", "1.3", "2.0", "2.1")
FRAME = re.compile(
    r"\s*+(?!;|$|(\d+\)?\s+)?[\d.]+\s+(\d+\s+)?"
    r"(ST|EC|ER|EV|Warng|Error|ErrFr|Event|FFFFFFFF)\b)"
)
"""Lines that are neither empty nor a comment, a status, an event or an error."""

_LENGTHS = (12, 16, 20, 24, 32, 48, 64)
"""Bytes of a CAN FD frame for the codes 9 to 15 (ISO 11898-1)."""

_VERSION = re.compile(r";\$FILEVERSION=\s*(\S+)")
_COLUMNS = re.compile(r";\$COLUMNS=(\S+)")
_LAST = re.compile(r"[0-9A-F]{2}|RTR", re.IGNORECASE)
"""Last word of a line that is whole without an end of line, if it has all bytes: PEAK-Converter
writes none after the last line."""
_NUMBER = re.compile(r"\s*(\d+)\)?\s")

NO_FOOTER = "PEAK TRC has no footer: a log cut at the end of a line looks like a complete one"


class _TrcLines(Counted):
    """Lines of a TRC file. The number of each message must follow that of the one before."""

    def __init__(self, file: TextIO, path: Path):
        super().__init__(file, FRAME, path)
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
        if super().is_whole(line) or not FRAME.match(line):
            return True
        *words, last = line.split()
        remote = "RR" in words and len(last) == 1 and last.isdigit()
        return remote or bool(_LAST.fullmatch(last))

    def _follow(self, line: str) -> None:
        """Raise LogError if the number of a message is not the next one."""
        found = _NUMBER.match(line)
        number = int(found[1]) if found else 0
        if found is None or (self._number and number != self._number + 1):
            raise LogError(
                f"after message {self._number} comes {line.strip()[:60]!r}",
                where=self.path,
                expected=f"message {self._number + 1}",
                do="a line is missing or damaged: copy or export the log again",
            )
        self._number = number


def open_trc(path: Path, dbc: Databases) -> Recording:
    """Open a TRC file of version 1.0, 1.1, 1.3, 2.0 or 2.1.

    Raises LogError for another version, a message number that does not follow the one before, a
    last line or a frame that is cut off, a line that cannot be read, if python-can or a DBC is
    missing, and if no frame is described by the DBC.
    """
    where = str(path)
    can = need("can", "can", where)
    known = require_dbc(dbc, "can", where)
    logging.getLogger("can.io.trc").setLevel(logging.CRITICAL + 1)  # what it skips is refused here
    with path.open(encoding="utf-8", errors="replace") as file:
        _check_version(file, path)
        file.seek(0)
        lines = _TrcLines(file, path)
        found = lines.gathered(whole_frames(can.TRCReader(lines), _stated, where), known)
    lines.require_all(found)
    return recording(found, known, (NO_FOOTER,), where)


def _stated(message: "Message") -> int:
    """Bytes of a frame by the code in its line: up to 8 the code itself, in CAN FD up to 64."""
    if not message.is_fd:
        return int(min(message.dlc, 8))
    return int(message.dlc if message.dlc <= 8 else _LENGTHS[message.dlc - 9])


def _check_version(file: TextIO, path: Path) -> None:
    """Raise LogError for a version that is not known, or none."""
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
