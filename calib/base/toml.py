"""TOML text, quantities with units, and suggestions for misspelt words."""

import difflib
import math
import re
import tomllib
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

from calib.base.bounded import TOML, bytes_of
from calib.base.errors import InputError
from calib.base.units import UnknownUnit, is_unit, si_of, to_si

NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
"""A number in a quantity, as a regular expression."""

_QUANTITY = re.compile(rf"({NUMBER})\s*+(.*)", re.DOTALL)
"""A quantity without blanks around it."""

_DECIMALS = re.compile(r",\d")
"""What follows the digits of a number with a decimal comma."""

_THOUSANDS = re.compile(r"[-+]?\d{1,3},\d{3}(?!\d)")
"""A comma that may part thousands instead."""

_LONGEST_WORD = 60
"""Characters of a misspelt word for which a known one is looked for."""

_MOST_PARTS = 100
"""Parts of a dotted key; tomllib takes seconds and gigabytes for thousands of them."""

_LONG_KEY = re.compile(
    r"""(?<![\w-])(?:(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+)""" + f"{{{_MOST_PARTS}}}"
)


def load_toml(path: Path, error: type[InputError]) -> dict[str, Any]:
    """Read a TOML file without any check of its content.

    Raises ``error`` if there is no such file, if it cannot be read, or if it is not TOML.
    """
    data = bytes_of(path, TOML, error, "a TOML file")
    try:
        return _parse_toml(data.decode("utf-8-sig"))
    except ValueError as cause:
        raise error(
            f"not TOML: {cause}",
            where=path,
            expected='a TOML file; texts and quantities stand in quotes: "1.5 kg"',
        ) from cause


def _parse_toml(text: str) -> dict[str, Any]:
    """A TOML document. Raises ValueError, with words for people."""
    long = _LONG_KEY.search(text)
    if long:
        line = text.count("\n", 0, long.start()) + 1
        raise ValueError(f"a key of more than {_MOST_PARTS} parts in line {line}")
    try:
        return tomllib.loads(text.replace("\r\n", "\n"))
    except tomllib.TOMLDecodeError as cause:
        raise _named(text, cause) from cause
    except RecursionError as cause:
        raise ValueError("it is nested too deep") from cause
    except ValueError as cause:  # of Python's int
        raise ValueError("an integer of thousands of digits") from cause


_BARE = re.compile(
    r"""[ \t]*([\w."-]+)[ \t]*=[ \t]*([-+]?\d[\d.]*(?:,\d+)?)[ \t]*([^\s"'#,]*)[ \t]*(?:\#.*)?"""
)
"""A line of a key and a bare number, which may have a comma, and a unit."""


def _named(text: str, cause: ValueError) -> ValueError:
    """The error of a document that is not TOML; it names a decimal comma and missing quotes."""
    for at, line in enumerate(text.splitlines(), start=1):
        found = _BARE.fullmatch(line)
        if found is None:
            continue
        key, number, unit = found.groups()
        if unit and is_unit(unit):
            right = f'{key} = "{_with_point(number)} {unit}"'
            return ValueError(f"a quantity without quotes in line {at}; write {right!r}")
        if "," in number and not unit:
            right = f"{key} = {_with_point(number)}"
            return ValueError(f"a decimal comma in line {at}; write {right!r}")
    return cause


_COMMA = re.compile(r"[-+]?\d[\d.]*,\d+")


def _with_point(written: str) -> str:
    """A text that begins with a number, with a point for its comma; points in it part thousands.

    >>> _with_point("28,84 N.m"), _with_point("1.744,5"), _with_point("1744.5")
    ('28.84 N.m', '1744.5', '1744.5')
    """
    found = _COMMA.match(written)
    if found is None:
        return written
    return found[0].replace(".", "").replace(",", ".") + written[found.end() :]


def toml_bytes(document: Mapping[str, Any]) -> bytes:
    """Return a document of plain values as TOML in UTF-8; every number is read back exactly.

    Each table has its own header, even if it contains only tables.
    """
    import tomlkit

    whole = tomlkit.document()
    for key, value in document.items():
        if isinstance(value, Mapping):
            table = tomlkit.table(is_super_table=False)
            table.update(value)
            whole.add(key, table)
        else:
            whole.add(key, value)
    return tomlkit.dumps(whole).encode()


def nearest(word: str, known: Collection[str]) -> str | None:
    """Return the known word that is most like ``word``; None if none is similar.

    Of similar words, one of the same letters in another order is nearer: two were exchanged; so is
    one that has all parts of the word.

    >>> nearest("omega_lf", ["omega_fl", "omega_rl"])
    'omega_fl'
    >>> nearest("pad_fade", ["road_grade", "pad_thermal_fade"])
    'pad_thermal_fade'
    """
    if len(word) > _LONGEST_WORD:  # the comparison takes time with the square of its length
        return None
    close = difflib.get_close_matches(word, known, n=len(known)) if known else []
    exchanged = [one for one in close if sorted(one) == sorted(word)]
    whole = [one for one in close if set(word.split("_")) <= set(one.split("_"))]
    return next(iter([*exchanged, *whole, *close]), None)


def did_you_mean(word: str, known: Collection[str]) -> str:
    """``did you mean 'mass'?``, or "" if no known word is similar."""
    close = nearest(word, known)
    return f"did you mean {close!r}?" if close else ""


def quantity(value: object, si: str | None, where: object, error: type[InputError]) -> float:
    """A number in SI from a quantity in a TOML file, such as ``"28.84 cm^2"``.

    ``si`` is the unit wanted, None for any; only a dimensionless one may be a plain number. Raises
    ``error`` at ``where`` for what is not finite, has no unit or one of another quantity.
    """
    dimensionless = si in ("1", None)
    if isinstance(value, int | float) and not isinstance(value, bool):
        number, unit = _float(value), ""
    else:
        match = _QUANTITY.fullmatch(value.strip()) if isinstance(value, str) else None
        if match is not None and _DECIMALS.match(match[2]):
            raise error(
                f"{_short(value)} has a decimal comma",
                where=where,
                expected=f"a decimal point: {_with_point(match[0])!r}{_without_mark(match[0])}",
            )
        if match is None:
            wanted = "a number" if dimensionless else f'a quantity such as "1.5 {si}"'
            raise error(f"{_short(value)} is not a quantity", where=where, expected=wanted)
        number, unit = float(match[1]), match[2]
    if not math.isfinite(number):
        raise error(f"{_short(value)} is not finite", where=where, expected="a finite number")
    if not unit and not dimensionless:
        other = f' or "{number:g} g"' if si == "m/s^2" else ""
        raise error(
            f"{value!r} has no unit",
            where=where,
            expected=f'a unit, such as "{number:g} {si}"{other}',
        )
    try:
        return to_si(number, unit or "1", si or si_of(unit or "1"))
    except UnknownUnit as cause:
        raise error(str(cause), where=where) from cause


def _without_mark(written: str) -> str:
    """The other reading of a comma in front of three digits: it may part thousands."""
    if not _THOUSANDS.match(written):
        return ""
    return f", or no mark between thousands: {written.replace(',', '')!r}"


def _short(value: object) -> str:
    """What was written, with at most 60 characters."""
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:60]}..."


def _float(value: float) -> float:
    """A number as float; infinite where it is an integer of too many digits."""
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf


def written_quantity(value: float, si: str) -> str | float:
    """Text that `quantity` reads back exactly, ``"1744.0 kg"``; a plain number for ``si`` "1"."""
    number = value if isinstance(value, int) else float(value)
    return number if si == "1" else f"{number!r} {si}"
