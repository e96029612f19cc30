"""Mistakes in a file: pydantic's errors in plain words, all in one message."""

from types import UnionType
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails, PydanticCustomError

from calib.base.errors import BrakeCalError
from calib.base.toml import did_you_mean, nearest, shown

_LISTED = 100  # most mistakes in a message

_EXPECTED = {
    "string_type": "text in quotes",
    "bool_type": "true or false",
    "float_type": "a number",
    "finite_number": "a finite number",
    "int_type": "a whole number",
    "list_type": "a list",
    "tuple_type": "a list",
}
_NO_TABLE = ("model_type", "dict_type", "model_attributes_type")

_Place = tuple[int | str, ...]  # keys and indices from the top of a file to a value


def wrong(problem: str, expected: str = "", do: str = "") -> PydanticCustomError:
    """Return the error for a validator to raise: value given, value expected, what to do."""
    return PydanticCustomError("wrong", "{what}", {"what": problem, "expected": expected, "do": do})


def one_error(
    cause: ValidationError, schema: type[BaseModel], where: object, error: type[BrakeCalError]
) -> BrakeCalError:
    """Return one error that lists all mistakes in the file ``where``."""
    every = cause.errors(include_url=False)
    details, more = every[:_LISTED], max(len(every) - _LISTED, 0)
    version = [d for d in details if d["loc"] == ("schema",)]
    # a misspelt key is also reported as missing: only the spelling counts
    intended = [
        (*d["loc"][:-1], nearest(str(d["loc"][-1]), _keys(schema, d["loc"][:-1])))
        for d in details
        if d["type"] == "extra_forbidden"
    ]
    mistakes = [
        _mistake(detail, schema)
        for detail in version or details
        if detail["type"] != "missing" or detail["loc"] not in intended
    ]
    if len(mistakes) == 1:
        place, problem, expected, do = mistakes[0]
        location = ": ".join(str(part) for part in (where, place) if part)
        return error(problem, where=location or None, expected=expected, do=do)
    lines = [
        str(error(problem, where=place or None, expected=expected, do=do))
        for place, problem, expected, do in mistakes
    ]
    unlisted = [f"and {more} more"] if more else []
    return error(f"{len(mistakes) + more} errors", where=where, lines=(*lines, *unlisted))


def _mistake(detail: ErrorDetails, schema: type[BaseModel]) -> tuple[str, str, str, str]:
    """Place, problem, expected value and remedy of a mistake."""
    kind, loc, value = detail["type"], detail["loc"], shown(detail["input"])
    path, parent = _path(loc), _path(loc[:-1])
    context = detail.get("ctx", {})
    if loc == ("schema",):
        if kind == "missing":
            return parent, "no schema", "a line 'schema = 1' at the top", ""
        return parent, f"schema {value}", "schema = 1", ""
    if kind == "wrong":
        return path, context["what"], context["expected"], context["do"]
    if kind == "json_invalid":
        return "", f"not JSON ({context['error']})", "", ""
    if kind == "literal_error":
        return path, value, context["expected"], ""
    if kind == "missing":
        return parent, f"key {loc[-1]!r} is missing", f"a value for {loc[-1]!r}", ""
    if kind == "extra_forbidden":
        keys = _keys(schema, loc[:-1])
        hint = did_you_mean(str(loc[-1]), keys)
        expected = "" if hint or not keys else f"one of {', '.join(keys)}"
        return parent, f"unknown key {shown(loc[-1])}", expected, hint
    wanted = _kind_at(schema, loc)
    if kind in _NO_TABLE:
        written_as = getattr(wanted, "written_as", "") or (path and f"[{path}]")
        return path, f"{value} is not a table", written_as, ""
    if kind == "list_type" and _is_section(_plain((*get_args(wanted), None)[0])):
        return path, value, f"[[{path}]] with double brackets", ""
    return path, value, _EXPECTED.get(kind, detail["msg"]), ""


def _path(loc: _Place) -> str:
    """Path as text, such as ``empirical[0].knots``."""
    text = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in loc)
    return text.removeprefix(".")


def _keys(schema: type[BaseModel], loc: _Place) -> list[str]:
    """The allowed keys of the table at ``loc``."""
    kind = _kind_at(schema, loc)
    fields = kind.model_fields.items() if _is_section(kind) else ()
    return [field.alias or name for name, field in fields]


def _kind_at(schema: type[BaseModel], loc: _Place) -> Any:
    """The type of the value at ``loc`` in a schema."""
    kind: Any = schema
    for key in loc:
        if _is_section(kind):
            kind = kind.model_fields[str(key)].annotation
        else:  # an item of a list, a tuple of any length or a dict
            kind = next((a for a in reversed(get_args(kind)) if a is not Ellipsis), None)
        kind = _plain(kind)
    return kind


def _plain(kind: Any) -> Any:
    """A type without ``Annotated`` and without None."""
    if get_origin(kind) is Annotated:
        return _plain(get_args(kind)[0])
    if get_origin(kind) in (Union, UnionType):
        return _plain(next(a for a in get_args(kind) if a is not type(None)))
    return kind


def _is_section(kind: Any) -> bool:
    return isinstance(kind, type) and issubclass(kind, BaseModel)
