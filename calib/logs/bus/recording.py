"""Make a recording from bus frames and a DBC: one trace for each signal of the frames."""

from collections import Counter
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, cast

import numpy as np

from calib.errors import LogError
from calib.logs.bus.by_message import Flawed, FlawedSignal
from calib.logs.bus.databases import Databases
from calib.logs.bus.dbc import LONGEST, Dbc, decode, read_databases
from calib.logs.bus.frames import Frames, Gathered, joined, once
from calib.logs.bus.j1939 import source_of
from calib.logs.recording import ChannelTrace, Recording, named
from calib.logs.running import running
from calib.logs.source import Column

if TYPE_CHECKING:
    import can
    from cantools.database.can import Message, Signal

    Place = tuple[Frames, Message | Flawed, Signal | FlawedSignal]


def require_dbc(databases: Databases, extra: str, where: str) -> Dbc:
    """Read the files of the channel map that describe frames. Raises LogError if there are none."""
    if not databases.all:
        raise LogError(
            "bus frames do not contain the names of their signals",
            where=where,
            expected="a DBC that describes them",
            do='write `dbc = "FILE.dbc"` into a channel map and give it with --map',
        )
    return read_databases(databases, extra, where)


def gathered(messages: "Iterable[can.Message]", dbc: Dbc, where: str) -> Gathered:
    """All frames of a file. Raises LogError if python-can cannot read it."""
    found = Gathered(dbc.knows)
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
    frames, doubled = once(found.result(time - begin))
    require_known(frames, found.buses, dbc, where)
    more = [f"time counts from the first frame, which was written at {begin:.6f} s"]
    empty = sorted(set(dbc.buses) - set(found.buses))
    if empty:
        more.append(
            f"no frames on bus {', '.join(empty)}, which the map names; "
            f"the log has bus {', '.join(found.buses)}"
        )
    if found.errors:
        more.append(f"{found.errors} error frames were ignored")
    return of_frames(frames, dbc, (*notes, *wrapped, *more, *doubled))


def require_known(frames: list[Frames], buses: Sequence[str], dbc: Dbc, where: str) -> None:
    """Raise LogError if none of ``frames`` is described; ``buses`` are those of the log."""
    if not any(dbc.find(item.bus, item.key) for item in frames):
        names = f" (its buses are {', '.join(buses)})" if buses and dbc.buses else ""
        raise LogError(
            f"no frame of the log{names} is in the DBC",
            where=where,
            expected="one of " + ", ".join(dbc.names[:10]),
            do="is it the DBC of this bus?",
        )


def of_frames(frames: list[Frames], dbc: Dbc, notes: tuple[str, ...]) -> Recording:
    """Make the recording from frames and a DBC."""
    columns, signals = described(frames, dbc)

    def read(indices: Sequence[int]) -> list[ChannelTrace]:
        return [trace(*signals[i - 1]) for i in indices]

    return Recording(named(columns), read, (*dbc.notes, *notes))


def described(frames: list[Frames], dbc: Dbc) -> "tuple[list[Column], list[Place]]":
    """Every signal that is a number: its column, and its frames, message and signal.

    The full name begins with the bus if several buses have the message, and has the source address
    (``CCVS1@0B``) if frames of several addresses are described by it.
    """
    if dbc.sources is not None:  # priority and destination make no other message
        frames = joined(frames, lambda item: _origin(item, dbc))
    found = [(item, message) for item in frames if (message := dbc.find(item.bus, item.key))]
    count = Counter((item.bus, message.name) for item, message in found)
    buses = Counter(name for _, name in count)
    columns, signals = [], []
    for item, message in found:
        prefix = f"{item.bus}." if buses[message.name] > 1 else ""
        several = count[item.bus, message.name] > 1
        name = f"{message.name}@{source_of(item.key[0]):02X}" if several else message.name
        for signal in message.signals:
            if signal.length > LONGEST:
                continue
            columns.append(
                Column(signal.name, signal.unit or None, f"{prefix}{name}.{signal.name}")
            )
            signals.append((item, message, signal))
    return columns, signals


def _origin(frames: Frames, dbc: Dbc) -> tuple[object, ...]:
    """What frames of one J1939 message from one address have in common."""
    message = dbc.find(frames.bus, frames.key)
    identifier, extended = frames.key
    name = message.name if message else ""
    return (frames.bus, name, source_of(identifier)) if extended else (frames.bus, frames.key)


def trace(
    frames: Frames, message: "Message | Flawed", signal: "Signal | FlawedSignal"
) -> ChannelTrace:
    """Decode one signal. Raises LogError if its message has a flaw in the DBC."""
    if isinstance(message, Flawed):
        raise message.error(signal.name)
    decoded = decode(frames, message, cast("Signal", signal))
    clock = f"message {message.name} of bus {frames.bus}"
    if frames.key[0] != message.frame_id:
        clock += f" from address {source_of(frames.key[0]):#04x}"
    if decoded.time.size < frames.time.size:
        clock += f", frames with {signal.name}"
    return ChannelTrace(clock, decoded.time, decoded.values, decoded.state)
