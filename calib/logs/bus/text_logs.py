"""Read text logs of a bus with python-can: ASC, candump and TRC.

candump   (1436509052.249713) vcan0 044#2A366C2BBA
          (1436509052.449847) vcan0 0F6##1112233     two #: CAN FD, then one digit of flags
TRC       ;$FILEVERSION=2.1                          none in version 1.0
          ;$COLUMNS=N,O,T,B,I,d,R,L,D                from version 2.0 on
                1    17535.400 DT 1      0100 Rx -  8    00 00 00 00 00 00 00 00

python-can (4.6) leaves out a line that it cannot read, and pads a frame that is cut off. So this
file counts the lines that look like frames, and compares the bytes of each frame with its length.

lines --_count_frames--> --_with_events--> python-can --_whole_frames--> --capture_of--> Capture
"""

import logging
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from calib.base.errors import LogError
from calib.base.extras import need
from calib.logs.bus.recording import capture_of, recording_of, require_dbc
from calib.logs.channel_map import Databases
from calib.logs.source import Recording, damaged


@dataclass
class _TextState:
    """Content of those lines of a text log that were read so far."""

    path: Path
    frames: int = 0  # number of lines that look like frames
    last: str = ""  # last line that is not blank
    block: str = ""  # last mark of a block in an ASC log, "begin" or "end"


def _count_frames(lines: Iterable[str], frame: re.Pattern[str], state: _TextState) -> Iterator[str]:
    """Yield the lines, and count in ``state`` those that begin as a ``frame`` does."""
    for line in lines:
        if frame.match(line):
            state.frames += 1
        if line.strip():
            state.last = line
        yield line


_HEADER = re.compile(r"\s*(date|base|//)", re.IGNORECASE)
_EVENTS = re.compile(r"\s*(no\s+)?internal\s+events", re.IGNORECASE)
_RELATIVE = re.compile(r"\s*base\s+\w+\s+timestamps\s+relative", re.IGNORECASE)
_BLOCK = re.compile(r"(begin|end)\s+triggerblock", re.IGNORECASE)


def _with_events(lines: Iterable[str], state: _TextState) -> Iterator[str]:
    """Yield the lines of an ASC log, with one about internal events below its header.

    python-can takes the first line after the header for such a line, and skips it. The last mark of
    a block goes into ``state``. Raises LogError for relative timestamps.
    """
    in_header = True
    for line in lines:
        if in_header:
            if _RELATIVE.match(line):
                flaw = "its timestamps are relative to the line before ('timestamps relative')"
                expected = "timestamps absolute: a missing line would shift all later ones"
                do = "export it again with absolute timestamps"
                raise LogError(flaw, where=state.path, expected=expected, do=do)
            in_header = not line.strip() or bool(_HEADER.match(line))
            if not (in_header or _EVENTS.match(line)):
                yield "no internal events logged\n"
        if mark := _BLOCK.match(line):
            state.block = mark[1].lower()
        yield line


_ASC_FRAME = re.compile(  # python-can reads no frame whose length has two digits, as in "Rx d 16"
    r"\s*\d+\.\d+\s+(\d+\s+(\w+\s+(Tx|Rx)\b(?!\s+d\s+\w{2,}\s)|ErrorFrame)"
    r"|CANFD\s+\d+\s+(Tx|Rx)\b)",
    re.IGNORECASE,
)
_TRC_FRAME = re.compile(  # any line that is neither a comment nor blank, nor an event or an error
    r"\s*+(?!;|$|(\d+\)?\s+)?[\d.]+\s+(\d+\s+)?"
    r"(ST|EC|ER|EV|Warng|Error|ErrFr|Event|FFFFFFFF)\b)"
)
_FORMATS = {
    ".asc": ("ASCReader", _ASC_FRAME),
    ".log": ("CanutilsLogReader", re.compile(r"\s*\(\d+\.\d+\)\s")),
    ".trc": ("TRCReader", _TRC_FRAME),
}
"""By file ending: the reader of python-can, and the pattern with which a line of a frame begins."""
TEXT_LOGS = tuple(_FORMATS)  # file name endings of the text logs of a bus
_VERSION = re.compile(r";\$FILEVERSION=\s*(\S+)")
_HEAD = 4096  # characters of a TRC log in which its version stands
_VERSIONS = ("1.0", "1.1", "1.3", "2.0", "2.1")  # of TRC; python-can takes any other for 1.0


