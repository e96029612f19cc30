"""Whether the card of an effect of the user's own says what those of the catalogue say."""

import math
import re
from typing import Any

from calib.base.errors import ModelError
from calib.base.units import UnknownUnit, to_si
from calib.car.effects.catalogue import CATALOGUE
from calib.car.effects.effect import Card, Effect, Parameter
from calib.car.own_effects.hooks import hooks_of

NAME = re.compile(r"[a-z][a-z0-9_]*")
"""What an effect and a parameter may be called: a key of a model file."""


def check_card(effect: Effect, where: str) -> None:
    """Raise ModelError for a card that does not say everything, as those of the catalogue do.

    ``where`` names file and line, for the message.
    """
    card: Any = effect.card
    if not isinstance(card, Card):
        raise ModelError(f"the card is a {type(card).__name__}", where=where, expected="a Card")
    _require(_is_name(card.name), f"name {card.name!r}", "lower case letters, digits, _", where)
    _require(
        card.name not in CATALOGUE,
        f"the catalogue has an effect {card.name!r}",
        "another name",
        where,
    )
    for part in ("cause", "equation", "source", "looks_like"):
        text = getattr(card, part)
        said = isinstance(text, str) and bool(text.strip())
        _require(said, f"{part} {text!r}", "a sentence", where)
    parts = card.parameters
    listed = isinstance(parts, tuple) and bool(parts)
    listed = listed and all(isinstance(p, Parameter) for p in parts)
    _require(listed, "parameters of the card", "a tuple of one Parameter or more", where)
    for p in parts:
        _check_parameter(p, where)
    names = [p.name for p in parts]
    _require(len(set(names)) == len(names), "two parameters of one name", "other names", where)
    strength, neutral = parts[0], card.neutral
    _require(
        _is_number(neutral) and strength.low <= neutral <= strength.high,
        f"neutral {neutral!r}",
        f"a strength from {strength.low:g} to {strength.high:g}, the range of {strength.name}",
        where,
    )
    _require(
        strength.typical != neutral,
        f"typical {neutral:g} of {strength.name} is the neutral strength",
        "a typical strength that does something",
        where,
    )
    _require(bool(hooks_of(effect)), "the effect has no function", "one hook of Effect", where)
    for name, hook in hooks_of(effect).items():
        _require(callable(hook), f"{name} is a {type(hook).__name__}", "a function", where)


def _check_parameter(p: Parameter, where: str) -> None:
    _require(_is_name(p.name), f"parameter {p.name!r}", "lower case letters, digits, _", where)
    _require(_is_si(p.unit), f"unit {p.unit!r} of {p.name}", 'an SI unit, such as "N*m"', where)
    numbers = all(map(_is_number, (p.low, p.high, p.typical, p.spread)))
    _require(
        numbers and p.low <= p.typical <= p.high and 0.0 < p.spread < p.high - p.low,
        f"{p.name}: low {p.low!r}, high {p.high!r}, typical {p.typical!r}, spread {p.spread!r}",
        "low <= typical <= high and 0 < spread < high - low",
        where,
    )
    default = p.default is None or (_is_number(p.default) and p.low <= p.default <= p.high)
    _require(default, f"{p.name}: default {p.default!r}", "None, or one from low to high", where)


def _require(right: bool, what: str, expected: str, where: str) -> None:
    if not right:
        raise ModelError(what, where=where, expected=expected)


def _is_name(name: object) -> bool:
    return isinstance(name, str) and NAME.fullmatch(name) is not None


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and math.isfinite(value)


def _is_si(unit: str) -> bool:
    try:
        return to_si(1.0, unit, unit) == 1.0
    except (UnknownUnit, TypeError, AttributeError):
        return False
