"""Read TOML files and the quantities with units in them, and suggest words for misspelt ones."""

import difflib
import math
import re
import tomllib
from collections.abc import Collection
from pathlib import Path
from typing import Any

from calib.base.bounded import TOML, bytes_of
from calib.base.errors import InputError
from calib.base.units import UnknownUnit, si_of, to_si

NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
"""A number in a quantity, as a regular expression."""

_QUANTITY = re.compile(rf"({NUMBER})\s*+(.*)", re.DOTALL)  # number and unit
_MAX_CHARACTERS = 60  # of a wrong value in a message, and of a word that is compared
_MAX_PARTS = 100  # of a dotted key; tomllib takes seconds and gigabytes for thousands of parts
# a bare or quoted part of a dotted key, and the dot behind it
_KEY_PART_WITH_DOT = r"""(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+"""
_LONG_KEY = re.compile(rf"(?<![\w-])(?:{_KEY_PART_WITH_DOT}){{{_MAX_PARTS}}}")

_USUAL_UNITS = {"Pa": "bar", "m/s": "km/h", "m^2": "cm^2"}
"""The unit in which people write a quantity, by SI unit, if it is another one."""


def load_toml(path: Path, error: type[InputError]) -> dict[str, Any]:
    """Read a TOML file without a schema. Raises ``error`` if it is unreadable or not TOML."""
    data = bytes_of(path, TOML, error, "a TOML file")
    try:
        text = data.decode("utf-8-sig")
        if _LONG_KEY.search(text):
            raise ValueError(f"a key of more than {_MAX_PARTS} parts")
        return tomllib.loads(text)
    except (ValueError, RecursionError) as cause:
        expected, do = "a TOML file, which ends in .toml", "give the right file"
        if path.suffix == ".toml":
            expected, do = "a TOML file", 'put quantities and texts in quotes: mass = "1.5 kg"'
        raise error(f"not TOML: {cause}", where=path, expected=expected, do=do) from cause


def nearest(word: str, words: Collection[str]) -> str | None:
    """Return the word of ``words`` that is most like ``word``; None if none is similar.

    A word of the same letters is preferred, then a word with all parts of ``word``.
    """
    if len(word) > _MAX_CHARACTERS:  # comparing takes quadratic time
        return None
    close = difflib.get_close_matches(word, words, n=len(words)) if words else []
    parts = set(word.split("_"))

    def difference(candidate: str) -> tuple[bool, bool]:
        has_other_letters = sorted(candidate) != sorted(word)
        lacks_a_part = not parts <= set(candidate.split("_"))
        return has_other_letters, lacks_a_part

    return min(close, key=difference, default=None)


def did_you_mean(word: str, words: Collection[str]) -> str:
    """A hint such as ``did you mean 'mass'?``, or "" if none of ``words`` is similar."""
    close = nearest(word, words)
    return f"did you mean {close!r}?" if close else ""


def quantity(value: object, si: str | None, where: object, error: type[InputError]) -> float:
    """Return the number in SI of a quantity in a TOML file, such as ``"28.84 cm^2"``.

    ``si`` is its SI unit, or None for any quantity. A plain number is allowed if ``si`` is "1" or
    None. Raises ``error`` at ``where`` for any other value.
    """
    needs_unit = si not in ("1", None)
    usual = _USUAL_UNITS.get(si or "1", si)
    written = value if isinstance(value, str) else repr(value)
    match = _QUANTITY.fullmatch(written.strip())
    if match is None or match[2].startswith(","):  # "1600,5 kg" has a decimal comma
        expected = f'a quantity such as "1.5 {usual}"' if needs_unit else "a number"
        raise error(f"{shortened(value)} is not a quantity", where=where, expected=expected)
    number, unit = float(match[1]), match[2]
    if not math.isfinite(number):
        raise error(f"{shortened(value)} is not finite", where=where, expected="a finite number")
    if needs_unit and not unit:
        expected = f'a unit, such as "{number:g} {usual}"'
        raise error(f"{shortened(value)} has no unit", where=where, expected=expected)
    try:
        return to_si(number, unit or "1", si or si_of(unit or "1"))
    except UnknownUnit as cause:
        raise error(str(cause), where=where) from cause


def shortened(value: object) -> str:
    """Return a value of the user as a message shows it, cut if it is long."""
    text = repr(value)
    return text if len(text) <= _MAX_CHARACTERS else f"{text[:_MAX_CHARACTERS]}..."


def written_quantity(value: float, si: str) -> str | float:
    """Return what `quantity` reads back exactly: ``"1744.0 kg"``, or the number for ``si`` "1"."""
    return float(value) if si == "1" else f"{float(value)!r} {si}"
