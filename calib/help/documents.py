"""The documents that commands print or write, as the page `reference` has them, as JSON Schemas.

### `brake-cal fit LOG... --json`
Schema: `fit-json`.
| `new` | true or false | false where the same content was stored already |
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any

from calib.help.page import find

TYPES: dict[str, dict[str, Any]] = {
    "text": {"type": "string"},
    "number": {"type": "number"},
    "whole number": {"type": "integer"},
    "true or false": {"type": "boolean"},
    "object": {"type": "object"},
    "list": {"type": "array"},
    "list of text": {"type": "array", "items": {"type": "string"}},
    "list of numbers": {"type": "array", "items": {"type": "number"}},
    "list of objects": {"type": "array", "items": {"type": "object"}},
}
"""The words of the page for a type."""

OR_NULL = " or null"
SEVERAL = " ..."
"""End of a key that stands for several which begin alike."""

_PART = re.compile(r"^### (.+?)\n\nSchema: `([\w-]+)`(.*?)(?=^#|\Z)", re.MULTILINE | re.DOTALL)
_ROW = re.compile(r"^\| `(.+?)` \| (.+?) \| (.+) \|$", re.MULTILINE)


@dataclass(frozen=True)
class DocumentKey:
    """A key of a document: its ``type`` in the words of the page, and what it means."""

    name: str
    type: str
    meaning: str

    @property
    def schema(self) -> dict[str, Any]:
        """The JSON Schema of its value."""
        bare = self.type.removesuffix(OR_NULL)
        one = TYPES[bare]
        kind = [one["type"], "null"] if bare != self.type else one["type"]
        return {**one, "type": kind, "description": self.meaning}


@dataclass(frozen=True)
class Document:
    """One document: ``name`` of its schema, ``title``, and the keys of its first level."""

    name: str
    title: str
    keys: tuple[DocumentKey, ...]

    @property
    def schema(self) -> dict[str, Any]:
        """Its JSON Schema, draft 2020-12; further keys are allowed."""
        plain = {key.name: key.schema for key in self.keys if not key.name.endswith(SEVERAL)}
        several = {
            f"^{re.escape(key.name.removesuffix(SEVERAL))} ": key.schema
            for key in self.keys
            if key.name.endswith(SEVERAL)
        }
        return {
            "$schema": "https://json-schema.org/draft/2020-12/schema",
            "title": self.title,
            "type": "object",
            "properties": {"schema": {"const": 1}, **plain},
            **({"patternProperties": several} if several else {}),
            "required": ["schema", *plain],
        }


@cache
def documents() -> dict[str, Document]:
    """Every document of the page, by the name of its schema."""
    return {one.name: one for one in _read()}


def _read() -> Iterator[Document]:
    (page,) = find("reference")
    for title, name, rest in _PART.findall(page.text):
        keys = (DocumentKey(*cells) for cells in _ROW.findall(rest))
        yield Document(name, title.replace("`", ""), tuple(keys))
