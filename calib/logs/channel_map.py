"""A channel map: which column of a foreign log is which channel, with unit and sign.

schema = 1
dbc = "chassis.dbc"           # optional: what is in the frames of a bus; relative to this file
ignore = ["p_rl"]             # optional: columns that are not what their name says

[channels.p_mc]
source = "Brake pressure"     # the column's name in the log
unit = "kPa"                  # optional: overrides the header's
sign = 1                      # optional: -1 turns the channel round
scale = 1.0                   # optional: value = sign * (scale * written + offset), in `unit`
offset = 0.0
method = "linear"             # optional, for logs of several rasters: or "hold"

[text]                        # optional: how a text table is written, where that is not certain
separator = ";"
decimal = ","
encoding = "latin-1"
"""

import codecs
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from calib.errors import ChannelMapError
from calib.logs.source import Array
from calib.logs.text.dialect import LOOKED, SEPARATORS, TextFormat
from calib.names import CHANNELS
from calib.toml import check_keys, quantity, read_toml
from calib.units import UnknownUnit, to_si, unit_of

SCHEMA = 1
KEYS = ("source", "unit", "sign", "scale", "offset", "method")
METHODS = ("linear", "hold")


@dataclass(frozen=True)
class Mapping:
    """One channel's origin.

    Attributes
    ----------
    source : name of the column, as the file has it without its unit.
    unit : unit of the values after scale and offset; None takes the header's.
    sign, scale, offset : value = sign * (scale * written + offset).
    method : what it is between its samples, one of `METHODS`; None lets the file say.
    """

    source: str
    unit: str | None = None
    sign: int = 1
    scale: float = 1.0
    offset: float = 0.0
    method: str | None = None

    def to_si(self, written: Array, unit: str, si: str) -> Array:
        """Values in SI, shape (n,), from what the file holds. Raises UnknownUnit."""
        return to_si(self.sign * (self.scale * written + self.offset), unit, si)


@dataclass(frozen=True)
class ChannelMap:
    """The mapped channels by canonical name, and the file they came from.

    ``text`` says how a text table is written; columns in ``ignore`` are not taken by their name;
    ``dbc`` files say what is in the frames of a bus.
    """

    where: str
    channels: dict[str, Mapping]
    text: TextFormat = LOOKED
    ignore: tuple[str, ...] = ()
    dbc: tuple[Path, ...] = ()


def read_channel_map(path: Path) -> ChannelMap:
    """Read a channel map.

    Raises ChannelMapError for a file that is missing or not TOML, an unknown channel or key, a
    source that is a truth channel, an unknown unit, or a sign other than 1 and -1.
    """
    path = Path(path)
    table = read_toml(path, SCHEMA, ChannelMapError)
    needed = () if {"text", "ignore", "dbc"} & set(table) else ("channels",)
    check_keys(table, ("channels", "text", "ignore", "dbc"), needed, path, ChannelMapError)
    where = f"{path}: channels"
    channels = check_keys(table.get("channels", {}), tuple(CHANNELS), (), where, ChannelMapError)
    mapped = {name: _mapping(name, entry, where) for name, entry in channels.items()}
    text = _text(table.get("text", {}), f"{path}: text")
    ignore = _ignore(table.get("ignore", []), f"{path}: ignore")
    return ChannelMap(str(path), mapped, text, ignore, _dbc(table.get("dbc", []), path))


def _dbc(written: object, path: Path) -> tuple[Path, ...]:
    """The DBC files, absolute: one name or a list of them, relative to the map."""
    names = [written] if isinstance(written, str) else written
    if not isinstance(names, list) or not all(isinstance(n, str) and n.strip() for n in names):
        raise ChannelMapError(
            f"dbc {written!r}", where=path, expected="the path of a DBC file, or a list of them"
        )
    return tuple((path.parent / name).absolute() for name in names)


def _ignore(entry: object, where: str) -> tuple[str, ...]:
    if not isinstance(entry, list) or not all(isinstance(name, str) for name in entry):
        raise ChannelMapError(f"{entry!r}", where=where, expected="a list of names of columns")
    return tuple(entry)


def _text(entry: object, where: str) -> TextFormat:
    values = dict(
        check_keys(entry, ("separator", "decimal", "encoding"), (), where, ChannelMapError)
    )
    for key, known in (("separator", tuple(SEPARATORS)), ("decimal", (".", ","))):
        if key in values and values[key] not in known:
            raise ChannelMapError(
                f"{key} {values[key]!r}",
                where=where,
                expected=f"one of {', '.join(repr(k) for k in known)}",
            )
    try:
        codecs.lookup(str(values.get("encoding", "utf-8")))
    except LookupError as cause:
        raise ChannelMapError(
            str(cause), where=where, expected='an encoding such as "utf-8" or "latin-1"'
        ) from cause
    return TextFormat(**values)


def _mapping(name: str, entry: object, where: str) -> Mapping:
    where = f"{where}.{name}"
    values = dict(check_keys(entry, KEYS, ("source",), where, ChannelMapError))
    _check_source(values["source"], where)
    _check_unit(values.get("unit"), name, where)
    if values.get("sign", 1) not in (1, -1) or isinstance(values.get("sign"), bool):
        raise ChannelMapError(
            f"sign {values['sign']!r}", where=where, expected="1 or -1 (use scale for factors)"
        )
    if values.get("method", METHODS[0]) not in METHODS:
        raise ChannelMapError(
            f"method {values['method']!r}", where=where, expected=f"one of {', '.join(METHODS)}"
        )
    for key in ("scale", "offset"):
        if key in values:
            values[key] = quantity(values[key], "1", f"{where}.{key}", ChannelMapError)
    if values.get("scale") == 0:
        raise ChannelMapError(
            "scale 0 would wipe the channel out", where=where, expected="a factor"
        )
    return Mapping(**values)


def _check_source(source: Any, where: str) -> None:
    if not isinstance(source, str) or not source.strip():
        raise ChannelMapError(
            f"source {source!r}", where=where, expected="the name of a column of the log"
        )
    if source.startswith("true_"):
        raise ChannelMapError(
            f"source {source!r} is a truth channel",
            where=where,
            expected="a measured column; truth only serves to score",
        )


def _check_unit(unit: Any, name: str, where: str) -> None:
    if unit is None:
        return
    try:
        unit_of(str(unit), CHANNELS[name].si)
    except UnknownUnit as cause:
        raise ChannelMapError(str(cause), where=f"{where}.unit") from cause
