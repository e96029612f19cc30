"""Make a recording from bus frames and a DBC: one trace for each signal of the frames.

messages of python-can --capture_of--> Capture --recording_of--> Recording, which calls decode

A DBC counts the bits of a frame as below. A signal begins at its start bit (s) and covers the bits
marked (-); in both byte orders it goes on in byte 1:

little endian, s is the lowest bit     big endian, s is the highest bit
byte 0   7  6  5  4  3  2  1  0        byte 0   7  6  5  4  3  2  1  0
         -  -  -  -  s                                   s  -  -  -  -
byte 1  15 14 13 12 11 10  9  8        byte 1  15 14 13 12 11 10  9  8
"""

import re
from array import array
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from calib.base.arrays import Array, Mask
from calib.base.errors import LogError
from calib.base.plain import quoted
from calib.logs.bus.dbc import Dbc, Flawed, FlawedSignal, Key, read_databases
from calib.logs.channel_map import Databases
from calib.logs.clock import check_running
from calib.logs.source import CLOCK, ChannelTrace, Column, Recording, damaged

if TYPE_CHECKING:
    import can
    from cantools.database.can import Message, Signal


_Source: TypeAlias = "tuple[Frames, Message | Flawed, Signal | FlawedSignal]"
"""Arguments of `decode`."""

_INVALID = re.compile(
    r"\bsna\b|invalid|error|fault|not.?avail|undefined|\binit|fehler|ung(ue|ü)ltig", re.IGNORECASE
)
"""Words in the name that a DBC gives a raw value, which mark an invalid measurement."""

_MOST_BITS = 64  # a longer signal is no number but text or raw bytes
_FLOAT_TYPES = {16: ("u2", "f2"), 32: ("u4", "f4"), 64: ("u8", "f8")}
"""Type of the raw integer, and of the IEEE 754 number with the same bits, by number of bits."""


class Frames(NamedTuple):
    """All n frames with one identifier on one bus, in the order of the file."""

    bus: str
    key: Key
    time: Array  # [s] (n,)
    data: NDArray[np.uint8]  # (n, bytes), filled with zeros after the length of the frame
    length: NDArray[np.uint16]  # [bytes] (n,)


@dataclass
class Capture:
    """The frames of a file."""

    times: "array[float]" = field(default_factory=lambda: array("d"))  # of all frames [s]
    errors: int = 0  # number of error frames; like remote frames they have no data
    described: "dict[tuple[str, Key], tuple[array[int], list[bytes]]]" = field(default_factory=dict)
    """Indices in ``times`` and bytes of the frames, by a bus and an identifier that the DBC has."""
    others: set[tuple[str, Key]] = field(default_factory=set)  # those that the DBC does not have


def capture_of(messages: "Iterable[can.Message]", dbc: Dbc, where: str) -> Capture:
    """Collect the frames of a file. Raises LogError if it has none or python-can cannot read it."""
    capture = Capture()
    try:
        for index, message in enumerate(messages):
            capture.times.append(message.timestamp)
            if message.is_error_frame:
                capture.errors += 1
                continue
            origin = (str(message.channel), (message.arbitration_id, message.is_extended_id))
            if origin not in capture.described:
                if origin in capture.others or not dbc.find(*origin):
                    capture.others.add(origin)
                    continue
                capture.described[origin] = (array("L"), [])
            if not message.is_remote_frame:
                indices, data = capture.described[origin]
                indices.append(index)
                data.append(bytes(message.data))
    except LogError:
        raise
    except Exception as cause:  # a damaged file makes python-can raise almost anything
        flaw = f"not readable after frame {len(capture.times)}"
        raise damaged(where, flaw, "a whole and undamaged log") from cause
    if not capture.times:
        raise LogError("the log has no frames", where=where, expected="a log of bus frames")
    return capture


def require_dbc(databases: Databases, extra: str, where: str) -> Dbc:
    """Read the databases of a channel map. Raises LogError if it names none."""
    if not any(databases.values()):
        flaw = "bus frames do not contain the names of their signals"
        do = 'write `dbc = "FILE.dbc"` into a channel map and give it with --map'
        raise LogError(flaw, where=where, expected="a DBC that describes them", do=do)
    return read_databases(databases, extra, where)


def frames_of(bus: str, key: Key, time: Array, data: list[bytes]) -> Frames:
    """Return n frames with the bytes ``data`` at ``time`` [s] (n,)."""
    length = np.fromiter(map(len, data), np.uint16, len(data))
    width = int(length.max())
    padded = np.frombuffer(b"".join(x.ljust(width, b"\0") for x in data), np.uint8)
    return Frames(bus, key, time, padded.reshape(len(data), width), length)


def recording_of(capture: Capture, dbc: Dbc, notes: tuple[str, ...], where: str) -> Recording:
    """Make a recording of captured frames; its times are seconds since the first frame."""
    time = np.asarray(capture.times)
    check_running(time, where)
    begin = float(time.min())
    frames = []
    for (bus, key), (indices, data) in sorted(capture.described.items()):
        if data:  # none if all were remote frames
            times = time[np.asarray(indices, np.int64)] - begin
            frames.append(frames_of(bus, key, times, data))
    buses = sorted({bus for bus, _ in (*capture.described, *capture.others)})
    check_described(frames, buses, dbc, where)
    frame_notes = [f"time counts from the first frame, which was written at {begin:.6f} s"]
    if capture.errors:
        frame_notes.append(f"{capture.errors} error frames were ignored")
    columns, sources = described_signals(frames, dbc)

    def read(indices: Sequence[int]) -> list[ChannelTrace]:
        return [decode(*sources[i - 1]) for i in indices]  # column 0 is the clock

    return Recording((CLOCK, *columns), read, (*dbc.notes, *notes, *frame_notes))


