"""The hooks of an effect of the user's own, with every result checked, and a run to try them on.

A hook that raises, or whose result has another shape or is not finite, raises one ModelError that
names file and line. So a mistake in it is found wherever it shows, not only when it is loaded.
"""

import traceback
from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from functools import wraps
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calib.base.arrays import Array
from calib.base.errors import ModelError
from calib.base.names import WHEELS, G
from calib.car.effects.effect import Effect
from calib.car.forces import axle_loads
from calib.car.history import Motion, RunHistory, constant_speed
from calib.car.vehicle import Axle, Vehicle

_ARRAYS = {
    "an array": ("load_shift", "body_force", "accelerometer"),
    "arrays for front and rear": ("pressure", "friction", "axle_moment"),
    f"a dict with one array for each of some wheels, of {', '.join(WHEELS)}": (
        "wheels",
        "wheel_speed",
    ),
}
_NUMBERS = {
    "a number": ("mass", "speed_delay", "wheel_speed_delay"),
    "two numbers": ("inertia", "radius", "accelerometer_lag"),
}
RESULTS = {hook: kind for kind, hooks in (_ARRAYS | _NUMBERS).items() for hook in hooks}
"""What each hook returns; an array has one value for each sample."""

_FACTORS = ("friction", "wheels", "radius", "wheel_speed", "mass")
"""Hooks that return factors: a link does not change at one, and else at zero."""

_TOLERANCE = 1e-9
"""Largest change, relative to one or to the value itself, that counts as rounding."""

_CAR = Vehicle(
    name="trial",
    mass=1744.0,
    cg_to_front_axle=1.1556,
    cg_to_rear_axle=1.6494,
    cg_height=0.615,
    track_width=1.55,
    front=Axle(0.322, 1.2, 28.84e-4, 0.1309, 2, 0.38),
    rear=Axle(0.322, 1.1, 11.34e-4, 0.124, 2, 0.38),
)
"""Tables I and II of the paper."""


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
    if RESULTS[name] in _NUMBERS:
        return ()
    like = given[{"wheels": 1, "accelerometer": 3}.get(name, 2)]
    return np.shape(like if isinstance(like, np.ndarray) else like.v)


def _as_expected(result: Any, expected: str, shape: tuple[int, ...]) -> Any:
    """The result as float arrays or numbers. Raises TypeError or ValueError saying what it is."""
    several = expected.startswith(("arrays", "two"))
    if expected.startswith("a dict"):
        if not isinstance(result, Mapping) or not set(result) <= set(WHEELS):
            raise TypeError(f"returns {_short(result)}")
        return {w: _array(values, shape) for w, values in result.items()}
    if several and not (isinstance(result, tuple | list) and len(result) == 2):
        raise TypeError(f"returns {_short(result)}")
    parts = tuple(_array(values, shape) for values in (result if several else (result,)))
    values = parts if shape else tuple(float(part) for part in parts)
    return values if several else values[0]


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
    return f"a {kind} of {len(result)}" if isinstance(result, tuple | list | dict) else f"a {kind}"


def trial(hook: str, parameters: Mapping[str, float]) -> tuple[Any, ...]:
    """What a hook is called with: braking from 30 m/s to a stand, released at 3 s; read-only."""
    history = _history()
    load_f, load_r = axle_loads(_CAR, history.z)
    motion = Motion(history.v, _fixed(load_f), _fixed(load_r), history)
    own = dict(parameters)
    if hook in ("pressure", "friction"):
        return own, history, history.p_mc, _fixed(0.8 * history.p_mc)
    if hook in ("axle_moment", "body_force", "wheel_speed"):
        return _CAR, own, motion
    if hook == "accelerometer":
        return _CAR, own, history, _fixed(-G * history.z)
    if hook == "load_shift":
        return _CAR, own, history
    return (own, history) if hook == "wheels" else (own,)


def changes(hook: str, given: tuple[Any, ...], result: Any) -> bool:
    """Whether the ``result`` of a hook changes the link on which it acts."""
    if hook == "pressure":
        before = given[2:]
    elif hook == "accelerometer":
        before = given[3:]
    else:
        before = (1.0 if hook in _FACTORS else 0.0,) * 4
    values = result.values() if isinstance(result, Mapping) else result
    several = isinstance(result, Mapping | tuple)
    pairs = zip(values if several else (result,), before, strict=False)
    return any(not np.allclose(*pair, rtol=_TOLERANCE, atol=_TOLERANCE) for pair in pairs)


def _history() -> RunHistory:
    time = _fixed(np.arange(400) * 0.01)
    v = _fixed(30.0 - 7.5 * time)
    angle = _fixed(np.cumsum(v) * 0.01 / _CAR.front.rolling_radius)
    held = np.clip(time - 0.5, 0.0, 1.0) - np.clip(4.0 * (time - 3.0), 0.0, 1.0)
    pressed = _fixed(40e5 * held + 1e3 * np.sin(50.0 * time))  # noise: below zero at first
    discs = {"f": _fixed(150.0 + 60.0 * time), "r": _fixed(90.0 + 30.0 * time)}
    return replace(
        constant_speed(time, pressed, 30.0, discs, "trial"),
        v=v,
        z=_fixed(0.018e-5 * pressed),
        angle_f=angle,
        angle_r=angle,
        energy_f=_fixed(60e3 * time),
        energy_r=_fixed(20e3 * time),
    )


def _fixed(values: NDArray[Any]) -> Array:
    """A copy that cannot be changed in place."""
    out = np.array(values, dtype=np.float64)
    out.flags.writeable = False
    return out
