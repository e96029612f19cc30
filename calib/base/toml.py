"""TOML text, quantities with units, and suggestions for misspelt words."""

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

_QUANTITY = re.compile(rf"({NUMBER})\s*+(.*)", re.DOTALL)  # without blanks around it
_LONGEST = 60  # characters of a wrong value in a message, or of a word that is compared
_MOST_PARTS = 100  # of a dotted key; tomllib takes seconds and gigabytes for thousands of them

_LONG_KEY = re.compile(
    r"""(?<![\w-])(?:(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+)""" + f"{{{_MOST_PARTS}}}"
)


def load_toml(path: Path, error: type[InputError]) -> dict[str, Any]:
    """Read a TOML file without a schema. Raises ``error`` if it is unreadable or not TOML."""
    data = bytes_of(path, TOML, error, "a TOML file")
    try:
        text = data.decode("utf-8-sig")
        if _LONG_KEY.search(text):
            raise ValueError(f"a key of more than {_MOST_PARTS} parts")
        return tomllib.loads(text)
    except (ValueError, RecursionError) as cause:
        expected = 'a TOML file; quantities and texts stand in quotes, with a point: "1.5 kg"'
        raise error(f"not TOML: {cause}", where=path, expected=expected) from cause


def nearest(word: str, words: Collection[str]) -> str | None:
    """Return the known word that is most like ``word``; None if none is similar.

    Words with the same letters, or with all parts of ``word``, come first.
    """
    if len(word) > _LONGEST:  # comparing takes quadratic time
        return None
    close = difflib.get_close_matches(word, words, n=len(words)) if words else []
    parts = set(word.split("_"))
    return min(
        close,
        key=lambda one: (sorted(one) != sorted(word), not parts <= set(one.split("_"))),
        default=None,
    )


def did_you_mean(word: str, words: Collection[str]) -> str:
    """``did you mean 'mass'?``, or "" if no known word is similar."""
    close = nearest(word, words)
    return f"did you mean {close!r}?" if close else ""


def quantity(value: object, si: str | None, where: object, error: type[InputError]) -> float:
    """A number in SI from a quantity in a TOML file, such as ``"28.84 cm^2"``.

    ``si`` is the unit wanted, None for any; only a dimensionless quantity may be a plain number.
    Raises ``error`` at ``where`` for a missing or wrong unit, or a number that is not finite.
    """
    dimensionless = si in ("1", None)
    written = value if isinstance(value, str) else repr(value)
    match = _QUANTITY.fullmatch(written.strip())
    if match is None or match[2].startswith(","):
        expected = "a number" if dimensionless else f'a quantity such as "1.5 {si}"'
        raise error(f"{shown(value)} is not a quantity", where=where, expected=expected)
    number, unit = float(match[1]), match[2]
    if not math.isfinite(number):
        raise error(f"{shown(value)} is not finite", where=where, expected="a finite number")
    if not unit and not dimensionless:
        expected = f'a unit, such as "{number:g} {si}"'
        raise error(f"{shown(value)} has no unit", where=where, expected=expected)
    try:
        return to_si(number, unit or "1", si or si_of(unit or "1"))
    except UnknownUnit as cause:
        raise error(str(cause), where=where) from cause


def shown(value: object) -> str:
    """A given value as a message shows it."""
    text = repr(value)
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."


def written_quantity(value: float, si: str) -> str | float:
    """Text that `quantity` reads back exactly, ``"1744.0 kg"``; a plain number for ``si`` "1"."""
    return float(value) if si == "1" else f"{float(value)!r} {si}"
