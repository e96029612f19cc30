"""A channel map as a TOML file.

schema = 1
dbc = "chassis.dbc"           # optional: describes the frames of a bus (DBC, ARXML, KCD or SYM);
                              # relative to this file; or a list, or one for each bus of the log:
                              # dbc = {1 = "chassis.dbc", 2 = ["drive.arxml", "brakes.kcd"]};
                              # one bus of a file that has several, by its name in the file:
                              # dbc = {1 = {file = "car.kcd", bus = "Chassis"}}
j1939 = "any"                 # optional: find J1939 frames by their parameter group, from any
                              # source address, or from these: j1939 = [0x0B, 0x21]
ignore = ["p_rl"]             # optional: columns that have the name of a channel and are not used

[channels.p_mc]
source = "Brake pressure"     # the column's name in the log
unit = "kPa"                  # optional: overrides the header's
sign = 1                      # optional: -1 reverses the sign of the channel
scale = 1.0                   # optional: value = sign * (scale * written + offset), in `unit`
offset = 0.0
method = "linear"             # optional, for logs with several sample rates; or "hold"

[text]                        # optional: format of a text table, if it is ambiguous
separator = ";"
decimal = ","
encoding = "latin-1"
"""

import codecs
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, BeforeValidator, Field, WithJsonSchema, model_validator

from calib.base.errors import ChannelMapError
from calib.base.names import CHANNELS
from calib.base.record import (
    FileSchema,
    OneOf,
    QuantityMark,
    Section,
    by_name,
    read_toml,
    section,
)
from calib.base.record_errors import wrong
from calib.base.toml import shown
from calib.base.units import UnknownUnit, spellings, unit_of
from calib.logs.channel_map import METHODS, ChannelMap, DatabaseFile, Databases, Mapping
from calib.logs.text.dialect import SEPARATORS, TextFormat


def _source(name: object) -> str:
    if not isinstance(name, str) or not name.strip():
        raise wrong(f"{name!r}", "the name of a column of the log")
    if name.startswith("true_"):
        raise wrong(f"{name!r} is a truth channel", "a measured column; truth only serves to score")
    return name


def _sign(written: object) -> object:
    if written not in (1, -1) or isinstance(written, bool):
        raise wrong(f"{written!r}", "1 or -1 (use scale for factors)")
    return int(written)


def _scale(factor: float) -> float:
    if factor == 0:
        raise wrong("0 would make every value 0", "a factor")
    return factor


class _MappingSection(Section):
    """Source of a channel; as `Mapping`."""

    source: Annotated[str, BeforeValidator(_source)]
    unit: str | None = None
    sign: Annotated[Literal[1, -1], BeforeValidator(_sign)] = 1
    scale: Annotated[float, QuantityMark("1"), AfterValidator(_scale)] = 1.0
    offset: Annotated[float, QuantityMark("1")] = 0.0
    method: Annotated[str, OneOf(METHODS)] | None = None


def _mapping_in(si: str) -> type[_MappingSection]:

    def known(unit: str) -> str:
        try:
            unit_of(unit, si)
        except UnknownUnit as cause:
            raise wrong(str(cause)) from cause
        return unit

    examples = WithJsonSchema({"type": "string", "examples": spellings(si)})
    unit: Any = Annotated[str, AfterValidator(known), examples]
    title, about = f"_MappingSection[{si}]", f"Source of a channel in {si}."
    made: type[_MappingSection] = section(title, about, {"unit": (unit, None)}, _MappingSection)
    return made


_MAPPINGS = {si: _mapping_in(si) for si in sorted({q.si for q in CHANNELS.values()})}
_ChannelsSection = by_name(
    "_ChannelsSection",
    {name: _MAPPINGS[q.si] for name, q in CHANNELS.items()},
    "The mapped channels by canonical name.",
)


_SAMPLE = "time [s],p_mc [bar]\n0.005,-1.5e3\n"
_NOT_OF_FILES = ("punycode", "idna", "unicode-escape", "raw-unicode-escape", "utf-7")
"""Codecs of names and of source code; some take quadratic time."""


def _encoding(name: str) -> str:
    known = 'an encoding such as "utf-8" or "latin-1"'
    try:
        # Only what is one character for each: hex and zlib are codecs, too, but not of text.
        plain = _SAMPLE.encode(name).decode(name) == _SAMPLE
        found = codecs.lookup(name).name
    except (LookupError, ValueError, TypeError) as cause:
        raise wrong(f"unknown encoding {shown(name)}", known) from cause
    if not plain or found in _NOT_OF_FILES:
        raise wrong(f"{shown(name)} is no encoding of text files", known)
    return name


class _TextSection(Section):
    """Format of a text table, if it is ambiguous."""

    separator: Annotated[str, OneOf(tuple(SEPARATORS))] | None = None
    decimal: Annotated[str, OneOf((".", ","))] | None = None
    encoding: Annotated[str, AfterValidator(_encoding)] | None = None


