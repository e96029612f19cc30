"""What a file may hold, as pydantic models; all errors of a file come in one message of ours.

    class Pads(Section):                                       [pads]
        front: Annotated[float, Quantity("1", 0.02, 1.0)]      front = 0.38

    class ModelFile(FileSchema):                               schema = 1
        pads: Pads

pydantic is loaded with this module. Only the ``..._file.py`` of a room imports it, and what
computes imports neither.
"""

import math
import re
from collections.abc import Collection, ItemsView, Iterator, Mapping
from dataclasses import dataclass, is_dataclass
from pathlib import Path
from types import UnionType
from typing import (
    Annotated,
    Any,
    ClassVar,
    Literal,
    TypeVar,
    Union,
    get_args,
    get_origin,
    get_type_hints,
)

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    PrivateAttr,
    ValidationError,
    ValidatorFunctionWrapHandler,
    create_model,
    model_validator,
)
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue
from pydantic_core import CoreSchema, ErrorDetails, PydanticCustomError, core_schema

from calib.errors import BrakeCalError, InputError
from calib.toml import NUMBER, did_you_mean, load_toml, nearest, quantity
from calib.units import spellings

S = TypeVar("S", bound="Section")
SHOWN = 60
"""Characters of a wrong value that a message shows."""


class Section(BaseModel):
    """A table of a file: it knows all its keys, and takes no value of another type."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)

    written_as: ClassVar[str] = ""
    """What a message says is expected in place of a value that is no table; its name by default."""


def wrong(what: str, expected: str = "", do: str = "") -> PydanticCustomError:
    """Return what a validator raises: what came, what was expected, what to do."""
    return PydanticCustomError("wrong", "{what}", {"what": what, "expected": expected, "do": do})


def _number(version: object) -> object:
    """The version of a schema; true is not one, though Python takes it as 1."""
    if isinstance(version, bool):
        raise wrong(f"{version}", "a number")
    return version


class FileSchema(Section):
    """A whole file, with the version of its schema."""

    schema_version: Annotated[Literal[1], BeforeValidator(_number)] = Field(alias="schema")


class ByName(Section):
    """A table of which every key may be left out; `entries` come in the order of the file."""

    _order: tuple[str, ...] = PrivateAttr(())

    @model_validator(mode="wrap")
    @classmethod
    def _keep_order(cls, data: Any, handler: ValidatorFunctionWrapHandler) -> "ByName":
        section: ByName = handler(data)
        section._order = tuple(data)
        return section

    def entries(self) -> ItemsView[str, Any]:
        """Name and value of each entry, as the file has them."""
        return {name: getattr(self, name) for name in self._order}.items()


def by_name(title: str, entries: Mapping[str, Any], about: str) -> type[ByName]:
    """Return the schema of a table from the type of each possible entry."""
    fields: dict[str, Any] = {name: (kind | None, None) for name, kind in entries.items()}
    return create_model(title, __base__=ByName, __doc__=about, **fields)


@dataclass(frozen=True)
class Quantity:
    """Marks a float of a file: written with a unit, kept in SI, believable from low to high.

    ``si`` None takes any quantity; "1" is a plain number or a percentage. Bounds in SI.
    """

    si: str | None
    low: float = -math.inf
    high: float = math.inf

    def read(self, written: object) -> float:
        """Value [SI]. Raises `wrong` for what is no such quantity or not believable."""
        try:
            value = quantity(written, self.si, None, InputError)
        except InputError as cause:
            raise wrong(cause.what, cause.expected, cause.do) from cause
        if not self.low <= value <= self.high:
            raise wrong(
                f"{value:g}{self._unit} is not believable",
                self._range,
                "check the sign, the unit and the decimal point",
            )
        return value

    @property
    def _unit(self) -> str:
        return "" if self.si in ("1", None) else f" {self.si}"

    @property
    def _range(self) -> str:
        return f"{self.low:g} to {self.high:g}{self._unit}"

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(
        self, core: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        number: JsonSchemaValue = {"type": "number"}
        if math.isfinite(self.low):
            number["minimum"] = self.low
        if math.isfinite(self.high):
            number["maximum"] = self.high
        text: JsonSchemaValue = {"type": "string", "pattern": quantity_pattern(self.si)}
        bounded = {"description": self._range} if math.isfinite(self.high) else {}
        if self.si in ("1", None):
            return {"anyOf": [number, text]} | bounded
        return text | bounded | {"examples": [f"1.5 {self.si}"]}


def quantity_pattern(*si: str | None) -> str:
    """A written quantity of one of these SI units as a regular expression; None for any."""
    units = "|".join(_unit_pattern(unit) for one in si for unit in spellings(one))
    may_be_left_out = "?" if {"1", None} & set(si) else ""
    return rf"^\s*{NUMBER}\s*(?:{units}){may_be_left_out}\s*$"


def _unit_pattern(unit: str) -> str:
    """A unit as a regular expression: raised and multiplied in all the ways that are read."""
    return re.escape(unit).replace(r"\*", "[*·⋅×]").replace(r"\^2", r"(?:\^2|\*\*2|²)")


@dataclass(frozen=True)
class OneOf:
    """Marks a value of a file that must be one of ``known``."""

    known: tuple[str, ...]

    def read(self, written: object) -> Any:
        """The value itself. Raises `wrong` for any other."""
        if not isinstance(written, str) or written not in self.known:
            raise wrong(
                _shown(written),
                f"one of {', '.join(map(repr, self.known))}",
                did_you_mean(written, self.known) if isinstance(written, str) else "",
            )
        return written

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(
        self, core: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        return {"enum": list(self.known)}


def quantities(section: type[Section]) -> dict[str, Quantity]:
    """Return SI unit and bounds of each field of a section that holds a quantity."""
    return {
        name: mark
        for name, field in section.model_fields.items()
        for mark in field.metadata
        if isinstance(mark, Quantity)
    }


def read_toml(path: Path, schema: type[S], error: type[InputError]) -> S:
    """Read a TOML file of a schema.

    Raises ``error`` if there is no such file, if it is not TOML or of another version of the
    schema; else with all that is wrong in it.
    """
    return validated(load_toml(path, error), schema, path, error)


def validated(document: object, schema: type[S], where: object, error: type[BrakeCalError]) -> S:
    """Check a document of plain values. Raises ``error`` with all that is wrong in it."""
    try:
        return schema.model_validate(document)
    except ValidationError as cause:
        raise _as_one(cause, schema, where, error) from cause


def validated_json(data: bytes, schema: type[S], where: object, error: type[BrakeCalError]) -> S:
    """Check a JSON document. Raises ``error`` for what is not JSON, or with all that is wrong."""
    try:
        return schema.model_validate_json(data)
    except ValidationError as cause:
        raise _as_one(cause, schema, where, error) from cause


def json_schema(schema: type[Section]) -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of what a file may hold."""
    return {
        "$schema": GenerateJsonSchema.schema_dialect,
        **schema.model_json_schema(schema_generator=_WithoutNull),
    }


