"""The hooks of an effect of the user's own, with every result checked.

A hook that raises, or whose result has another shape or is not finite, raises one ModelError that
names file and line. So a mistake in it is found wherever it shows, not only when it is loaded.
"""

import traceback
from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from functools import wraps
from typing import Any

import numpy as np

from calib.base.errors import ModelError
from calib.base.names import WHEELS
from calib.car.effects.effect import Array, Effect

PAIR, ONE, BY_WHEEL, TWO_NUMBERS, NUMBER = (
    "arrays for front and rear",
    "an array",
    f"a dict with one array for each of some wheels, of {', '.join(WHEELS)}",
    "two numbers",
    "a number",
)
RESULTS = {
    "pressure": PAIR,
    "friction": PAIR,
    "wheels": BY_WHEEL,
    "axle_moment": PAIR,
    "inertia": TWO_NUMBERS,
    "radius": TWO_NUMBERS,
    "load_shift": ONE,
    "body_force": ONE,
    "wheel_speed": BY_WHEEL,
    "mass": NUMBER,
    "accelerometer": ONE,
    "accelerometer_lag": TWO_NUMBERS,
    "speed_delay": NUMBER,
    "wheel_speed_delay": NUMBER,
}
"""What each hook returns; an array has one value for each sample."""


def hooks_of(effect: Effect) -> dict[str, Callable[..., Any]]:
    """The hooks that an effect has, by name."""
    own = {f.name: getattr(effect, f.name) for f in fields(effect) if f.name != "card"}
    return {name: hook for name, hook in own.items() if hook is not None}


def checked(effect: Effect, path: str) -> Effect:
    """The effect with hooks that raise ModelError where they go wrong; ``path`` of its file."""
    hooks: dict[str, Any] = {
        name: _checked(name, hook, path) for name, hook in hooks_of(effect).items()
    }
    return replace(effect, **hooks)


def _checked(name: str, hook: Callable[..., Any], path: str) -> Callable[..., Any]:
    @wraps(hook)
    def call(*given: Any) -> Any:
        try:
            with np.errstate(all="ignore"):
                result = hook(*given)
        except Exception as cause:
            raise raised(cause, path, f"{name} raises ") from cause
        shape = _shape(name, given)
        try:
            return _as_expected(result, RESULTS[name], shape)
        except (TypeError, ValueError) as cause:
            raise ModelError(
                f"{name} {cause}",
                where=at(path, line_of(hook)),
                expected=f"{RESULTS[name]}" + (f" of shape {shape}, finite" if shape else ""),
            ) from None

    return call


def raised(cause: BaseException, path: str, what: str = "") -> ModelError:
    """The error for an exception in a file of the user, at the line of the file where it rose."""
    lines = [f.lineno for f in traceback.extract_tb(cause.__traceback__) if f.filename == path]
    text = f"{what}{type(cause).__name__}: {cause}".strip(": ")
    return ModelError(text, where=at(path, lines[-1] if lines else None))


def at(path: str, line: int | None) -> str:
    """A place in a file of the user."""
    return path if line is None else f"{path}:{line}"


def line_of(hook: Callable[..., Any]) -> int | None:
    """The line where a function begins, None for what is no plain function."""
    code = getattr(hook, "__code__", None)
    return None if code is None else int(code.co_firstlineno)


def _shape(name: str, given: tuple[Any, ...]) -> tuple[int, ...]:
    """Shape of each array that a hook returns for these arguments; () for numbers."""
    if RESULTS[name] in (NUMBER, TWO_NUMBERS):
        return ()
    sample = {"wheels": 1, "accelerometer": 3}.get(name, 2)
    like = given[sample]
    return np.shape(like if isinstance(like, np.ndarray) else like.v)


def _as_expected(result: Any, expected: str, shape: tuple[int, ...]) -> Any:
    """The result as float arrays or numbers. Raises TypeError or ValueError saying what it is."""
    if expected == BY_WHEEL:
        if not isinstance(result, Mapping) or not set(result) <= set(WHEELS):
            raise TypeError(f"returns {_short(result)}")
        return {w: _array(values, shape) for w, values in result.items()}
    if expected in (ONE, NUMBER):
        array = _array(result, shape)
        return array if expected == ONE else float(array)
    if not isinstance(result, tuple | list) or len(result) != 2:
        raise TypeError(f"returns {_short(result)}")
    pair = tuple(_array(values, shape) for values in result)
    return pair if expected == PAIR else tuple(float(value) for value in pair)


def _array(values: Any, shape: tuple[int, ...]) -> Array:
    array = np.asarray(values)
    if array.dtype.kind not in "fiub":
        raise TypeError(f"returns {_short(values)}")
    if array.shape != shape:
        raise ValueError(f"returns shape {array.shape}")
    if not np.all(np.isfinite(array)):
        raise ValueError("returns values that are not finite")
    return np.asarray(array, dtype=np.float64)


def _short(result: Any) -> str:
    kind = type(result).__name__
    if isinstance(result, Mapping):
        return f"a {kind} with the keys {', '.join(map(repr, result)) or 'none'}"
    return f"a {kind} of {len(result)}" if isinstance(result, tuple | list) else f"a {kind}"