def _columns(written: object) -> list[str]:
    if not isinstance(written, list) or not all(isinstance(n, str) and n.strip() for n in written):
        raise wrong(f"{written!r}", "a list of names of columns")
    return written


_FILES = (
    "the path of a DBC file (or ARXML, KCD, SYM), or {file, bus} for one bus of it, or a list "
    "of them"
)


def _files(written: object) -> list[DatabaseFile]:
    """Files, relative to the map, or one bus of each."""
    found = []
    for one in written if isinstance(written, list) else [written]:
        parts: Any = {"file": one} if isinstance(one, str) else one
        known = isinstance(parts, dict) and set(parts) in ({"file"}, {"file", "bus"})
        if not known or not all(isinstance(x, str) and x.strip() for x in parts.values()):
            raise wrong(f"{one!r}", _FILES)
        found.append(DatabaseFile(Path(parts["file"]), parts.get("bus")))
    return found


def _databases(written: object) -> dict[str, list[DatabaseFile]]:
    """Files by bus; those for every bus have an empty name."""
    if not isinstance(written, dict) or set(written) == {"file", "bus"}:
        return {"": _files(written)}
    if not written or not all(bus.strip() for bus in written):
        raise wrong(f"{written!r}", f"{_FILES}, for each bus by its number or name")
    return {bus.strip(): _files(files) for bus, files in written.items()}


def _sources(written: object) -> list[int]:
    """Source addresses; an empty list for any."""
    if written == "any":
        return []
    good = isinstance(written, list) and written and all(type(n) is int for n in written)
    if not good or not all(0 <= n <= _HIGHEST_SOURCE for n in written):  # type: ignore[attr-defined]
        raise wrong(f"{written!r}", '"any", or a list of source addresses from 0 to 253')
    return written  # type: ignore[return-value]


_HIGHEST_SOURCE = 253
"""Highest source address of a J1939 message; 254 and 255 stand for none and for all."""

_TEXT: dict[str, Any] = {"type": "string", "minLength": 1}
_LIST: dict[str, Any] = {"type": "array", "items": _TEXT}
_ONE_BUS: dict[str, Any] = {
    "type": "object",
    "properties": {"file": _TEXT, "bus": _TEXT},
    "required": ["file"],
    "additionalProperties": False,
}
_SEVERAL: dict[str, Any] = {"type": "array", "items": {"anyOf": [_TEXT, _ONE_BUS]}}
_OF_A_BUS = {"anyOf": [_TEXT, _ONE_BUS, _SEVERAL]}
_BUSES = {"type": "object", "minProperties": 1, "additionalProperties": _OF_A_BUS}
_BY_BUS: dict[str, Any] = {"anyOf": [_TEXT, _SEVERAL, _BUSES]}
_SOURCE = {"type": "integer", "minimum": 0, "maximum": _HIGHEST_SOURCE}
_ADDRESSES: dict[str, Any] = {
    "anyOf": [{"const": "any"}, {"type": "array", "minItems": 1, "items": _SOURCE}]
}


class ChannelMapFile(FileSchema):
    """The columns of a foreign log that are channels, with unit and sign."""

    channels: _ChannelsSection | None = None  # type: ignore[valid-type]
    text: _TextSection | None = None
    ignore: Annotated[list[str], BeforeValidator(_columns), WithJsonSchema(_LIST)] = Field(
        default_factory=list
    )
    dbc: Annotated[
        dict[str, list[DatabaseFile]], BeforeValidator(_databases), WithJsonSchema(_BY_BUS)
    ] = Field(default_factory=dict)
    j1939: Annotated[list[int], BeforeValidator(_sources), WithJsonSchema(_ADDRESSES)] | None = None

    @model_validator(mode="after")
    def _says_something(self) -> Self:
        if self.model_fields_set <= {"schema_version"}:
            raise wrong("key 'channels' is missing", "a value for 'channels'")
        return self


def read_channel_map(path: Path) -> ChannelMap:
    """Read a channel map.

    Raises ChannelMapError for a file that is missing or not TOML, an unknown channel or key, a
    source that is a truth channel, an unknown unit, or a sign other than 1 and -1.
    """
    path = Path(path)
    file = read_toml(path, ChannelMapFile, ChannelMapError)
    entries: dict[str, Section] = dict(file.channels.entries()) if file.channels else {}
    files = {
        bus: tuple(replace(one, path=(path.parent / one.path).absolute()) for one in several)
        for bus, several in file.dbc.items()
    }
    sources = None if file.j1939 is None else tuple(file.j1939)
    return ChannelMap(
        where=str(path),
        channels={name: Mapping(**dict(entry)) for name, entry in entries.items()},
        text=TextFormat(**dict(file.text or _TextSection())),
        ignore=tuple(file.ignore),
        databases=Databases(files.pop("", ()), tuple(files.items()), sources),
    )
