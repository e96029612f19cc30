"""Read DBC, ARXML, KCD and SYM files with cantools: the signals in the frames of a bus.

The ending of the file names the format. A DBC is split into messages, each with its own statements,
and cantools reads one message at a time. So a flaw in one message leaves the others readable:

BO_ 256 WHL: 8 ESP           a message, followed by its signals
 SG_ WhlFL : 0|16@1+ ...
VAL_ 256 WhlFL 65535 "SNA";  a later statement on the message, that changes the decoding or a name

Comments and all other statements are left out.
"""

import logging
import re
from collections import defaultdict
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from calib.base.bounded import DBC, bytes_of
from calib.base.digest import sha256
from calib.base.errors import ChannelMapError, LogError
from calib.base.extras import need
from calib.base.plain import quoted
from calib.logs.channel_map import Databases
from calib.logs.text.encoding import text_of, to_utf8

if TYPE_CHECKING:
    from cantools.database.can import Message

Key = tuple[int, bool]  # identifier, and whether it is extended (29 bits)
_Described: TypeAlias = "Message | Flawed"

_FORMATS = ("dbc", "arxml", "kcd", "sym")  # another ending is read as a DBC
_LONGEST_TEXT = 1_000_000  # characters in quotes; cantools needs 300 bytes of memory for each
_DECODING = ("VAL_", "SIG_VALTYPE_", "SG_MUL_VAL_")  # statements that change what is decoded
_LONG_NAMES = ("SystemSignalLongSymbol", "SystemMessageLongSymbol")  # names of over 32 characters
_MOST_MESSAGES = 10_000  # cantools needs about a millisecond for each
_NO_MESSAGE = "VECTOR__INDEPENDENT_SIG_MSG"  # holds the signals that belong to no message
_EXTENDED = 1 << 31  # bit that a DBC adds to an identifier of 29 bits

# patterns of a DBC, whose groups are identifiers, names and units
_COMMENT = re.compile(r'^[ \t]*CM_ [^"\n]*"(?:\\.|[^"\\])*"\s*;', re.MULTILINE | re.DOTALL)
_BEGIN = re.compile(r'^[ \t]*(?=(?:[A-Z_]+_|VERSION)[ \t:"])', re.MULTILINE)  # of a statement
_MESSAGE = re.compile(r"BO_\s+(\d+)\s+([^\s:]+)\s*:")
_SIGNAL = re.compile(r'SG_\s+([^\s:]+)[^"\n]*(?:"([^"\n]*)")?')
_ON_MESSAGE = re.compile(
    rf"(?:{'|'.join(_DECODING)})\s+(\d+)\s|"
    rf'BA_\s+"(?:{"|".join(_LONG_NAMES)})"\s+(?:SG_|BO_)\s+(\d+)'
)
_DEFINITION = re.compile(rf'BA_(?:DEF_|DEF_DEF_)?\s.*"(?:{"|".join(_LONG_NAMES)})"')
"""`_ON_MESSAGE`: a later statement on a message; `_DEFINITION`: of an attribute for long names."""


class FlawedSignal(NamedTuple):
    """A signal of a message that cannot be read, with the field names of cantools."""

    name: str
    unit: str
    length: int = 1  # [bits]; any that makes it a column, so that a map may name it


class Flawed(NamedTuple):
    """A message that cannot be read, and ``why``, with the field names of cantools."""

    name: str
    frame_id: int
    is_extended_frame: bool
    why: str
    signals: tuple[FlawedSignal, ...]
    where: str

    def error(self, signal: str) -> LogError:
        """Return the error for a channel whose source is this signal of the message."""
        flaw = f"{signal} is a signal of message {self.name}, which cannot be read: {self.why}"
        expected = "a message without a flaw for each channel"
        do = f"correct {self.name} in the DBC, or name the column under `ignore` in the channel map"
        return LogError(flaw, where=self.where, expected=expected, do=do)


class Dbc(NamedTuple):
    """The messages of all databases."""

    buses: "dict[str, dict[Key, _Described]]"  # by bus and identifier; the bus "" means all buses
    notes: tuple[str, ...] = ()  # names and digests of the files, and their flaws

    def find(self, bus: str, key: Key) -> "_Described | None":
        """Return the message that describes the frames of an identifier on a bus, or None."""
        return self.buses.get(bus, {}).get(key) or self.buses.get("", {}).get(key)


def read_databases(databases: Databases, extra: str, where: str) -> Dbc:
    """Read the databases of a channel map; ``extra`` is the optional dependency with cantools.

    Raises ChannelMapError for a file that is not valid, and for two messages with the same
    identifier on a bus.
    """
    cantools: Any = need("cantools", extra, where, LogError)
    logging.getLogger("cantools").setLevel(logging.CRITICAL + 1)  # what it warns of is refused here
    notes, buses = list[str](), dict[str, dict[Key, _Described]]()
    for bus, files in databases.items():
        by_key = buses.setdefault(bus, {})
        prefix = f"bus {bus}: " if bus else ""
        for path in files:
            content, messages, flaws = _load(cantools, path)
            for message in messages:
                key = (message.frame_id, message.is_extended_frame)
                if key in by_key:
                    flaw = f"{message.name} has the identifier {key[0]:#x} of {by_key[key].name}"
                    expected = "one description of each frame"
                    do = f'name the DBC of each bus, as in dbc = {{1 = "{path.name}"}}'
                    raise ChannelMapError(flaw, where=path, expected=expected, do=do)
                by_key[key] = message
            notes.append(f"{prefix}frames decoded by {path.name} (SHA-256 {sha256(content)[:16]})")
            notes += [f"{prefix}{path.name}: {flaw}" for flaw in flaws]
    return Dbc(buses, tuple(notes))


