"""Messages about mistakes in a file: pydantic's errors in plain words, all in one message."""

from collections.abc import Iterator
from types import UnionType
from typing import Annotated, Any, NamedTuple, Union, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails, PydanticCustomError

from calib.base.errors import BrakeCalError
from calib.base.toml import did_you_mean, nearest, shortened

_MAX_LISTED = 100  # mistakes in one message
_SUSPICIOUS = 8  # mistakes in a file that is probably of another kind

_EXPECTED = {
    "string_type": "text in quotes",
    "bool_type": "true or false",
    "float_type": "a number",
    "finite_number": "a finite number",
    "int_type": "a whole number",
    "list_type": "a list",
    "tuple_type": "a list",
}
"""What a message expects, by pydantic's type of the error."""
_NOT_A_TABLE = ("model_type", "dict_type", "model_attributes_type")  # where a table is expected

_Place = tuple[int | str, ...]  # keys and indices from the top of a file to a value


class _Mistake(NamedTuple):
    """A mistake at ``place``, a text such as ``empirical[0].knots``."""

    place: str
    problem: str
    expected: str = ""
    do: str = ""

    def error(self, kind: type[BrakeCalError], where: object = None) -> BrakeCalError:
        """Return the error for this mistake in the file ``where``."""
        location = ": ".join(str(part) for part in (where, self.place) if part)
        return kind(self.problem, where=location or None, expected=self.expected, do=self.do)


def wrong(problem: str, expected: str = "", do: str = "") -> PydanticCustomError:
    """Return the error that a validator raises: what was wrong, what was expected, what to do."""
    return PydanticCustomError("wrong", "{what}", {"what": problem, "expected": expected, "do": do})


def one_error(
    cause: ValidationError, schema: type[BaseModel], where: object, error: type[BrakeCalError]
) -> BrakeCalError:
    """Return one error that lists all mistakes in the file ``where``."""
    details = cause.errors(include_url=False)
    unlisted = max(len(details) - _MAX_LISTED, 0)
    details = details[:_MAX_LISTED]
    about_version = [detail for detail in details if detail["loc"] == ("schema",)]
    if about_version:  # other mistakes may only follow from the wrong version
        details = about_version
    mistakes = [_mistake(detail, schema) for detail in _without_misspelt(details, schema)]
    if len(mistakes) == 1:
        return mistakes[0].error(error, where)
    lines = [str(mistake.error(error)) for mistake in mistakes]
    if unlisted:
        lines.append(f"and {unlisted} more")
    do = "is it the right file?" if len(mistakes) >= _SUSPICIOUS else ""
    return error(f"{len(mistakes) + unlisted} errors", where=where, do=do, lines=tuple(lines))


def _without_misspelt(
    details: list[ErrorDetails], schema: type[BaseModel]
) -> Iterator[ErrorDetails]:
    """Leave out missing keys that are only misspelt, since the misspelt key is reported, too."""
    intended = set[tuple[int | str | None, ...]]()
    for detail in details:
        if detail["type"] == "extra_forbidden":
            table, written = detail["loc"][:-1], str(detail["loc"][-1])
            intended.add((*table, nearest(written, _keys(schema, table))))
    for detail in details:
        if detail["type"] != "missing" or detail["loc"] not in intended:
            yield detail


def _mistake(detail: ErrorDetails, schema: type[BaseModel]) -> _Mistake:
    kind, place, value = detail["type"], detail["loc"], shortened(detail["input"])
    path, table = _path(place), _path(place[:-1])  # of the value, and of the table that holds it
    context = detail.get("ctx", {})
    if place == ("schema",):
        if kind == "missing":
            return _Mistake(table, "no schema", "a line 'schema = 1' at the top")
        return _Mistake(table, f"schema {value}", "schema = 1")
    if kind == "wrong":
        return _Mistake(path, context["what"], context["expected"], context["do"])
    if kind == "json_invalid":
        return _Mistake("", f"not JSON ({context['error']})")
    if kind == "literal_error":
        return _Mistake(path, value, context["expected"])
    if kind == "missing":
        return _Mistake(table, f"key {place[-1]!r} is missing", f"a value for {place[-1]!r}")
    if kind == "extra_forbidden":
        keys = _keys(schema, place[:-1])
        hint = did_you_mean(str(place[-1]), keys)
        expected = "" if hint or not keys else f"one of {', '.join(keys)}"
        return _Mistake(table, f"unknown key {shortened(place[-1])}", expected, hint)
    type_there = _type_at(schema, place)
    if kind in _NOT_A_TABLE:
        written_as = getattr(type_there, "written_as", "")
        if path and not written_as:
            written_as = f"[{path}]"
        return _Mistake(path, f"{value} is not a table", written_as)
    if kind == "list_type" and _is_section(_item_type(type_there)):
        return _Mistake(path, value, f"[[{path}]] with double brackets")
    return _Mistake(path, value, _EXPECTED.get(kind, detail["msg"]))


def _path(place: _Place) -> str:
    text = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in place)
    return text.removeprefix(".")


def _keys(schema: type[BaseModel], place: _Place) -> list[str]:
    """The allowed keys of the table at ``place``."""
    table = _type_at(schema, place)
    fields = table.model_fields.items() if _is_section(table) else ()
    return [field.alias or name for name, field in fields]


def _type_at(schema: type[BaseModel], place: _Place) -> Any:
    kind: Any = schema
    for key in place:
        if _is_section(kind):
            kind = _bare(kind.model_fields[str(key)].annotation)
        else:
            kind = _item_type(kind)
    return kind


def _item_type(kind: Any) -> Any:
    """The type of the items of a list, a tuple of any length or a dict; None for other types."""
    arguments = [argument for argument in get_args(kind) if argument is not Ellipsis]
    return _bare(arguments[-1]) if arguments else None


def _bare(kind: Any) -> Any:
    """A type without ``Annotated`` and without None."""
    if get_origin(kind) is Annotated:
        return _bare(get_args(kind)[0])
    if get_origin(kind) in (Union, UnionType):
        return _bare(next(a for a in get_args(kind) if a is not type(None)))
    return kind


def _is_section(kind: Any) -> bool:
    return isinstance(kind, type) and issubclass(kind, BaseModel)
