"""Make a recording from bus frames and a DBC: one trace for each signal of the frames."""

from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from calib.errors import LogError
from calib.logs.bus.dbc import LONGEST, Dbc, decode, read_dbc
from calib.logs.bus.frames import Frames, Gathered
from calib.logs.recording import ChannelTrace, Recording, named
from calib.logs.running import running
from calib.logs.source import Column

if TYPE_CHECKING:
    import can
    from cantools.database.can import Message, Signal


def require_dbc(dbc: Sequence[Path], extra: str, where: str) -> Dbc:
    """Read the DBC files of the channel map. Raises LogError if there are none."""
    if not dbc:
        raise LogError(
            "bus frames do not contain the names of their signals",
            where=where,
            expected="a DBC that describes them",
            do='write `dbc = "FILE.dbc"` into a channel map and give it with --map',
        )
    return read_dbc(dbc, extra, where)


def gathered(messages: "Iterable[can.Message]", dbc: Dbc, where: str) -> Gathered:
    """All frames of a file. Raises LogError if python-can cannot read it."""
    found = Gathered(dbc.keys)
    try:
        found.take(messages)
    except Exception as cause:  # a damaged file makes python-can raise almost anything
        raise LogError(
            f"not readable after frame {len(found.times)}: {str(cause) or type(cause).__name__}",
            where=where,
            expected="a whole and undamaged log",
            do="copy the log again",
        ) from cause
    if not found.times:
        raise LogError("the log has no frames", where=where, expected="a log of bus frames")
    return found


def recording(found: Gathered, dbc: Dbc, notes: tuple[str, ...], where: str) -> Recording:
    """Signals of gathered frames, named as in the DBC; time counts from the first frame.

    Raises LogError if no frame is described by the DBC, and as `calib.logs.running`.
    """
    time, wrapped = running(np.asarray(found.times), where)
    begin = float(time.min())
    frames = require_known(found.result(time - begin), dbc, where)
    more = [f"time counts from the first frame, which was written at {begin:.6f} s"]
    if found.errors:
        more.append(f"{found.errors} error frames were ignored")
    return of_frames(frames, dbc, (*notes, *wrapped, *more))


def require_known(frames: list[Frames], dbc: Dbc, where: str) -> list[Frames]:
    """Return ``frames``. Raises LogError if there are none."""
    if not frames:
        raise LogError(
            "no frame of the log is in the DBC",
            where=where,
            expected="one of " + ", ".join(m.name for m in list(dbc.messages.values())[:10]),
            do="is it the DBC of this bus?",
        )
    return frames


def of_frames(frames: list[Frames], dbc: Dbc, notes: tuple[str, ...]) -> Recording:
    """Make the recording from frames and a DBC."""
    columns, signals = described(frames, dbc)

    def read(indices: Sequence[int]) -> list[ChannelTrace]:
        return [trace(*signals[i - 1]) for i in indices]

    return Recording(named(columns), read, (*dbc.notes, *notes))


def described(
    frames: list[Frames], dbc: Dbc
) -> "tuple[list[Column], list[tuple[Frames, Message, Signal]]]":
    """Every signal that is a number: its column, and its frames, message and signal."""
    count = Counter(item.key for item in frames)
    columns, signals = [], []
    for item in frames:
        message = dbc.messages[item.key]
        prefix = f"{item.bus}." if count[item.key] > 1 else ""
        for signal in message.signals:
            if signal.length > LONGEST:
                continue
            full = f"{prefix}{message.name}.{signal.name}"
            columns.append(Column(signal.name, signal.unit or None, full))
            signals.append((item, message, signal))
    return columns, signals


def trace(frames: Frames, message: "Message", signal: "Signal") -> ChannelTrace:
    """Decode one signal."""
    decoded = decode(frames, message, signal)
    clock = f"message {message.name} of bus {frames.bus}"
    if decoded.time.size < frames.time.size:
        clock += f", frames with {signal.name}"
    return ChannelTrace(clock, decoded.time, decoded.values, decoded.state)
