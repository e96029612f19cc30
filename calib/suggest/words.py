"""Recognize the quantity, the wheel and the axle of a column by the words in its name."""

import re
from itertools import pairwise
from typing import NamedTuple

from calib.base.plain import rows

_WORD = re.compile(
    r"[LR][12](?![0-9A-Za-z])|(?<![A-Za-z])[lr][12](?![0-9A-Za-z])"  # side and axle of CarSim: L1
    r"|[A-ZÄÖÜ]+(?=[A-ZÄÖÜ][a-zäöü])"  # an abbreviation before a capitalised word: ESP of ESPSpeed
    r"|[A-ZÄÖÜ]?[a-zäöüß]+|[A-ZÄÖÜ]+|\d+"  # a word, another abbreviation, a number
)
# English and German; "re" is "rechts" after an axle, and rear before a side, as in ``ReLe``
_FRONT = {"f", "front", "frnt", "v", "vo", "vorn", "vorne", "va", "fa"}
_REAR = {"r", "rear", "h", "hi", "hinten", "ha", "ra"}
_LEFT = {"l", "left", "le", "links", "li", "lh"}
_RIGHT = {"r", "right", "ri", "rechts", "re", "rh"}
_REAR_BEFORE_SIDE = _REAR | {"re"}
_WHEELS = {
    "fl": {"fl", "lf", "vl", "frontleft", "leftfront", "l1"},
    "fr": {"fr", "rf", "vr", "frontright", "rightfront", "r1"},
    "rl": {"rl", "lr", "hl", "rearleft", "leftrear", "l2"},
    "rr": {"rr", "hr", "rearright", "rightrear", "r2"},
}
"""Abbreviations of each wheel: English in both orders, German, and CarSim's side and axle."""
_PLACES = _FRONT | _REAR | _LEFT | _RIGHT | set().union(*_WHEELS.values())


class _Words(NamedTuple):
    """Words that name a quantity, and words that show that a name is of another quantity."""

    wanted: frozenset[str]
    unwanted: frozenset[str]


_QUANTITIES = {
    row["quantity"]: _Words(frozenset(row["words"].split()), frozenset(row["others"].split()))
    for row in rows("words.csv", "calib.suggest")
}
"""By quantity; the words of "derived" show that a channel was computed, not measured."""
_LONG = 5  # fewest letters of a word that is also found in compounds: Fahrzeuggeschwindigkeit


def words(name: str) -> list[str]:
    """The words of a name in lower case."""
    return [word.lower() for word in _WORD.findall(name)]


def wheel_of(name: str) -> str | None:
    """The wheel in a name, ``fl``, ``fr``, ``rl`` or ``rr``, or None."""
    return _wheel_in(words(name))


def split_wheel(name: str) -> tuple[str | None, str]:
    """The wheel that words or the last two letters name, and the rest: fl and ws of ``WSFL``."""
    all_words = words(name)
    wheel = _wheel_in(all_words)
    if wheel or not all_words:
        return wheel, " ".join(word for word in all_words if word not in _PLACES)
    *others, last = all_words
    wheel = _wheel_in([last[-2:]]) if len(last) > 2 else None
    return wheel, " ".join([*others, last[:-2] if wheel else last])


def _wheel_in(all_words: list[str]) -> str | None:
    """The wheel among the words, as an abbreviation or as an axle and a side, or None."""
    wheels = [wheel for wheel, names in _WHEELS.items() if not names.isdisjoint(all_words)]
    if wheels:
        return wheels[0] if len(wheels) == 1 else None
    for first, second in pairwise(all_words):
        orders = [(first, second)]
        if len(first + second) > 2:  # of single letters, `r l` is rear left, but `l r` is no wheel
            orders.append((second, first))
        for axle, side in orders:
            if axle in _FRONT | _REAR_BEFORE_SIDE and side in _LEFT | _RIGHT:
                return ("f" if axle in _FRONT else "r") + ("l" if side in _LEFT else "r")
    return None


def axle_of(name: str) -> str | None:
    """The axle in a name, ``f`` or ``r``, or None; None also for the name of a wheel."""
    in_name = words(name)
    is_front, is_rear = not _FRONT.isdisjoint(in_name), not _REAR.isdisjoint(in_name)
    if is_front == is_rear or wheel_of(name) is not None:
        return None
    return "f" if is_front else "r"


def has_word(name: str, quantity: str) -> bool:
    """Whether a name has one of the words of a quantity in `words.csv`."""
    return not _QUANTITIES[quantity].wanted.isdisjoint(words(name))


def score(name: str, quantity: str) -> int:
    """How well a name fits a quantity: the higher, the better; -1 for a name of another quantity.

    Each wanted word counts 2; a word for a derived channel takes 1 away.
    """
    in_name, quantity_words = set(words(name)), _QUANTITIES[quantity]
    if _count(in_name, quantity_words.unwanted):
        return -1
    return 2 * _count(in_name, quantity_words.wanted) - int(has_word(name, "derived"))


def _count(in_name: set[str], listed: frozenset[str]) -> int:
    """Number of words in a name that are listed or contain a long listed word."""
    long = [word for word in listed if len(word) >= _LONG]
    return sum(word in listed or any(part in word for part in long) for word in in_name)
