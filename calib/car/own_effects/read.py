"""Read an effect of the user's own: a Python file with ``EFFECT``, as each of the catalogue has it.

The file is executed, with all that this process may do. See `brake-cal manual vehicle_file`.
"""

import ast
import sys
from collections.abc import Iterable
from contextlib import redirect_stdout
from hashlib import sha256
from pathlib import Path
from types import ModuleType

from calib.base.bounded import EFFECT, bytes_of
from calib.base.errors import ModelError
from calib.car.effects.effect import Effect
from calib.car.own_effects.card import check_card
from calib.car.own_effects.hooks import at, checked, hooks_of, line_of, raised
from calib.car.own_effects.own_effect import OwnEffect
from calib.car.own_effects.trial import changes, trial


def read_own_effects(paths: Iterable[Path]) -> tuple[OwnEffect, ...]:
    """Read a file for each effect, see `read_own_effect`."""
    return tuple(read_own_effect(path) for path in paths)


def read_own_effect(path: Path) -> OwnEffect:
    """Execute a Python file, and return its ``EFFECT`` with hooks that are checked.

    The hooks are called once for each end of each parameter, on a made run whose arrays cannot
    be changed in place.

    Raises ModelError, with file and line, for a file that is missing or not Python, raises, has no
    ``EFFECT`` or a card that is not complete; for a name of the catalogue; for a hook that raises,
    returns another shape or what is not finite, or does something at the neutral strength.
    """
    source, path = _source(Path(path)), Path(path)
    module = _executed(source, str(path))
    effect = getattr(module, "EFFECT", None)
    if not isinstance(effect, Effect):
        raise ModelError(
            "no EFFECT" if effect is None else f"EFFECT is a {type(effect).__name__}",
            where=path,
            expected="EFFECT = Effect(card=Card(...), ...) at the top level",
            do="see `brake-cal manual vehicle_file`",
        )
    check_card(effect, at(str(path), _line_of_card(source)))
    guarded = checked(effect, str(path))
    _try(guarded, str(path))
    return OwnEffect(file=path.name, sha256=sha256(source).hexdigest(), effect=guarded)


def _source(path: Path) -> bytes:
    return bytes_of(path, EFFECT, ModelError, "a Python file")


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


def _line_of_card(source: bytes) -> int | None:
    """The first line where ``Card(`` is called."""
    calls = [node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Call)]
    lines = [c.lineno for c in calls if isinstance(c.func, ast.Name) and c.func.id == "Card"]
    return min(lines, default=None)


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
