"""A DBC message by message: a flaw in one of them costs only that one.

BO_ 256 WHL: 8 ESP           one message and its signals
 SG_ WhlFL : 0|16@1+ ...
VAL_ 256 WhlFL 65535 "SNA";  what else is told of them: `TOLD`, and their `LONG_NAMES`

Every message is read with its own statements and nothing else. Comments and other statements do not
change what is decoded, and are not read.
"""

import re
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from calib.base.errors import LogError

if TYPE_CHECKING:
    from cantools.database.can import Message

TOLD = ("VAL_", "SIG_VALTYPE_", "SG_MUL_VAL_")
"""Statements on a signal of a message that change what is decoded."""
LONG_NAMES = ("SystemSignalLongSymbol", "SystemMessageLongSymbol")
"""Attributes with the names that are longer than 32 characters."""
MOST = 10_000
"""Largest number of messages: each takes about a millisecond."""
SHOWN = 5
"""Number of names that a note lists."""
BUS_NAME = "DBName"
"""The attribute with the name of the bus."""
NO_MESSAGE = "VECTOR__INDEPENDENT_SIG_MSG"
"""Holds the signals that belong to no message."""
LONG = 1 << 31
"""Marks an identifier of 29 bits."""

_COMMENT = re.compile(r'^[ \t]*CM_ [^"\n]*"(?:\\.|[^"\\])*"\s*;', re.MULTILINE | re.DOTALL)
_BEGIN = re.compile(r'^[ \t]*(?=(?:[A-Z_]+_|VERSION)[ \t:"])', re.MULTILINE)
_MESSAGE = re.compile(r"BO_\s+(\d+)\s+([^\s:]+)\s*:")
_SIGNAL = re.compile(r'SG_\s+([^\s:]+)[^"\n]*(?:"([^"\n]*)")?')
_OF_MESSAGE = re.compile(
    rf"(?:{'|'.join(TOLD)})\s+(\d+)\s|"
    rf'BA_\s+"(?:{"|".join(LONG_NAMES)})"\s+(?:SG_|BO_)\s+(\d+)'
)
_COMMON = re.compile(rf'BA_(?:DEF_|DEF_DEF_)?\s.*"(?:{"|".join((BUS_NAME, *LONG_NAMES))})"')


@dataclass(frozen=True)
class FlawedSignal:
    """A signal of a message that cannot be read: what can be told of it."""

    name: str
    unit: str
    length: int = 1


@dataclass(frozen=True)
class Flawed:
    """A message that cannot be read, and ``why``; its names as those of a message of cantools."""

    name: str
    frame_id: int
    is_extended_frame: bool
    why: str
    signals: tuple[FlawedSignal, ...]
    where: str
    bus_name: str | None = None

    def error(self, signal: str) -> LogError:
        """The error for a channel that comes from one of its signals."""
        return LogError(
            f"{signal} is a signal of message {self.name}, which cannot be read: {self.why}",
            where=self.where,
            expected="a message without a flaw for each channel",
            do=f"correct message {self.name} in the DBC; or, where the channel is not needed, name "
            "its column under `ignore` in the channel map",
        )


@dataclass
class _Part:
    """A message: its statements, the number of its first line, and what it is called."""

    line: int
    number: int
    name: str
    text: str
    signals: dict[str, str]

    @property
    def unmarked(self) -> bool:
        """Whether the identifier has more than 11 bits and at most 29, and is not marked so."""
        return 0x7FF < self.number < 1 << 29

    @property
    def marked(self) -> str:
        """The statements, with `LONG` in each identifier of 29 bits."""
        if not self.unmarked:
            return self.text
        begin = rf'^(\s*[A-Z_]+_\s+(?:"\w+"\s+\w+_\s+)?){self.number}\b'
        return re.sub(begin, rf"\g<1>{self.number | LONG}", self.text, flags=re.MULTILINE)