def check_described(frames: list[Frames], buses: Sequence[str], dbc: Dbc, where: str) -> None:
    """Raise LogError if the DBC describes none of the frames; ``buses`` are those of the log."""
    if any(dbc.find(item.bus, item.key) for item in frames):
        return
    has_named_buses = set(dbc.buses) != {""}
    names = f" (its buses are {', '.join(buses)})" if buses and has_named_buses else ""
    messages = [m.name for by_key in dbc.buses.values() for m in by_key.values()]
    flaw, do = f"no frame of the log{names} is in the DBC", "is it the DBC of this bus?"
    raise LogError(flaw, where=where, expected=f"one of {quoted(messages)}", do=do)


def described_signals(frames: list[Frames], dbc: Dbc) -> tuple[list[Column], list["_Source"]]:
    """Return the column of every signal that is a number, and the arguments to `decode` it.

    The full name of a column begins with the bus if several buses have messages of one name.
    """
    pairs = [(item, dbc.find(item.bus, item.key)) for item in frames]
    described = [(item, message) for item, message in pairs if message]
    count = Counter(message.name for _, message in described)
    columns, sources = [], []
    for item, message in described:
        prefix = f"{item.bus}." if count[message.name] > 1 else ""
        for signal in message.signals:
            if signal.length <= _MOST_BITS:
                full = f"{prefix}{message.name}.{signal.name}"
                columns.append(Column(signal.name, signal.unit or None, full))
                sources.append((item, message, signal))
    return columns, sources


def decode(
    frames: Frames, message: "Message | Flawed", signal: "Signal | FlawedSignal"
) -> ChannelTrace:
    """Decode the samples of one signal. Raises LogError if its message is flawed in the DBC.

    A sample is NaN if the DBC names its value "invalid" or the like (`_INVALID`). The signal is a
    state if the DBC has a name for each value that occurs.
    """
    if isinstance(message, Flawed):
        raise message.error(signal.name)
    signal = cast("Signal", signal)
    present = _present(frames, message, signal)
    data, time = frames.data[present], frames.time[present]
    clock = f"message {message.name} of bus {frames.bus}"
    if not present.all():
        clock += f", frames with {signal.name}"
    if not len(data):
        return ChannelTrace(clock, time, np.zeros(0))
    codes = _number(_raw(data, signal), signal)
    values = codes * float(signal.scale) + float(signal.offset)
    names = {float(code): str(name) for code, name in (signal.choices or {}).items()}
    is_state = bool(names) and bool(np.isin(np.unique(codes), list(names)).all())
    invalid = [code for code, name in names.items() if _INVALID.search(name)]
    values[np.isin(codes, invalid)] = np.nan
    return ChannelTrace(clock, time, values, is_state)


def _present(frames: Frames, message: "Message", signal: "Signal") -> Mask:
    """Mask (n,) of the frames that are long enough and whose multiplexer selects the signal."""
    present: Mask = 8 * frames.length.astype(np.int64) >= _first_bit(signal) + signal.length
    if not signal.multiplexer_ids or signal.multiplexer_signal is None:
        return present
    selector = message.get_signal_by_name(signal.multiplexer_signal)
    present &= _present(frames, message, selector)
    if present.any():
        codes = np.asarray(signal.multiplexer_ids, np.uint64)
        present &= np.isin(_raw(frames.data, selector), codes)
    return present


def _raw(data: NDArray[np.uint8], signal: "Signal") -> NDArray[np.uint64]:
    """Unsigned integers (n,) of a signal in frames (n, bytes).

    The bits of each byte are put in the order of the signal: lowest first in little endian, highest
    first in big endian. In this order a signal covers adjacent bits from `_first_bit` on.
    """
    is_little = signal.byte_order == "little_endian"
    first_bit = _first_bit(signal)
    byte, bit = divmod(first_bit, 8)
    part = data[:, byte : (first_bit + signal.length + 7) // 8]
    bits = np.unpackbits(part, axis=1, bitorder="little" if is_little else "big")  # (n, 8 * bytes)
    weights = np.uint64(1) << np.arange(signal.length, dtype=np.uint64)
    return bits[:, bit : bit + signal.length] @ (weights if is_little else weights[::-1])


def _first_bit(signal: "Signal") -> int:
    byte, bit = divmod(signal.start, 8)
    return 8 * byte + (bit if signal.byte_order == "little_endian" else 7 - bit)


def _number(raw: NDArray[np.uint64], signal: "Signal") -> Array:
    """Numbers (n,) for raw integers (n,), which are unsigned, two's complement or IEEE 754."""
    if signal.is_float:
        integer, floating = _FLOAT_TYPES[signal.length]
        return raw.astype(integer).view(floating).astype(np.float64)
    if not signal.is_signed:
        return raw.astype(np.float64)
    unused = 64 - signal.length  # shifted up and down again, the sign fills these bits
    return ((raw << np.uint64(unused)).view(np.int64) >> np.int64(unused)).astype(np.float64)
