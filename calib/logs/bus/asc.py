"""Vector ASC, read with python-can; an ASC file without the end of its last block is refused."""

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

FRAME = re.compile(
    r"\s*\d+\.\d+\s+(\d+\s+(\w+\s+(Tx|Rx)\b|ErrorFrame)|CANFD\s+\d+\s+(Tx|Rx)\b)", re.IGNORECASE
)
_LENGTH = re.compile(r"\s*\S+\s+\d+\s+\w+\s+(?:Tx|Rx)\s+d\s+(\w{2,})\s", re.IGNORECASE)
"""A frame of classic CAN whose code of length is no single digit."""
_HEADER = re.compile(r"\s*(date|base|//|(no\s+)?internal\s+events)", re.IGNORECASE)
_EVENTS = re.compile(r"\s*(no\s+)?internal\s+events", re.IGNORECASE)
_DELTA = re.compile(r"\s*base\s+\w+\s+timestamps\s+relative", re.IGNORECASE)
_BEGIN = re.compile(r"\s*begin\s+triggerblock", re.IGNORECASE)
_END = re.compile(r"\s*end\s+triggerblock", re.IGNORECASE)


class _AscLines(Counted):
    """Lines of an ASC file.

    python-can skips the line after the header if the header has no line on internal events. If the
    file lacks this line, it is inserted here, so that no frame is lost.
    """

    def __init__(self, file: TextIO, path: Path):
        super().__init__(file, FRAME, path)
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
            raise _relative(self.path)
        if _EVENTS.match(line):
            self._headed = True
            return line
        if not line.strip() or _HEADER.match(line):
            return line
        self._headed = True
        self._mark(line)
        self._kept = line
        return "no internal events logged\n"

    def _require_code(self, line: str) -> None:
        """Raise LogError for a classic frame of more than 8 bytes: python-can drops the others."""
        if found := _LENGTH.match(line):
            raise LogError(
                f"line {self.line} states a length of {found[1]!r} for a frame of classic CAN",
                where=self.path,
                expected="a digit from 0 to F, and 8 bytes at most",
                do="export the log again; CAN FD is written as CANFD",
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
    where = str(path)
    can = need("can", "can", where)
    known = require_dbc(dbc, "can", where)
    with path.open(encoding="utf-8", errors="replace") as file:
        lines = _AscLines(file, path)
        found = lines.gathered(whole_frames(can.ASCReader(lines), _stated, where), known)
    if lines.begun and not lines.ended:
        raise LogError(
            f"the end is missing: {len(found.times)} frames up to {found.times[-1]:.3f} s were "
            "read, but no 'End TriggerBlock'",
            where=path,
            expected="a block with its end",
            do="copy the log again; the file does not show how much is missing",
        )
    lines.require_all(found)
    return recording(found, known, () if lines.begun else (NO_FOOTER,), where)


def _stated(message: "Message") -> int:
    """Bytes of a frame by its line; in classic CAN the codes 9 to F stand for 8 (ISO 11898-1)."""
    return int(message.dlc if message.is_fd else min(message.dlc, 8))


NO_FOOTER = "no trigger block: a file cut at the end of a line looks like a complete one"


def _relative(path: Path) -> LogError:
    return LogError(
        "its timestamps are relative to the line before ('timestamps relative')",
        where=path,
        expected="timestamps absolute",
        do="export it again with absolute timestamps: a missing line would shift all later ones",
    )
