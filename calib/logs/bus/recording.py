"""Make a recording from bus frames and a DBC: one trace for each signal of the frames.

little endian: start is the lowest bit        big endian: start is the highest bit
byte 0  7 6 5 4 3 2 1 0                       byte 0  7 6 5 4 3 2 1 0
        . . . < - - - s   rest in byte 1              . . . s - - - >   rest in byte 1
byte 1 15 . . . . . . 8                       byte 1 15 . . . . . . 8
"""

import re
from array import array
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from calib.base.arrays import Array
from calib.base.errors import LogError
from calib.logs.bus.dbc import Dbc, Flawed, FlawedSignal, Key, read_databases
from calib.logs.channel_map import Databases
from calib.logs.clock import check_running
from calib.logs.source import CLOCK, ChannelTrace, Column, Recording, damaged

if TYPE_CHECKING:
    import can
    from cantools.database.can import Message, Signal


Place: TypeAlias = "tuple[Frames, Message | Flawed, Signal | FlawedSignal]"

_INVALID = re.compile(
    r"\bsna\b|invalid|error|fault|not.?avail|undefined|\binit|fehler|ung(ue|ü)ltig", re.IGNORECASE
)
"""Names of raw values that mark an invalid measurement."""


_LONGEST = 64
"""Bits of the longest signal that is a number; longer ones are text or raw bytes."""
_REAL = {16: ("u2", "f2"), 32: ("u4", "f4"), 64: ("u8", "f8")}
"""Types of raw integers and of the IEEE 754 numbers in them, by bits."""


@dataclass(frozen=True)
class Frames:
    """All frames of one identifier on one bus, in the order of the file.

    ``time`` [s] (n,); ``data`` (n, bytes), zero past the ``length`` (n,) of a frame.
    """

    bus: str
    key: Key
    time: Array
    data: NDArray[np.uint8]
    length: NDArray[np.uint16]


@dataclass
class Gathered:
    """Frames while a file is read: those that the DBC knows, and the times of all [s]."""

    dbc: Dbc
    times: "array[float]" = field(default_factory=lambda: array("d"))
    errors: int = 0
    known: dict[tuple[str, Key], bool] = field(default_factory=dict)
    _rows: "dict[tuple[str, Key], array[int]]" = field(default_factory=dict)
    _data: dict[tuple[str, Key], list[bytes]] = field(default_factory=dict)

    def take(self, messages: "Iterable[can.Message]") -> None:
        """Read all messages. Error and remote frames are counted but have no data."""
        for number, message in enumerate(messages, start=len(self.times)):
            self.times.append(message.timestamp)
            if message.is_error_frame:
                self.errors += 1
                continue
            origin = (str(message.channel), (message.arbitration_id, message.is_extended_id))
            if origin not in self.known:
                self.known[origin] = self.dbc.find(*origin) is not None
                self._rows[origin], self._data[origin] = array("L"), []
            if self.known[origin] and not message.is_remote_frame:
                self._rows[origin].append(number)
                self._data[origin].append(bytes(message.data))

    @property
    def buses(self) -> list[str]:
        """All buses of the log."""
        return sorted({bus for bus, _ in self.known})

    def result(self, time: Array) -> list[Frames]:
        """Frames by bus and identifier; ``time`` [s] replaces `times`, shape (n,)."""
        return [
            frames_of(*origin, time[rows], self._data[origin])
            for origin in sorted(self._rows)
            if (rows := np.asarray(self._rows[origin], np.int64)).size
        ]


def frames_of(bus: str, key: Key, time: Array, data: list[bytes]) -> Frames:
    """Make `Frames` from a list of bytes, one for each frame."""
    length = np.fromiter(map(len, data), np.uint16, len(data))
    width = int(length.max(initial=0))
    padded = b"".join(d.ljust(width, b"\0") for d in data)
    return Frames(bus, key, time, np.frombuffer(padded, np.uint8).reshape(len(data), width), length)


def require_dbc(databases: Databases, extra: str, where: str) -> Dbc:
    """Read the files of the channel map that describe frames. Raises LogError if there are none."""
    if not any(databases.values()):
        raise LogError(
            "bus frames do not contain the names of their signals",
            where=where,
            expected="a DBC that describes them",
            do='write `dbc = "FILE.dbc"` into a channel map and give it with --map',
        )
    return read_databases(databases, extra, where)


def gathered(messages: "Iterable[can.Message]", dbc: Dbc, where: str) -> Gathered:
    """All frames of a file. Raises LogError if python-can cannot read it."""
    found = Gathered(dbc)
    try:
        found.take(messages)
    except LogError:
        raise
    except Exception as cause:  # a damaged file makes python-can raise almost anything
        what = f"not readable after frame {len(found.times)}"
        raise damaged(where, what, "a whole and undamaged log") from cause
    if not found.times:
        raise LogError("the log has no frames", where=where, expected="a log of bus frames")
    return found


def recording(found: Gathered, dbc: Dbc, notes: tuple[str, ...], where: str) -> Recording:
    """Signals of gathered frames, named as in the DBC; time counts from the first frame."""
    time = np.asarray(found.times)
    check_running(time, where)
    begin = float(time.min())
    frames = found.result(time - begin)
    require_known(frames, found.buses, dbc, where)
    more = [f"time counts from the first frame, which was written at {begin:.6f} s"]
    empty = sorted(set(dbc.buses) - {"", *found.buses})
    if empty:
        more.append(
            f"no frames on bus {', '.join(empty)}, which the map names; "
            f"the log has bus {', '.join(found.buses)}"
        )
    if found.errors:
        more.append(f"{found.errors} error frames were ignored")
    columns, signals = described(frames, dbc)

    def read(indices: Sequence[int]) -> list[ChannelTrace]:
        return [decode(*signals[i - 1]) for i in indices]

    return Recording((CLOCK, *columns), read, (*dbc.notes, *notes, *more))