class _WithoutNull(GenerateJsonSchema):
    """TOML has no null: what may be left out is left out."""

    def nullable_schema(self, schema: core_schema.NullableSchema) -> JsonSchemaValue:
        return self.generate_inner(schema["schema"])

    def default_schema(self, schema: core_schema.WithDefaultSchema) -> JsonSchemaValue:
        if schema.get("default") is None:
            return self.generate_inner(schema["schema"])
        return super().default_schema(schema)


# From pydantic's errors to ours.

_EXPECTED = {
    "string_type": "text in quotes",
    "bool_type": "true or false",
    "float_type": "a number",
    "finite_number": "a finite number",
    "int_type": "a whole number",
    "list_type": "a list",
    "tuple_type": "a list",
}
_NO_TABLE = ("model_type", "dict_type", "dataclass_type", "model_attributes_type")
_MISSING = ("missing", "missing_argument", "missing_keyword_only_argument")
_UNKNOWN = ("extra_forbidden", "unexpected_keyword_argument")


def _as_one(
    cause: ValidationError, schema: type[Section], where: object, error: type[BrakeCalError]
) -> BrakeCalError:
    """One error of ours that says all that is wrong in a file."""
    details = cause.errors(include_url=False)
    version = [d for d in details if d["loc"] and d["loc"][-1] == "schema"]
    meant = {
        (d["loc"][:-1], nearest(str(d["loc"][-1]), known)) for d, known in _unknown(details, schema)
    }
    parts = [
        _parts(detail, schema)
        for detail in version or details
        # A misspelt key is also a missing one, and the spelling is the thing to mend.
        if not (detail["type"] in _MISSING and (detail["loc"][:-1], detail["loc"][-1]) in meant)
    ]
    if len(parts) == 1:
        place, what, expected, do = parts[0]
        at = ": ".join(str(part) for part in (where, place) if part)
        return error(what, where=at or None, expected=expected, do=do)
    lines = [str(error(w, where=place or None, expected=e, do=d)) for place, w, e, d in parts]
    return error("\n  ".join([f"{len(lines)} errors", *lines]), where=where)


