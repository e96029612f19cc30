"""DBC, ARXML, KCD and SYM: position and unit of each signal in the frames of a bus.

All are read with cantools; the ending of the file names the format.
"""

import codecs
import hashlib
import logging
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from calib.base.bounded import DBC, bytes_of
from calib.base.errors import ChannelMapError
from calib.logs.bus.by_message import Flawed, read_by_message
from calib.logs.bus.frames import Key, group_of, source_of
from calib.logs.channel_map import DatabaseFile, Databases
from calib.logs.source import need

if TYPE_CHECKING:
    from cantools.database.can import Message

    Described = Message | Flawed

_FORMATS = ("dbc", "arxml", "kcd", "sym")
"""A file with another ending is read as a DBC."""

_EVERY = ""
"""Stands for every bus, where buses are named."""

_LONGEST_TEXT = 1_000_000
"""Characters of the longest text in quotes, such as a comment."""


@dataclass(frozen=True)
class Dbc:
    """Messages by identifier, on every bus and on one; ``notes`` name their files.

    ``sources`` as in `calib.logs.channel_map.Databases`.
    """

    messages: "dict[Key, Described]"
    notes: tuple[str, ...]
    buses: "dict[str, dict[Key, Described]]" = field(default_factory=dict)
    sources: tuple[int, ...] | None = None

    def knows(self, bus: str, key: Key) -> bool:
        """Whether `find` finds a message."""
        return self.find(bus, key) is not None

    def find(self, bus: str, key: Key) -> "Described | None":
        """The message that describes frames of an identifier on a bus, or None.

        With ``sources`` an extended identifier is found by its parameter group, if that has one
        message.
        """
        for messages in (self.buses.get(bus, {}), self.messages):
            if key in messages:
                return messages[key]
        identifier, extended = key
        if not extended or self.sources is None:
            return None
        if self.sources and source_of(identifier) not in self.sources:
            return None
        group = group_of(identifier)
        return self._groups.get(bus, {}).get(group) or self._groups[_EVERY].get(group)

    @cached_property
    def _groups(self) -> "dict[str, dict[int, Described]]":
        every = {_EVERY: self.messages, **self.buses}
        return {bus: _by_group(messages) for bus, messages in every.items()}

    @property
    def names(self) -> list[str]:
        """Names of all messages."""
        every = (self.messages, *self.buses.values())
        return [message.name for messages in every for message in messages.values()]


def _by_group(messages: "dict[Key, Described]") -> "dict[int, Described]":
    found: dict[int, list[Described]] = {}
    for (identifier, extended), message in messages.items():
        if extended:
            found.setdefault(group_of(identifier), []).append(message)
    return {group: several[0] for group, several in found.items() if len(several) == 1}


def read_databases(databases: Databases, extra: str, where: str) -> Dbc:
    """Read the files of a channel map, those of each bus by itself. Raises as `read_dbc`."""
    general = read_dbc(databases.files, extra, where)
    notes, buses = [*general.notes], {}
    for bus, files in databases.buses:
        own = read_dbc(files, extra, where)
        buses[bus] = own.messages
        notes += [f"bus {bus}: {note}" for note in own.notes]
    if databases.sources is not None:
        names = ", ".join(f"{source:#04x}" for source in databases.sources) or "any address"
        notes.append(
            f"J1939: frames are found by their parameter group, from {names}; messages of more "
            "than 8 bytes, which take several frames, are not read"
        )
    return Dbc(general.messages, tuple(notes), buses, databases.sources)


def read_dbc(files: Sequence[DatabaseFile], extra: str, where: str) -> Dbc:
    """Read DBC, ARXML, KCD and SYM files; ``extra`` of the package installs cantools.

    Raises ChannelMapError for a file that is missing or not valid, or lacks the bus, and for an
    identifier that is described twice.
    """
    cantools: Any = need("cantools", extra, where)
    logging.getLogger("cantools").setLevel(logging.CRITICAL + 1)  # what it warns of is refused here
    messages: dict[Key, Described] = {}
    notes = []
    for file in files:
        content, found, flaws = _load(cantools, file.path)
        for message in _of_bus(found, file):
            key = (message.frame_id, message.is_extended_frame)
            if key in messages:
                raise _described_twice(message, messages[key], file.path)
            messages[key] = message
        name = file.path.name + (f", bus {file.bus}" if file.bus else "")
        digest = hashlib.sha256(content).hexdigest()
        notes.append(f"frames decoded by {name} (SHA-256 {digest[:16]})")
        notes += [f"{name}: {flaw}" for flaw in flaws]
    return Dbc(messages, tuple(notes))


def _load(cantools: Any, path: Path) -> "tuple[bytes, list[Described], list[str]]":
    kind = path.suffix[1:].lower()
    kind = kind if kind in _FORMATS else "dbc"
    name = kind.upper()
    content = bytes_of(path, DBC, ChannelMapError, f"a {name}")
    text = _text(content)
    if kind in ("dbc", "sym"):  # the others are XML, whose parser takes no more than their size
        _refuse_long_text(text, path)
    try:
        if kind == "dbc":
            messages, flaws = read_by_message(cantools, text, str(path))
        else:
            found = cantools.database.load_string(text, database_format=kind, strict=True)
            messages, flaws = found.messages, []
    except Exception as cause:  # cantools raises many kinds, some of its parser's
        raise ChannelMapError(
            f"not a valid {name}: {cause}", where=path, expected=f"the format {name}"
        ) from cause
    if all(isinstance(message, Flawed) for message in messages):
        why = [f", as {m.name}: {m.why}" for m in messages[:1] if isinstance(m, Flawed)]
        what = f"not a valid {name}: no message that can be read{''.join(why)}"
        raise ChannelMapError(what, where=path, expected="the messages of a bus")
    return content, messages, flaws


def _text(content: bytes) -> str:
    """In UTF-8, UTF-16, or Windows-1252, which with a sign past ASCII is hardly ever UTF-8, too."""
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return content.decode("utf-16", errors="replace")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("cp1252", errors="replace")


def _refuse_long_text(text: str, path: Path) -> None:
    """cantools takes 300 bytes for each character of a text in quotes."""
    quoted = text.replace('\\"', "''").split('"')[1::2]
    longest = max(map(len, quoted), default=0)
    if longest > _LONGEST_TEXT:
        raise ChannelMapError(
            f"a text in quotes has {longest} characters",
            where=path,
            expected=f"at most {_LONGEST_TEXT}",
            do="is a quote missing?",
        )


def _of_bus(messages: "list[Described]", file: DatabaseFile) -> "list[Described]":
    if file.bus is None:
        return messages
    found = [message for message in messages if message.bus_name == file.bus]
    if not found:
        names = sorted({message.bus_name for message in messages if message.bus_name})
        raise ChannelMapError(
            f"the file has no messages of a bus {file.bus!r}",
            where=file.path,
            expected=f"one of {', '.join(map(repr, names))}" if names else "no bus: it names none",
        )
    return found


def _described_twice(one: "Described", other: "Described", path: Path) -> ChannelMapError:
    names = [f"{m.name} (bus {m.bus_name})" if m.bus_name else m.name for m in (one, other)]
    entry = f'{{file = "{path.name}", bus = "{one.bus_name}"}}'
    return ChannelMapError(
        f"{names[0]} has the identifier {one.frame_id:#x} of {names[1]}",
        where=path,
        expected="one description of each frame",
        do=f"name the DBC of one bus, or one bus for each of the log, as in dbc = {{1 = {entry}}}",
    )
