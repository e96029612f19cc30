"""DBC files: position and unit of each signal in the frames of a bus. Read with cantools."""

import hashlib
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from calib.bounded import DBC, bytes_of
from calib.errors import ChannelMapError
from calib.logs.bus.bits import last_byte, number, raw
from calib.logs.bus.frames import Frames, Key
from calib.logs.extra import need
from calib.logs.source import Array

if TYPE_CHECKING:
    from cantools.database.can import Message, Signal

INVALID = re.compile(
    r"\bsna\b|invalid|error|fault|not.?avail|undefined|\binit|fehler|ung(ue|ü)ltig", re.IGNORECASE
)
"""Names of raw values that mark an invalid measurement."""


@dataclass(frozen=True)
class Dbc:
    """The messages of one or more DBC files by identifier; ``notes`` name the files."""

    messages: "dict[Key, Message]"
    notes: tuple[str, ...]

    @property
    def keys(self) -> frozenset[Key]:
        """Identifiers of all messages."""
        return frozenset(self.messages)


@dataclass(frozen=True)
class Decoded:
    """A signal: ``time`` [s] of the frames that carry it, and its ``values`` in its unit.

    Raw values that are named as invalid are NaN. ``state`` is true if every value has a name.
    """

    time: Array
    values: Array
    state: bool


def read_dbc(paths: Sequence[Path], extra: str, where: str) -> Dbc:
    """Read DBC files.

    ``extra`` is the package extra that installs cantools; ``where`` names the log in messages.
    Raises LogError if cantools is missing, ChannelMapError for a file that is missing or not a DBC,
    and for an identifier that two files describe differently.
    """
    cantools: Any = need("cantools", extra, where)
    messages: dict[Key, Message] = {}
    notes = []
    for path in paths:
        content = bytes_of(path, DBC, ChannelMapError, "a DBC")
        try:
            text = content.decode("cp1252", errors="replace")
            database = cantools.database.load_string(text, database_format="dbc", strict=True)
        except Exception as cause:  # cantools raises many kinds, some of its parser's
            raise ChannelMapError(f"not a DBC: {cause}", where=path, expected="a DBC") from cause
        if not database.messages:
            raise ChannelMapError("the file has no messages", where=path, expected="a DBC")
        for message in database.messages:
            key = (message.frame_id, message.is_extended_frame)
            if key in messages:
                raise ChannelMapError(
                    f"{message.name} has the identifier {message.frame_id:#x} of "
                    f"{messages[key].name}",
                    where=path,
                    expected="one description of each frame",
                    do="name the DBC of one bus only",
                )
            messages[key] = message
        digest = hashlib.sha256(content).hexdigest()
        notes.append(f"frames decoded by {path.name} (SHA-256 {digest[:16]})")
    return Dbc(messages, tuple(notes))


def decode(frames: Frames, message: "Message", signal: "Signal") -> Decoded:
    """Decode one signal from all frames of its message.

    A multiplexed signal has samples only in frames where its multiplexer selects it. Frames that
    are too short for the signal have no sample either.
    """
    chosen = _present(frames, message, signal)
    data = frames.data if chosen.all() else frames.data[chosen]
    little = signal.byte_order == "little_endian"
    if not len(data):
        return Decoded(frames.time[chosen], np.zeros(0), False)
    bits = raw(data, signal.start, signal.length, little)
    codes = number(bits, signal.length, signal.is_signed, signal.is_float)
    values = codes * float(signal.scale) + float(signal.offset)
    names = {float(code): str(name) for code, name in (signal.choices or {}).items()}
    state = bool(names) and bool(np.isin(np.unique(codes), list(names)).all())
    none = [code for code, name in names.items() if INVALID.search(name)]
    if none:
        values[np.isin(codes, none)] = np.nan
    return Decoded(frames.time[chosen], values, state)


def _present(frames: Frames, message: "Message", signal: "Signal") -> NDArray[np.bool_]:
    """Mask of the frames that contain the signal: long enough, and selected by the multiplexer."""
    little = signal.byte_order == "little_endian"
    here: NDArray[np.bool_] = frames.length > last_byte(signal.start, signal.length, little)
    if not signal.multiplexer_ids or signal.multiplexer_signal is None:
        return here
    selector = message.get_signal_by_name(signal.multiplexer_signal)
    here &= _present(frames, message, selector)
    if not here.any():
        return here
    ends = selector.byte_order == "little_endian"
    codes = raw(frames.data, selector.start, selector.length, ends)
    here &= np.isin(codes, np.asarray(signal.multiplexer_ids, np.uint64))
    return here
