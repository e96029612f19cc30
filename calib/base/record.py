"""Schemas of TOML and JSON files as pydantic models: left the model, right a file.

    class PadsSection(Section):                                [pads]
        front: Annotated[float, QuantityMark("1", 0.02, 1.0)]  front = 0.38

    class ModelFile(FileSchema):                               schema = 1
        pads: PadsSection

All mistakes in a file are reported in one message. A model gives a JSON Schema, too.
"""

import math
from collections.abc import ItemsView, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, Literal, TypeVar

import pydantic
from pydantic import BaseModel, ConfigDict, Field, ValidationError
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from calib.base.errors import BrakeCalError, InputError
from calib.base.record_errors import one_error, wrong
from calib.base.toml import did_you_mean, load_toml, quantity, shortened
from calib.base.units import unit_suffix

S = TypeVar("S", bound="Section")


class Section(BaseModel):
    """A table of a file. Unknown keys and values of another type are errors."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)

    written_as: ClassVar[str] = ""
    """How users write the table, for a message; if empty, as ``[name]``."""


class FileSchema(Section):
    """A file, whose key ``schema`` is the version of its schema."""

    schema_version: Literal[1] = Field(alias="schema")


class ByName(Section):
    """A table in which every key is optional, and which keeps the order of the file."""

    _order: tuple[str, ...] = pydantic.PrivateAttr(())

    @pydantic.model_validator(mode="wrap")
    @classmethod
    def _keep_order(cls, data: Any, handler: pydantic.ValidatorFunctionWrapHandler) -> "ByName":
        table: ByName = handler(data)
        table._order = tuple(data)
        return table

    def entries(self) -> ItemsView[str, Any]:
        """Name and value of each entry, in the order of the file."""
        return {name: getattr(self, name) for name in self._order}.items()


def section(
    title: str, about: str, keys: Mapping[str, tuple[Any, Any]], base: type[Section] = Section
) -> Any:
    """Return the schema of a table from the type and the default of each key.

    The default is None for an optional key, ``...`` for a required key. The ``title`` and what the
    table is ``about`` stand in the JSON Schema.
    """
    fields: dict[str, Any] = {}
    for name, (kind, default) in keys.items():
        fields[name] = (kind | None, None) if default is None else (kind, default)
    return pydantic.create_model(title, __base__=base, __doc__=about, **fields)


def by_name(title: str, entries: Mapping[str, Any], about: str) -> type[ByName]:
    """Return the schema of a table from the type of each possible entry, as in `section`."""
    keys = {name: (kind, None) for name, kind in entries.items()}
    schema: type[ByName] = section(title, about, keys, ByName)
    return schema


@dataclass(frozen=True)
class QuantityMark:
    """Marks a float of a file: written with a unit, read in SI, plausible from ``low`` to ``high``.

    The SI unit ``si`` is "1" for a plain number or a percentage, None for any quantity.
    """

    si: str | None
    low: float = -math.inf
    high: float = math.inf

    def read(self, written: object) -> float:
        """Return the value [SI]. Raises `wrong` for another quantity or an implausible value."""
        try:
            value = quantity(written, self.si, None, InputError)
        except InputError as cause:
            raise wrong(cause.problem, cause.expected, cause.do) from cause
        if not self.low <= value <= self.high:
            flaw = f"{value:g}{unit_suffix(self.si or '1')} is not believable"
            raise wrong(flaw, self._range, "check the sign, the unit and the decimal point")
        return value

    @property
    def _range(self) -> str:
        return f"{self.low:g} to {self.high:g}{unit_suffix(self.si or '1')}"

    def __get_pydantic_core_schema__(
        self, _: Any, handler: pydantic.GetCoreSchemaHandler
    ) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(
        self, core: CoreSchema, handler: pydantic.GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        bounded = {"description": self._range} if math.isfinite(self.high) else {}
        if self.si in ("1", None):
            return {"type": ["number", "string"]} | bounded
        return {"type": "string", "examples": [f"1.5 {self.si}"]} | bounded


@dataclass(frozen=True)
class OneOf:
    """Marks a value of a file that must be one of ``choices``."""

    choices: tuple[str, ...]

    def read(self, written: object) -> Any:
        """Return the value itself. Raises `wrong` for a value that is no choice."""
        if not isinstance(written, str) or written not in self.choices:
            hint = did_you_mean(written, self.choices) if isinstance(written, str) else ""
            raise wrong(shortened(written), f"one of {', '.join(map(repr, self.choices))}", hint)
        return written

    def __get_pydantic_core_schema__(
        self, _: Any, handler: pydantic.GetCoreSchemaHandler
    ) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(
        self, core: CoreSchema, handler: pydantic.GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        return {"enum": list(self.choices)}


def read_toml(path: Path, schema: type[S], error: type[InputError]) -> S:
    """Read a TOML file as a ``schema``. Raises one ``error`` with all mistakes in the file."""
    return validated(load_toml(path, error), schema, path, error)


def validated(document: object, schema: type[S], where: object, error: type[BrakeCalError]) -> S:
    """Return a document, plain values or the bytes of JSON, as a checked ``schema``.

    Raises one ``error`` with all mistakes, which calls the document ``where``.
    """
    try:
        if isinstance(document, bytes):
            return schema.model_validate_json(document)
        return schema.model_validate(document)
    except ValidationError as cause:
        raise one_error(cause, schema, where, error) from cause


def json_schema(schema: type[Section]) -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of a file."""
    return {
        "$schema": GenerateJsonSchema.schema_dialect,
        **schema.model_json_schema(schema_generator=_WithoutNull),
    }


class _WithoutNull(GenerateJsonSchema):
    """Generates JSON Schema without null: TOML leaves an optional key out."""

    def nullable_schema(self, schema: core_schema.NullableSchema) -> JsonSchemaValue:
        return self.generate_inner(schema["schema"])

    def default_schema(self, schema: core_schema.WithDefaultSchema) -> JsonSchemaValue:
        if schema.get("default") is None:
            return self.generate_inner(schema["schema"])
        return super().default_schema(schema)