def _parts(detail: ErrorDetails, schema: type[Section]) -> tuple[str, str, str, str]:
    """Key path, what came, what was expected, what to do."""
    kind, loc, given = detail["type"], detail["loc"], detail["input"]
    here, above = _path(loc), _path(loc[:-1])
    if loc and loc[-1] == "schema":
        if kind in _MISSING:
            return above, "no schema", "a line 'schema = 1' at the top", ""
        return above, f"schema {_shown(given)}", "schema = 1", ""
    if kind == "wrong":
        context = detail["ctx"]
        return here, context["what"], context["expected"], context["do"]
    if kind == "json_invalid":
        return "", f"not JSON ({detail['ctx']['error']})", "", ""
    if kind == "literal_error":
        return here, _shown(given), detail["ctx"]["expected"], ""
    if kind in _MISSING:
        return above, f"key {loc[-1]!r} is missing", f"a value for {loc[-1]!r}", ""
    if kind in _UNKNOWN:
        known = _keys(schema, loc[:-1])
        hint = did_you_mean(str(loc[-1]), known)
        return above, f"unknown key {loc[-1]!r}", "" if hint else f"one of {', '.join(known)}", hint
    if kind in _NO_TABLE:
        written_as = getattr(_kind_at(schema, loc), "written_as", "") or (here and f"[{here}]")
        return here, f"{_shown(given)} is not a table", written_as, ""
    if kind == "list_type" and _is_section(_inner(_kind_at(schema, loc))):
        return here, _shown(given), f"[[{here}]] with double brackets", ""
    return here, _shown(given), _EXPECTED.get(kind, detail["msg"]), ""


def _unknown(
    details: list[ErrorDetails], schema: type[Section]
) -> Iterator[tuple[ErrorDetails, Collection[str]]]:
    for detail in details:
        if detail["type"] in _UNKNOWN:
            yield detail, _keys(schema, detail["loc"][:-1])


def _path(loc: tuple[int | str, ...]) -> str:
    """``surfaces[0].start``."""
    text = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in loc)
    return text.removeprefix(".")


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= SHOWN else f"{text[:SHOWN]}..."


def _keys(schema: type[Section], loc: tuple[int | str, ...]) -> list[str]:
    """The keys that the table at ``loc`` may have."""
    kind = _kind_at(schema, loc)
    if _is_section(kind):
        return [field.alias or name for name, field in kind.model_fields.items()]
    return list(get_type_hints(kind)) if is_dataclass(kind) else []


def _kind_at(schema: type[Section], loc: tuple[int | str, ...]) -> Any:
    """The type that a schema gives to the place ``loc``."""
    kind: Any = schema
    for key in loc:
        if _is_section(kind):
            kind = kind.model_fields[str(key)].annotation
        elif is_dataclass(kind):
            kind = get_type_hints(kind)[str(key)]
        else:
            kind = _inner(kind)
        kind = _plain(kind)
    return kind


def _plain(kind: Any) -> Any:
    """A type without ``Annotated`` and without None."""
    if get_origin(kind) is Annotated:
        return _plain(get_args(kind)[0])
    if get_origin(kind) in (Union, UnionType):
        return _plain(next(a for a in get_args(kind) if a is not type(None)))
    return kind


def _inner(kind: Any) -> Any:
    """What a list or dict holds."""
    held = [a for a in get_args(kind) if a is not Ellipsis]
    return _plain(held[-1]) if held else None


def _is_section(kind: Any) -> bool:
    return isinstance(kind, type) and issubclass(kind, BaseModel)
