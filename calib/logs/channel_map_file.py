"""A channel map as a TOML file: `brake-cal manual logs` shows each key."""

import codecs
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import AfterValidator, Field, ValidationError, WrapValidator, model_validator

from calib.base.errors import ChannelMapError
from calib.base.names import CHANNELS, TRUTH
from calib.base.record import FileSchema, OneOf, QuantityMark, Section, by_name, read_toml
from calib.base.record_errors import wrong
from calib.base.toml import shortened
from calib.base.units import UnknownUnit, unit_of
from calib.logs.channel_map import ChannelMap, Mapping
from calib.logs.text.dialect import SEPARATORS, TextFormat

_Name = Annotated[str, Field(pattern=r"\S")]


def _expecting(form: str) -> WrapValidator:
    """Return a validator whose error for any wrong value says that ``form`` was expected."""

    def validate(written: object, handler: Callable[[object], object]) -> object:
        with suppress(ValidationError):
            if not isinstance(written, bool):  # pydantic would take true for 1
                return handler(written)
        raise wrong(shortened(written), form)

    return WrapValidator(validate)


def _refuse_truth(name: str) -> str:
    if name.startswith(TRUTH):
        raise wrong(f"{name!r} is a truth channel", "a measured column; truth only serves to score")
    return name


def _refuse_zero(factor: float) -> float:
    if factor == 0:
        raise wrong("0 would make every value 0", "a factor")
    return factor


class _MappingSection(Section):
    """One channel; its keys are those of `Mapping`."""

    source: Annotated[_Name, AfterValidator(_refuse_truth)]
    unit: str | None = None
    sign: Annotated[Literal[1, -1], _expecting("1 or -1 (use scale for factors)")] = 1
    scale: Annotated[float, QuantityMark("1"), AfterValidator(_refuse_zero)] = 1.0
    offset: Annotated[float, QuantityMark("1")] = 0.0
    delay: Annotated[float, QuantityMark("s")] = 0.0


_ChannelsSection = by_name(
    "_ChannelsSection",
    dict.fromkeys(CHANNELS, _MappingSection),
    "The mapped channels by canonical name.",
)

_SAMPLE = "time [s],p_mc [bar]\n0.005,-1.5e3\n"  # an encoding that can hold this can hold logs
_NOT_FOR_LOGS = ("punycode", "idna", "unicode-escape", "raw-unicode-escape", "utf-7")
"""Python's codecs for domain names and source code; some of them take quadratic time."""


def _refuse_unusable_encoding(name: str) -> str:
    with suppress(LookupError, ValueError, TypeError):
        is_for_text = codecs.lookup(name).name not in _NOT_FOR_LOGS
        if is_for_text and _SAMPLE.encode(name).decode(name) == _SAMPLE:
            return name
    expected = 'an encoding such as "utf-8" or "latin-1"'
    raise wrong(f"unknown encoding of text {shortened(name)}", expected)


class _TextSection(Section):
    """Format of a text table; needed only where the file leaves it open."""

    separator: Annotated[str, OneOf(tuple(SEPARATORS))] | None = None
    decimal: Annotated[str, OneOf((".", ","))] | None = None
    encoding: Annotated[str, AfterValidator(_refuse_unusable_encoding)] | None = None


_FIRST_FIT = Field(union_mode="left_to_right")  # of several types the first that fits is taken
_Databases = Annotated[_Name | list[_Name], _FIRST_FIT]
_DatabasesByBus = Annotated[dict[_Name, _Databases], Field(min_length=1)]
_DBC_FORM = (
    "the path of a DBC file (or ARXML, KCD, SYM), or a list of them; or these for each bus by its "
    "number or name"
)


class ChannelMapFile(FileSchema):
    """Which columns of a foreign log are channels, with their units and signs."""

    channels: _ChannelsSection | None = None  # type: ignore[valid-type]
    text: _TextSection | None = None
    ignore: Annotated[list[_Name], _expecting("a list of names of columns")] | None = None
    dbc: Annotated[_Databases | _DatabasesByBus, _FIRST_FIT, _expecting(_DBC_FORM)] | None = None

    @model_validator(mode="after")
    def _refuse_empty(self) -> Self:
        keys = self.model_fields_set - {"schema_version"}
        if not keys:  # the error names the key that most maps have
            raise wrong("key 'channels' is missing", "a value for 'channels'")
        return self


def read_channel_map(path: Path) -> ChannelMap:
    """Read a channel map. Raises one ChannelMapError that lists all its mistakes."""
    path = Path(path)
    file = read_toml(path, ChannelMapFile, ChannelMapError)
    entries: dict[str, Section] = dict(file.channels.entries()) if file.channels else {}
    channels = {name: Mapping(**dict(entry)) for name, entry in entries.items()}
    for name, mapping in channels.items():
        try:
            unit_of(mapping.unit or CHANNELS[name].unit, CHANNELS[name].si)
        except UnknownUnit as cause:
            raise ChannelMapError(str(cause), where=f"{path}: channels.{name}.unit") from cause
    by_bus = file.dbc if isinstance(file.dbc, dict) else {"": file.dbc or []}
    databases = {}
    for bus, files in by_bus.items():
        names = [files] if isinstance(files, str) else files
        databases[bus.strip()] = tuple((path.parent / name).absolute() for name in names)
    text = TextFormat(**dict(file.text or _TextSection()))
    return ChannelMap(str(path), channels, text, tuple(file.ignore or ()), databases)
