"""TOML files from the user: whole, of a known schema, with known keys and quantities with units."""

import difflib
import math
import re
import tomllib
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

from calib.errors import InputError
from calib.units import UnknownUnit, si_of, to_si

_QUANTITY = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*")


def read_toml(path: Path, schema: int, error: type[InputError]) -> dict[str, Any]:
    """Read a TOML file and check its ``schema``, which is taken out of the result.

    Raises ``error`` if there is no such file, if it is not TOML or of another schema.
    """
    if not path.is_file():
        what = "a directory" if path.is_dir() else "no such file"
        raise error(what, where=path, expected="a TOML file", do="check the path")
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as cause:
        raise error(f"not TOML: {cause}", where=path, expected="a TOML file") from cause
    found = table.pop("schema", None)
    if found is None:
        raise error("no schema", where=path, expected=f"a line 'schema = {schema}' at the top")
    if found != schema or isinstance(found, bool):
        raise error(f"schema {found!r}", where=path, expected=f"schema = {schema}")
    return table


def check_keys(
    table: object,
    known: Collection[str],
    required: Collection[str],
    where: object,
    error: type[InputError],
) -> Mapping[str, Any]:
    """Return the table if it has all required keys and no unknown ones.

    Raises ``error`` with the nearest known key for a typing error, which is looked at first: a
    misspelt key is also a missing one, and the spelling is the thing to mend.
    """
    if not isinstance(table, dict):
        raise error(f"{table!r} is not a table", where=where, expected="a TOML table")
    for key in table:
        if key not in known:
            raise error(
                f"unknown key {key!r}",
                where=where,
                expected=f"one of {', '.join(known)}",
                do=did_you_mean(key, known),
            )
    for key in required:
        if key not in table:
            raise error(f"key {key!r} is missing", where=where, expected=f"a value for {key!r}")
    return table


def did_you_mean(word: str, known: Collection[str]) -> str:
    """``did you mean 'mass'?``, or nothing if no known word is near."""
    close = difflib.get_close_matches(word, known, n=1)
    return f"did you mean {close[0]!r}?" if close else ""


def quantity(value: object, si: str | None, where: object, error: type[InputError]) -> float:
    """A number in SI from what a TOML file says, such as ``"28.84 cm^2"``.

    Parameters
    ----------
    value : a string with number and unit, or a plain number where it has no dimension.
    si : SI unit wanted; None if any quantity will do.
    where : file and key, for the message.
    error : what to raise if the value is no number, has no unit or one of another quantity.
    """
    dimensionless = si in ("1", None)
    if isinstance(value, int | float) and not isinstance(value, bool):
        number, unit = float(value), ""
    else:
        match = _QUANTITY.fullmatch(value) if isinstance(value, str) else None
        if match is None:
            wanted = "a number" if dimensionless else f'a quantity such as "1.5 {si}"'
            raise error(f"{value!r} is not a quantity", where=where, expected=wanted)
        number, unit = float(match[1]), match[2]
    if not math.isfinite(number):
        raise error(f"{value!r} is not finite", where=where, expected="a finite number")
    if not unit and not dimensionless:
        raise error(
            f"{value!r} has no unit", where=where, expected=f'a unit, such as "{number:g} {si}"'
        )
    try:
        return to_si(number, unit or "1", si or si_of(unit or "1"))
    except UnknownUnit as cause:
        raise error(str(cause), where=where) from cause