def open_text_log(path: Path, dbc: Databases) -> Recording:
    """Open a log whose ending is one of `TEXT_LOGS`.

    Raises LogError for a line or a frame that is cut off or cannot be read, for an ASC block
    without its end, for relative timestamps, and if no DBC describes a frame.
    """
    can = need("can", "can", str(path), LogError)
    logging.getLogger("can.io.trc").setLevel(logging.CRITICAL + 1)  # what it skips is refused here
    database = require_dbc(dbc, "can", str(path))
    ending = path.suffix.lower()
    reader, frame = _FORMATS[ending]
    state = _TextState(path)
    try:
        with path.open(encoding="utf-8", errors="replace") as file:
            if ending == ".trc":
                _require_version(file.read(_HEAD), path)
                file.seek(0)
            lines = _count_frames(file, frame, state)
            lines = _with_events(lines, state) if ending == ".asc" else lines
            messages = _whole_frames(getattr(can, reader)(lines), ending, path)
            capture = capture_of(messages, database, str(path))
    except LogError:
        if state.frames:  # a last line that is cut off explains the error better
            _require_line_end(state, ending)
        raise
    _require_line_end(state, ending)
    count = len(capture.times)
    if state.block == "begin":
        frames = f"{count} frames up to {capture.times[-1]:.3f} s"
        flaw = f"the end is missing: {frames}, but no 'End TriggerBlock'"
        raise damaged(path, flaw, "a block with its end")
    if count != state.frames:
        flaw = f"{count} of {state.frames} lines that look like frames can be read"
        raise damaged(path, f"{flaw}: others are missing or damaged", "all of them")
    note = "the log has no footer: one that was cut at the end of a line looks like a complete one"
    return recording_of(capture, database, () if state.block else (note,), str(path))


def _require_version(head: str, path: Path) -> None:
    if (version := _VERSION.search(head)) and version[1] not in _VERSIONS:
        expected, do = f"one of {', '.join(_VERSIONS)}", "convert it with PEAK-Converter"
        raise LogError(f"version {version[1]} of TRC", where=path, expected=expected, do=do)


def _whole_frames(messages: Iterable[Any], ending: str, path: Path) -> Iterator[Any]:
    """Yield the frames of python-can. Raises LogError for one shorter than its length says."""
    from can.util import dlc2len

    for message in messages:
        if not message.is_fd:
            length = min(message.dlc, 8)  # codes 9 to 15 stand for 8 bytes, too (ISO 11898-1)
        elif ending == ".trc":
            length = dlc2len(message.dlc)  # the code of the length
        else:
            length = message.dlc  # the length itself
        if not message.is_remote_frame and len(message.data) < length:
            flaw = f"a frame at {message.timestamp:.6f} s has {len(message.data)} of {length} bytes"
            raise damaged(path, flaw)
        yield message


_LAST_BYTE = re.compile(r".*\s([0-9A-F]{2}|RTR)", re.IGNORECASE | re.DOTALL)


def _require_line_end(state: _TextState, ending: str) -> None:
    """Raise LogError if the last line is cut off."""
    is_frame = bool(_FORMATS[ending][1].match(state.last))
    # a TRC log of PEAK-Converter has no end of line after its last byte, which has two digits
    needs_no_end = ending == ".trc" and (not is_frame or _LAST_BYTE.fullmatch(state.last))
    if state.last and not (state.last.endswith("\n") or needs_no_end):
        cut = f"cut off within the last line, {state.last.strip()[:60]!r}"
        flaw = f"{cut}, after {state.frames - int(is_frame)} whole frames"
        raise damaged(state.path, flaw, "an end of line")