def require_known(frames: list[Frames], buses: Sequence[str], dbc: Dbc, where: str) -> None:
    """Raise LogError if none of ``frames`` is described; ``buses`` are those of the log."""
    if not any(dbc.find(item.bus, item.key) for item in frames):
        names = f" (its buses are {', '.join(buses)})" if buses and set(dbc.buses) - {""} else ""
        known = [m.name for messages in dbc.buses.values() for m in messages.values()]
        raise LogError(
            f"no frame of the log{names} is in the DBC",
            where=where,
            expected="one of " + ", ".join(known[:10]),
            do="is it the DBC of this bus?",
        )


def described(frames: list[Frames], dbc: Dbc) -> tuple[list[Column], list["Place"]]:
    """Column and place of every signal that is a number; several buses are named in the column."""
    found = [(item, message) for item in frames if (message := dbc.find(item.bus, item.key))]
    buses = Counter(message.name for _, message in found)
    columns, signals = [], []
    for item, message in found:
        prefix = f"{item.bus}." if buses[message.name] > 1 else ""
        for signal in message.signals:
            if signal.length > _LONGEST:
                continue
            full = f"{prefix}{message.name}.{signal.name}"
            columns.append(Column(signal.name, signal.unit or None, full))
            signals.append((item, message, signal))
    return columns, signals


def decode(
    frames: Frames, message: "Message | Flawed", signal: "Signal | FlawedSignal"
) -> ChannelTrace:
    """One signal from all frames that have it; a state if every value has a name.

    Raw values that are named as invalid are NaN. Raises LogError if the DBC has a flaw there.
    """
    if isinstance(message, Flawed):
        raise message.error(signal.name)
    signal = cast("Signal", signal)
    chosen = _present(frames, message, signal)
    data = frames.data if chosen.all() else frames.data[chosen]
    clock = f"message {message.name} of bus {frames.bus}"
    if not chosen.all():
        clock += f", frames with {signal.name}"
    if not len(data):
        return ChannelTrace(clock, frames.time[chosen], np.zeros(0))
    little = signal.byte_order == "little_endian"
    bits = _raw(data, signal.start, signal.length, little)
    codes = _number(bits, signal.length, signal.is_signed, signal.is_float)
    values = codes * float(signal.scale) + float(signal.offset)
    names = {float(code): str(name) for code, name in (signal.choices or {}).items()}
    state = bool(names) and bool(np.isin(np.unique(codes), list(names)).all())
    none = [code for code, name in names.items() if _INVALID.search(name)]
    if none:
        values[np.isin(codes, none)] = np.nan
    return ChannelTrace(clock, frames.time[chosen], values, state)


def _present(frames: Frames, message: "Message", signal: "Signal") -> NDArray[np.bool_]:
    """Mask of the frames that contain the signal: long enough, and selected by the multiplexer."""
    little = signal.byte_order == "little_endian"
    here: NDArray[np.bool_] = frames.length > _last_byte(signal.start, signal.length, little)
    if not signal.multiplexer_ids or signal.multiplexer_signal is None:
        return here
    selector = message.get_signal_by_name(signal.multiplexer_signal)
    here &= _present(frames, message, selector)
    if not here.any():
        return here
    ends = selector.byte_order == "little_endian"
    codes = _raw(frames.data, selector.start, selector.length, ends)
    here &= np.isin(codes, np.asarray(signal.multiplexer_ids, np.uint64))
    return here


def _raw(data: NDArray[np.uint8], start: int, length: int, little: bool) -> NDArray[np.uint64]:
    """Unsigned integers of ``length`` bits, (n,), from frames (n, bytes); ``start`` as in a DBC.

    >>> _raw(np.array([[0x34, 0x12]], np.uint8), 0, 16, little=True)
    array([4660], dtype=uint64)
    >>> _raw(np.array([[0x12, 0x34]], np.uint8), 7, 16, little=False)
    array([4660], dtype=uint64)
    """
    begin = _first(start, little)
    byte, bit = divmod(begin, 8)
    part = data[:, byte : _last_byte(start, length, little) + 1]
    bits = np.unpackbits(part, axis=1, bitorder="little" if little else "big")
    place = np.uint64(1) << np.arange(length, dtype=np.uint64)
    return bits[:, bit : bit + length] @ (place if little else place[::-1])


def _last_byte(start: int, length: int, little: bool) -> int:
    """Index of the last byte of a frame that a signal uses."""
    return (_first(start, little) + length - 1) // 8


def _first(start: int, little: bool) -> int:
    """The first bit of a signal, counted from the lowest one of each byte, or from the highest."""
    return start if little else 8 * (start // 8) + 7 - start % 8


def _number(value: NDArray[np.uint64], length: int, signed: bool, real: bool) -> Array:
    """Values of raw integers of ``length`` bits: unsigned, two's complement or IEEE 754."""
    if real:
        integer, floating = _REAL[length]
        return value.astype(integer).view(floating).astype(np.float64)
    if not signed:
        return value.astype(np.float64)
    unused = np.uint64(64 - length)
    return ((value << unused).view(np.int64) >> np.int64(64 - length)).astype(np.float64)