def read_by_message(
    cantools: Any, text: str, where: str
) -> "tuple[list[Message | Flawed], list[str]]":
    """The messages of a DBC, and notes on what is wrong in it. Raises ValueError for too many."""
    common, parts = _parts(text)
    if len(parts) > MOST:
        raise ValueError(f"it has {len(parts)} messages, at most {MOST} are read")
    messages = _once([_read(cantools, part, common, where) for part in parts], where)
    flawed = [f"{m.name} ({m.why})" for m in messages if isinstance(m, Flawed)]
    unmarked = [part.name for part in parts if part.unmarked]
    notes = {
        "message(s) that cannot be read": flawed,
        "identifier(s) past 11 bits, not marked as of 29 bits but read so": unmarked,
    }
    return messages, [_told(what, names) for what, names in notes.items() if names]


def _once(messages: "list[Message | Flawed]", where: str) -> "list[Message | Flawed]":
    found: dict[tuple[int, bool], Message | Flawed] = {}
    for message in messages:
        key = (message.frame_id, message.is_extended_frame)
        if (first := found.get(key)) is not None:
            signals = (*first.signals, *message.signals)
            name, why = f"{first.name} and {message.name}", f"both have the identifier {key[0]:#x}"
            every = tuple(FlawedSignal(signal.name, signal.unit or "") for signal in signals)
            message = Flawed(name, *key, why, every, where)
        found[key] = message
    return list(found.values())


def _told(what: str, names: list[str]) -> str:
    more = f" and {len(names) - SHOWN} more" if len(names) > SHOWN else ""
    return f"{len(names)} {what}: {', '.join(names[:SHOWN])}{more}"


def _read(cantools: Any, part: _Part, common: str, where: str) -> "Message | Flawed":
    try:
        found = cantools.database.load_string(part.marked + common, "dbc", strict=True).messages
        if len(found) == 1:
            return found[0]  # type: ignore[no-any-return]
        why = "it is not one message"
    except Exception as cause:  # cantools raises many kinds, some of its parser's
        why = _in_file(str(cause) or type(cause).__name__, part)
    signals = tuple(FlawedSignal(name, unit) for name, unit in part.signals.items())
    return Flawed(part.name, part.number & ~LONG, part.number > 0x7FF, why, signals, where)


def _in_file(why: str, part: _Part) -> str:
    bare = re.sub(r'^DBC: "(.*?)\.?"$', r"\1", why, flags=re.DOTALL)
    bare = bare.removesuffix(f" in message {part.name}")
    return re.sub(r"(?<=at line )\d+", lambda found: str(int(found[0]) + part.line - 1), bare)


def _parts(text: str) -> tuple[str, list[_Part]]:
    """What is told of all messages, and the messages."""
    parts: list[_Part] = []
    later: dict[int, str] = defaultdict(str)
    common, before = "", ""
    for line, statement in _statements(_COMMENT.sub(lambda c: "\n" * c[0].count("\n"), text)):
        if message := _MESSAGE.match(statement):
            parts.append(_Part(line, int(message[1]), message[2], statement, {}))
        elif (signal := _SIGNAL.match(statement)) and before in ("BO_", "SG_") and parts:
            parts[-1].text += statement
            parts[-1].signals[signal[1]] = signal[2] or ""
        elif told := _OF_MESSAGE.match(statement):
            later[int(told[1] or told[2])] += statement
        elif _COMMON.match(statement):
            common += statement
        before = statement.split(maxsplit=1)[0]
    for part in parts:
        part.text += later[part.number]
    return common, [part for part in parts if part.name != NO_MESSAGE]


def _statements(text: str) -> Iterator[tuple[int, str]]:
    begins = [found.end() for found in _BEGIN.finditer(text)]
    line, last = 1, 0
    for begin, end in zip(begins, [*begins[1:], len(text)], strict=True):
        line += text.count("\n", last, begin)
        last = begin
        yield line, text[begin:end]
