"""Words in column names for each quantity and each wheel."""

import re
from itertools import pairwise
from typing import NamedTuple

from calib.base.plain import rows

_WORD = re.compile(
    r"[LR][12](?![0-9A-Za-z])|(?<![A-Za-z])[lr][12](?![0-9A-Za-z])"
    r"|[A-ZÄÖÜ]+(?=[A-ZÄÖÜ][a-zäöü])|[A-ZÄÖÜ]?[a-zäöüß]+|[A-ZÄÖÜ]+|\d+"
)


_FRONT = {"f", "front", "frnt", "v", "vo", "vorn", "vorne", "va", "fa"}
_REAR = {"r", "rear", "h", "hi", "hinten", "ha", "ra"}
_LEFT = {"l", "left", "le", "links", "li", "lh"}
_RIGHT = {"r", "right", "ri", "rechts", "re", "rh"}
_REAR_OF_WHEEL = _REAR | {"re"}
"""In the name of a wheel "re" is rear before a side, as in AUTOSAR's ``ReLe``, else right."""
_CORNERS = {
    "fl": {"fl", "lf", "vl", "frontleft", "leftfront", "l1"},
    "fr": {"fr", "rf", "vr", "frontright", "rightfront", "r1"},
    "rl": {"rl", "lr", "hl", "rearleft", "leftrear", "l2"},
    "rr": {"rr", "hr", "rearright", "rightrear", "r2"},
}
"""Abbreviations of a wheel: English in both orders, German, and CarSim's side and axle."""
_SIDES = _FRONT | _REAR | _LEFT | _RIGHT | set().union(*_CORNERS.values())


class _Words(NamedTuple):
    """Words of a quantity, and those of other quantities with like names."""

    wanted: frozenset[str]
    unwanted: frozenset[str]


_QUANTITIES = {
    row["quantity"]: _Words(frozenset(row["words"].split()), frozenset(row["others"].split()))
    for row in rows("words.csv", "calib.suggest")
}
"""Words by quantity; "derived" is a second, computed channel of the same quantity."""
_WHOLE = 5
"""Fewest letters of a word that is also searched within compounds: ``Fahrzeuggeschwindigkeit``."""


def words(name: str) -> list[str]:
    """The words of a name in lower case."""
    return [word.lower() for word in _WORD.findall(name)]


def corner(name: str) -> str | None:
    """The wheel in a name, ``fl``, ``fr``, ``rl`` or ``rr``, or None."""
    return _corner(words(name))


def loose_corner(name: str) -> tuple[str | None, str]:
    """The wheel in a name or at its end, as in ``WSFL``, and the name without it: ``ws``."""
    wheel_by_words = corner(name)
    if wheel_by_words is not None or not words(name):
        return wheel_by_words, " ".join(word for word in words(name) if word not in _SIDES)
    *others, last = words(name)
    wheel = _corner([last[-2:]]) if len(last) > 2 else None
    return wheel, " ".join([*others, last[:-2]])


def _corner(in_order: list[str]) -> str | None:
    wheels = [wheel for wheel, names in _CORNERS.items() if names & set(in_order)]
    if len(wheels) == 1:
        return wheels[0]
    if wheels:
        return None
    for first, second in pairwise(in_order):
        turned = [(second, first)] if len(first + second) > 2 else []  # `l r` is not a wheel
        for a, b in [(first, second), *turned]:
            if a in _FRONT | _REAR_OF_WHEEL and b in _LEFT | _RIGHT:
                return ("f" if a in _FRONT else "r") + ("l" if b in _LEFT else "r")
    return None


def axle(name: str) -> str | None:
    """The axle in a name, ``f`` or ``r``, or None; None also for the name of a wheel."""
    in_name = set(words(name))
    if corner(name) is not None or bool(in_name & _FRONT) == bool(in_name & _REAR):
        return None
    return "f" if in_name & _FRONT else "r"


def has_word(name: str, quantity: str) -> bool:
    """Whether one of the words of a name is one of a quantity in `words.csv`."""
    return not _QUANTITIES[quantity].wanted.isdisjoint(words(name))


def score(name: str, quantity: str) -> int:
    """Twice the wanted words in a name, less one if it is computed; -1 with an unwanted one."""
    in_name, (wanted, unwanted) = set(words(name)), _QUANTITIES[quantity]
    if _matching(in_name, unwanted):
        return -1
    return 2 * len(_matching(in_name, wanted)) - has_word(name, "derived")


def _matching(in_name: set[str], wanted: frozenset[str]) -> set[str]:
    return {w for w in in_name if w in wanted or any(len(x) >= _WHOLE and x in w for x in wanted)}