def _load(cantools: Any, path: Path) -> "tuple[bytes, list[_Described], list[str]]":
    """Return the bytes and the messages of a database, and notes on its flaws."""
    ending = path.suffix[1:].lower()
    file_format = ending if ending in _FORMATS else "dbc"
    name = file_format.upper()
    content = bytes_of(path, DBC, ChannelMapError, f"a {name}")
    try:
        text, _ = text_of(to_utf8(content, str(path)))
    except LogError as cause:
        raise ChannelMapError(cause.problem, where=path, expected=f"the format {name}") from cause
    if file_format in ("dbc", "sym"):  # the others are XML, which needs no such limit
        pieces = text.replace('\\"', "''").split('"')  # every second one stands in quotes
        longest = max(map(len, pieces[1::2]), default=0)
        if longest > _LONGEST_TEXT:
            flaw, do = f"a text in quotes has {longest} characters", "is a quote missing?"
            raise ChannelMapError(flaw, where=path, expected=f"at most {_LONGEST_TEXT}", do=do)
    try:
        if file_format == "dbc":
            messages, flaws = _by_message(cantools, text, str(path))
        else:
            database = cantools.database.load_string(text, file_format, strict=True)
            messages, flaws = database.messages, []
    except Exception as cause:  # cantools raises many kinds, some of its parser's
        flaw = f"not a valid {name}: {cause}"
        raise ChannelMapError(flaw, where=path, expected=f"the format {name}") from cause
    flawed = [message for message in messages if isinstance(message, Flawed)]
    if len(flawed) == len(messages):
        example = f", as {flawed[0].name}: {flawed[0].why}" if flawed else ""
        flaw = f"not a valid {name}: no message that can be read{example}"
        raise ChannelMapError(flaw, where=path, expected="the messages of a bus")
    return content, messages, flaws


@dataclass
class _MessageText:
    """The text of one message in a DBC."""

    number: int  # identifier as the DBC writes it, with the bit `_EXTENDED` if it has 29 bits
    name: str
    text: str  # all statements of the message
    signals: dict[str, str] = field(default_factory=dict)  # units by name


def _by_message(cantools: Any, text: str, where: str) -> "tuple[list[_Described], list[str]]":
    """Read the messages of a DBC one by one; return them and a note on those that are flawed."""
    common, parts = _parts(text)
    if len(parts) > _MOST_MESSAGES:
        raise ValueError(f"it has {len(parts)} messages, at most {_MOST_MESSAGES} are read")
    by_key: dict[Key, _Described] = {}
    for part in parts:
        message = _read(cantools, part, common, where)
        key = (message.frame_id, message.is_extended_frame)
        if first := by_key.get(key):
            name, why = f"{first.name} and {message.name}", f"both have the identifier {key[0]:#x}"
            all_signals = (*first.signals, *message.signals)
            signals = tuple(FlawedSignal(signal.name, signal.unit or "") for signal in all_signals)
            message = Flawed(name, key[0], key[1], why, signals, where)
        by_key[key] = message
    messages = list(by_key.values())
    flawed = [f"{m.name} ({m.why})" for m in messages if isinstance(m, Flawed)]
    note = f"{len(flawed)} message(s) that cannot be read: {quoted(flawed, 5)}"
    return messages, [note] if flawed else []


def _read(cantools: Any, part: _MessageText, common: str, where: str) -> "_Described":
    """Read one message by cantools; return a `Flawed` one if that fails."""
    try:
        messages = cantools.database.load_string(part.text + common, "dbc", strict=True).messages
        if len(messages) == 1:
            return messages[0]  # type: ignore[no-any-return]
        why = f"it holds {len(messages)} messages"
    except Exception as cause:  # cantools raises many kinds, some of its parser's
        why = str(cause) or type(cause).__name__
        why = re.sub(r'^DBC: "(.*?)\.?"$', r"\1", why, flags=re.DOTALL)
        why = why.removesuffix(f" in message {part.name}")
        why = re.sub(r" at line \d+, column \d+", "", why)  # the line of the part, not of the file
    signals = tuple(FlawedSignal(name, unit) for name, unit in part.signals.items())
    is_extended = part.number > 0x7FF  # over 11 bits, also if the DBC lacks the bit `_EXTENDED`
    return Flawed(part.name, part.number & ~_EXTENDED, is_extended, why, signals, where)


def _parts(text: str) -> tuple[str, list[_MessageText]]:
    """Split a DBC into the definitions that all messages need, and the text of each message."""
    parts: list[_MessageText] = []
    later: dict[int, str] = defaultdict(str)  # statements that follow the messages, by number
    common, previous = "", ""
    for statement in _BEGIN.split(_COMMENT.sub("", text))[1:]:
        if message := _MESSAGE.match(statement):
            parts.append(_MessageText(int(message[1]), message[2], statement))
        elif (signal := _SIGNAL.match(statement)) and previous in ("BO_", "SG_") and parts:
            parts[-1].text += statement
            parts[-1].signals[signal[1]] = signal[2] or ""
        elif number := _ON_MESSAGE.match(statement):
            later[int(number[1] or number[2])] += statement
        elif _DEFINITION.match(statement):
            common += statement
        previous = statement.split(maxsplit=1)[0]
    for part in parts:
        part.text += later[part.number]
    return common, [part for part in parts if part.name != _NO_MESSAGE]
