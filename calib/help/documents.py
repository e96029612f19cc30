"""JSON Schemas of the files that users write, and of the documents that commands print or write.

`files.csv` lists the files, each with the class that reads it; `documents.toml` has the documents:

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
"""JSON types by the words of `documents.toml`."""


@dataclass(frozen=True)
class Document:
    """A document: its ``title``, and "type: meaning" of each key of its first level.

    A key that ends in " ..." stands for several keys with this beginning, and is in no schema.
    """

    title: str
    keys: dict[str, str]

    @property
    def schema(self) -> dict[str, Any]:
        """JSON Schema of the document, draft 2020-12; further keys are allowed."""
        keys = {
            name: _value(*text.split(": ", 1))
            for name, text in self.keys.items()
            if not name.endswith(" ...")
        }
        return {
            "$schema": "https://json-schema.org/draft/2020-12/schema",
            "title": self.title,
            "type": "object",
            "properties": {"schema": {"const": 1}, **keys},
            "required": ["schema", *keys],
        }


def _value(words: str, meaning: str) -> dict[str, Any]:
    """Return the JSON Schema of a value of the type ``words``: "list of texts or null"."""
    container, _, items = words.removesuffix(" or null").partition(" of ")
    kind, can_be_null = _TYPES[container], words.endswith(" or null")
    schema: dict[str, Any] = {"type": [kind, "null"] if can_be_null else kind}
    if items:
        schema["items"] = {"type": _TYPES[items.removesuffix("s")]}
    return schema | {"description": meaning}


@cache
def documents() -> dict[str, Document]:
    """Return every document, by the name of its schema."""
    written = Path(__file__).with_name("documents.toml").read_text(encoding="utf-8")
    return {name: Document(**section) for name, section in tomllib.loads(written).items()}


_FILES = {row["name"]: row for row in rows("files.csv", "calib.help")}
FILES = {name: row["content"] for name, row in _FILES.items()}
"""Content of each kind of file, in words."""


def section(name: str) -> "type[Section]":
    """Return the class that reads a kind of file; that of limits is made from all metrics."""
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
    """Return the names of all schemas, of files and of documents."""
    return [*FILES, *documents()]


def schema_of(name: str) -> dict[str, Any]:
    """Return the JSON Schema of a kind of file, or of a document."""
    from calib.base.record import json_schema

    return json_schema(section(name)) if name in FILES else documents()[name].schema
