"""Read an effect of the user's own: a Python file with ``EFFECT``, as the catalogue has them.

The file is executed, with all that this process may do. See `brake-cal manual vehicle_file`.
"""

import math
import re
import sys
from collections.abc import Iterable, Iterator
from contextlib import redirect_stdout
from hashlib import sha256
from pathlib import Path
from types import ModuleType
from typing import Any

from calib.base.bounded import EFFECT, bytes_of
from calib.base.errors import ModelError
from calib.base.units import QUANTITIES
from calib.car.effects.catalogue import CATALOGUE
from calib.car.effects.effect import Card, Effect, Parameter
from calib.car.own_effects.hooks import at, changes, checked, hooks_of, line_of, raised, trial
from calib.car.own_effects.own_effect import OwnEffect

_NAME = re.compile(r"[a-z][a-z0-9_]*")
"""What an effect and a parameter may be called: a key of a model file."""


def read_own_effects(paths: Iterable[Path]) -> tuple[OwnEffect, ...]:
    """Read a file for each effect, see `read_own_effect`."""
    return tuple(read_own_effect(path) for path in paths)


def read_own_effect(path: Path) -> OwnEffect:
    """Execute a Python file, and return its ``EFFECT`` with hooks that are checked.

    The hooks are called once for each end of each parameter, on a made run whose arrays cannot
    be changed in place.

    Raises ModelError, with its line where it has one, for a file that is missing or not Python,
    raises, has no ``EFFECT`` or a card that is not complete; for a name of the catalogue; for a
    hook that raises, returns another shape or what is not finite, or does something at nothing.
    """
    path = Path(path)
    source = bytes_of(path, EFFECT, ModelError, "a Python file")
    effect = getattr(_executed(source, str(path)), "EFFECT", None)
    if not isinstance(effect, Effect):
        raise ModelError(
            "no EFFECT" if effect is None else f"EFFECT is a {type(effect).__name__}",
            where=path,
            expected="EFFECT = Effect(card=Card(...), ...) at the top level",
            do="see `brake-cal manual vehicle_file`",
        )
    for what, expected in _mistakes(effect):
        raise ModelError(what, where=path, expected=expected)
    guarded = checked(effect, str(path))
    _try(guarded, str(path))
    return OwnEffect(file=path.name, sha256=sha256(source).hexdigest(), effect=guarded)


def _executed(source: bytes, path: str) -> ModuleType:
    """The module of a file. What it prints goes to stderr: stdout is that of the command."""
    module = ModuleType("own_effect")
    vars(module)["__file__"] = path
    try:
        code = compile(source, path, "exec", dont_inherit=True)
    except SyntaxError as cause:
        raise ModelError(f"not Python: {cause.msg}", where=at(path, cause.lineno)) from cause
    except ValueError as cause:  # null bytes
        raise ModelError(f"not Python: {cause}", where=path) from cause
    except (RecursionError, MemoryError) as cause:
        raise ModelError("not Python: it is nested too deep", where=path) from cause
    try:
        with redirect_stdout(sys.stderr):
            exec(code, vars(module))
    except (Exception, SystemExit) as cause:
        raise raised(cause, path) from cause
    return module


def _mistakes(effect: Effect) -> Iterator[tuple[str, str]]:
    """What is wrong in a card and what was expected, one by one: each rests on those before."""
    card: Any = effect.card
    if not isinstance(card, Card):
        yield f"the card is a {type(card).__name__}", "a Card"
    if not _is_name(card.name):
        yield f"name {card.name!r}", "lower case letters, digits, _"
    if card.name in CATALOGUE:
        yield f"the catalogue has an effect {card.name!r}", "another name"
    for part in ("cause", "equation", "source", "looks_like"):
        text = getattr(card, part)
        if not (isinstance(text, str) and text.strip()):
            yield f"{part} {text!r}", "a sentence"
    parts = card.parameters
    if not (isinstance(parts, tuple) and parts and all(isinstance(p, Parameter) for p in parts)):
        yield "parameters of the card", "a tuple of one Parameter or more"
    for p in parts:
        yield from _mistakes_of(p)
    if len({p.name for p in parts}) < len(parts):
        yield "two parameters of one name", "other names"
    strength, neutral = parts[0], card.neutral
    if not (_is_number(neutral) and strength.low <= neutral <= strength.high):
        ends = f"{strength.low:g} to {strength.high:g}, the range of {strength.name}"
        yield f"neutral {neutral!r}", f"a strength from {ends}"
    if strength.typical == neutral:
        what = f"typical {neutral:g} of {strength.name} is the neutral strength"
        yield what, "a typical strength that does something"
    if not hooks_of(effect):
        yield "the effect has no function", "one hook of Effect"
    for name, hook in hooks_of(effect).items():
        if not callable(hook):
            yield f"{name} is a {type(hook).__name__}", "a function"


def _mistakes_of(p: Parameter) -> Iterator[tuple[str, str]]:
    if not _is_name(p.name):
        yield f"parameter {p.name!r}", "lower case letters, digits, _"
    if not (isinstance(p.unit, str) and p.unit in QUANTITIES):
        yield f"unit {p.unit!r} of {p.name}", 'an SI unit, such as "N*m"'
    numbers = all(map(_is_number, (p.low, p.high, p.typical, p.spread)))
    if not (numbers and p.low <= p.typical <= p.high and 0.0 < p.spread < p.high - p.low):
        ends = f"low {p.low!r}, high {p.high!r}, typical {p.typical!r}, spread {p.spread!r}"
        yield f"{p.name}: {ends}", "low <= typical <= high and 0 < spread < high - low"
    if p.default is not None and not (_is_number(p.default) and p.low <= p.default <= p.high):
        yield f"{p.name}: default {p.default!r}", "None, or one from low to high"


def _is_name(name: object) -> bool:
    return isinstance(name, str) and _NAME.fullmatch(name) is not None


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and math.isfinite(value)


def _try(effect: Effect, path: str) -> None:
    """Call every hook at its typical parameters, at their ends and at nothing."""
    strength = effect.card.parameters[0]
    typical = {p.name: float(p.typical) for p in effect.card.parameters}
    at_ends = [
        {**typical, p.name: float(end)} for p in effect.card.parameters for end in (p.low, p.high)
    ]
    for name, hook in hooks_of(effect).items():
        for parameters in (typical, *at_ends):
            hook(*trial(name, parameters))
        given = trial(name, {**typical, strength.name: float(effect.card.neutral)})
        if changes(name, given, hook(*given)):
            raise ModelError(
                f"{name} still does something at {strength.name} = {effect.card.neutral:g}, "
                "the neutral strength",
                where=at(path, line_of(hook)),
                expected="no effect there, for any value of other parameters",
            )
