"""The documents that commands print or write, by `documents.toml`, as JSON Schemas.

[fit-json]
title = "brake-cal fit LOG... --json"
[fit-json.keys]
new = "true or false: false where the same content was stored already"
"""

import tomllib
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from calib.base.plain import rows

if TYPE_CHECKING:
    from calib.base.record import Section

_TYPES = {
    "text": "string",
    "number": "number",
    "whole number": "integer",
    "true or false": "boolean",
    "object": "object",
    "list": "array",
}
"""JSON type of a value, or of the items of a list, by the words of `documents.toml`."""
_SEVERAL = " ..."
"""End of a key that stands for all keys with this beginning."""


@dataclass(frozen=True)
class Document:
    """One document: its ``title``, and of each key of its first level "type: meaning"."""

    title: str
    keys: dict[str, str]

    @property
    def schema(self) -> dict[str, Any]:
        """Its JSON Schema, draft 2020-12; further keys are allowed."""
        values = {name: _value(*says.split(": ", 1)) for name, says in self.keys.items()}
        fixed = {name: one for name, one in values.items() if not name.endswith(_SEVERAL)}
        return {
            "$schema": "https://json-schema.org/draft/2020-12/schema",
            "title": self.title,
            "type": "object",
            "properties": {"schema": {"const": 1}, **fixed},
            "required": ["schema", *fixed],
        }


def _value(words: str, meaning: str) -> dict[str, Any]:
    """The JSON Schema of a value by the words of `documents.toml`."""
    bare = words.removesuffix(" or null")
    container, _, several = bare.partition(" of ")
    kind = _TYPES[container]
    items = {"items": {"type": _TYPES[several.removesuffix("s")]}} if several else {}
    return {"type": kind if bare == words else [kind, "null"], **items, "description": meaning}


@cache
def documents() -> dict[str, Document]:
    """Every document, by the name of its schema."""
    written = Path(__file__).with_name("documents.toml").read_text(encoding="utf-8")
    return {name: Document(**one) for name, one in tomllib.loads(written).items()}


_FILES = {row["name"]: row for row in rows("files.csv", "calib.help")}
FILES = {name: row["content"] for name, row in _FILES.items()}
"""Kinds of files, and their content."""


def section(name: str) -> "type[Section]":
    """The class of a kind of file."""
    from calib.estimation.limits_file import limits_schema
    from calib.estimation.metrics import METRICS as OF_STOPS
    from calib.line.gauge.study import KNOWN_LIMITS
    from calib.line.station.metrics import METRICS as OF_CAR

    module, _, kind = _FILES[name]["class"].partition(":")
    if not module:
        return limits_schema({*OF_STOPS, *OF_CAR, *KNOWN_LIMITS})
    file: type[Section] = getattr(import_module(f"calib.{module}"), kind)
    return file


def kinds() -> list[str]:
    """Every kind of file and document that has a schema."""
    return [*FILES, *documents()]


def schema_of(name: str) -> dict[str, Any]:
    """The JSON Schema of a file or a document."""
    from calib.base.record import json_schema

    return json_schema(section(name)) if name in FILES else documents()[name].schema
