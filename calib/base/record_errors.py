"""The mistakes in a file: pydantic's errors in plain words, all in one message."""

from dataclasses import is_dataclass
from types import UnionType
from typing import Annotated, Any, NamedTuple, Union, get_args, get_origin, get_type_hints

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails, PydanticCustomError

from calib.base.errors import BrakeCalError
from calib.base.toml import did_you_mean, nearest, shown

_LISTED = 100
"""Mistakes of a file that a message lists."""

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


_Place = tuple[int | str, ...]
"""Keys and indices from the top of a file to a value."""


def wrong(what: str, expected: str = "", do: str = "") -> PydanticCustomError:
    """Return the error for a validator to raise: value given, value expected, what to do."""
    return PydanticCustomError("wrong", "{what}", {"what": what, "expected": expected, "do": do})


def one_error(
    cause: ValidationError, schema: type[BaseModel], where: object, error: type[BrakeCalError]
) -> BrakeCalError:
    """Return one error that lists all mistakes in the file ``where``."""
    every = cause.errors(include_url=False)
    details, more = every[:_LISTED], len(every) - _LISTED
    version = [d for d in details if _is_version(schema, d["loc"])]
    meant = {_meant(schema, d["loc"]) for d in details if d["type"] in _UNKNOWN}
    mistakes = [
        _mistake(detail, schema)
        for detail in version or details
        # A misspelt key is also reported as missing; only the spelling error is kept.
        if detail["type"] not in _MISSING or detail["loc"] not in meant
    ]
    if len(mistakes) == 1:
        (only,) = mistakes
        at = ": ".join(str(part) for part in (where, only.place) if part)
        return only.as_error(error, at)
    lines = [str(mistake.as_error(error, mistake.place)) for mistake in mistakes]
    if more > 0:
        lines.append(f"and {more} more")
    return error(f"{len(mistakes) + max(more, 0)} errors", where=where, lines=tuple(lines))


class _Mistake(NamedTuple):
    place: str
    what: str
    expected: str = ""
    do: str = ""

    def as_error(self, error: type[BrakeCalError], where: object) -> BrakeCalError:
        return error(self.what, where=where or None, expected=self.expected, do=self.do)


def _mistake(detail: ErrorDetails, schema: type[BaseModel]) -> _Mistake:
    kind, loc, given = detail["type"], detail["loc"], shown(detail["input"])
    here, above = _path(loc), _path(loc[:-1])
    if _is_version(schema, loc):
        if kind in _MISSING:
            return _Mistake(above, "no schema", "a line 'schema = 1' at the top")
        return _Mistake(above, f"schema {given}", "schema = 1")
    if kind == "wrong":
        return _Mistake(here, **detail["ctx"])
    if kind == "json_invalid":
        return _Mistake("", f"not JSON ({detail['ctx']['error']})")
    if kind == "literal_error":
        return _Mistake(here, given, detail["ctx"]["expected"])
    if kind in _MISSING:
        return _Mistake(above, f"key {loc[-1]!r} is missing", f"a value for {loc[-1]!r}")
    if kind in _UNKNOWN:
        known = _keys(schema, loc[:-1])
        hint = did_you_mean(str(loc[-1]), known)
        expected = "" if hint else f"one of {', '.join(known)}"
        return _Mistake(above, f"unknown key {shown(loc[-1])}", expected, hint)
    wanted = _kind_at(schema, loc)
    if kind in _NO_TABLE:
        written_as = getattr(wanted, "written_as", "") or (here and f"[{here}]")
        return _Mistake(here, f"{given} is not a table", written_as)
    if kind == "list_type" and _is_section(_inner(wanted)):
        return _Mistake(here, given, f"[[{here}]] with double brackets")
    return _Mistake(here, given, _EXPECTED.get(kind, detail["msg"]))


def _is_version(schema: type[BaseModel], loc: _Place) -> bool:
    return loc[-1:] == ("schema",) and "schema" in _keys(schema, loc[:-1])


def _meant(schema: type[BaseModel], loc: _Place) -> _Place:
    """Path of the known key that is most like an unknown one."""
    return (*loc[:-1], nearest(str(loc[-1]), _keys(schema, loc[:-1])) or loc[-1])


def _path(loc: _Place) -> str:
    """Path as text, such as ``surfaces[0].start``."""
    text = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in loc)
    return text.removeprefix(".")


def _keys(schema: type[BaseModel], loc: _Place) -> list[str]:
    """The allowed keys of the table at ``loc``."""
    kind = _kind_at(schema, loc)
    if _is_section(kind):
        return [field.alias or name for name, field in kind.model_fields.items()]
    return list(get_type_hints(kind)) if is_dataclass(kind) else []


def _kind_at(schema: type[BaseModel], loc: _Place) -> Any:
    """The type of the value at ``loc`` in a schema."""
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
    """The type of the items of a list or dict."""
    held = [a for a in get_args(kind) if a is not Ellipsis]
    return _plain(held[-1]) if held else None


def _is_section(kind: Any) -> bool:
    return isinstance(kind, type) and issubclass(kind, BaseModel)
