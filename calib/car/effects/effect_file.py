"""Read an effect of the user's own: a Python file with ``EFFECT``, as the catalogue has them.

The file is executed with all rights of this process, see `brake-cal manual own_effects`. A hook
that fails, in a trial when it is loaded or later, raises one ModelError with file and line.
"""

import sys
import traceback
from collections.abc import Callable, Iterable, Mapping
from contextlib import redirect_stdout
from dataclasses import fields, replace
from inspect import signature
from pathlib import Path
from typing import Any

import numpy as np

from calib.base.bounded import EFFECT, bytes_of
from calib.base.digest import sha256
from calib.base.errors import ModelError
from calib.base.names import WHEELS, G
from calib.car.effects.catalogue import CATALOGUE, OwnEffect
from calib.car.effects.effect import Card, Effect
from calib.car.forces import axle_loads
from calib.car.history import Motion, constant_speed
from calib.car.vehicle import Axle, Vehicle


def read_own_effects(paths: Iterable[Path]) -> tuple[OwnEffect, ...]:
    """Execute Python files, and return the ``EFFECT`` of each with hooks that are checked.

    Raises ModelError, with the line, for a file that is missing, is not Python, raises, or has no
    ``EFFECT`` or an incomplete card; for a name of the catalogue; for a hook that raises, returns
    another form or a number that is not finite, or acts at its neutral strength.
    """
    return tuple(map(_read, paths))


def _read(path: Path) -> OwnEffect:
    source = bytes_of(path, EFFECT, ModelError, "a Python file")
    effect = _executed(source, str(path)).get("EFFECT")
    if not (isinstance(effect, Effect) and isinstance(effect.card, Card)):
        raise ModelError(
            f"EFFECT is {effect!r}",
            where=path,
            expected="EFFECT = Effect(card=Card(...), ...) at the top level",
            do="see `brake-cal manual own_effects`",
        )
    if effect.card.name in CATALOGUE or not effect.card.parameters:
        raise ModelError(
            f"{effect.card.name!r} is an effect of the catalogue, or has no parameter",
            where=path,
            expected="another name, and a first parameter that is its strength",
        )
    return OwnEffect(path.name, sha256(source), effect=checked(effect, str(path)))


def _executed(source: bytes, path: str) -> dict[str, Any]:
    """The names that a file defines. What it prints goes to stderr."""
    names: dict[str, Any] = {"__name__": "own_effect", "__file__": path}
    try:
        with redirect_stdout(sys.stderr):
            exec(compile(source, path, "exec", dont_inherit=True), names)
    except (Exception, SystemExit) as cause:
        raise _raised(cause, path) from cause
    return names


def _raised(cause: BaseException, path: str, prefix: str = "") -> ModelError:
    """The error for an exception in a file of the user, with the line of that file."""
    lines = [f.lineno for f in traceback.extract_tb(cause.__traceback__) if f.filename == path]
    line = lines[-1] if lines else getattr(cause, "lineno", None)
    text = f"{prefix}{type(cause).__name__}: {getattr(cause, 'msg', cause)}".strip(": ")
    return ModelError(text, where=f"{path}:{line}" if line else path)


def checked(effect: Effect, path: str) -> Effect:
    """The effect of the file ``path`` with hooks that raise ModelError where they fail.

    Each is tried in a `trial`, at the typical and at the neutral strength.
    """
    every = {f.name: getattr(effect, f.name) for f in fields(effect) if f.name != "card"}
    hooks = {name: hook for name, hook in every.items() if hook is not None}
    if not hooks or not all(map(callable, hooks.values())):
        raise ModelError("a hook is no function", where=path, expected="one hook of Effect or more")
    strength, neutral = effect.card.parameters[0].name, float(effect.card.neutral)
    typical = {p.name: float(p.typical) for p in effect.card.parameters}
    guarded: dict[str, Any] = {n: _guarded(n, hook, path) for n, hook in hooks.items()}
    for name, hook in guarded.items():
        hook(*trial(name, typical))
        arguments = trial(name, {**typical, strength: neutral})
        nothing, result = _NOTHING[name](*arguments), hook(*arguments)
        if isinstance(result, dict):
            nothing, result = [nothing[w] for w in result], [*result.values()]
        if not np.allclose(nothing, result, rtol=1e-9, atol=1e-9):
            raise ModelError(
                f"{name} still does something at {strength} = {neutral:g}, the neutral strength",
                where=_begin(path, hooks[name]),
                expected="no effect there, for any value of other parameters",
            )
    return replace(effect, **guarded)


def _on_wheels(like: Any) -> dict[str, Any]:
    return {w: np.ones(np.shape(like)) for w in WHEELS}


_NOTHING: dict[str, Callable[..., Any]] = {
    "pressure": lambda own, history, p_f, p_r: (p_f, p_r),
    "friction": lambda own, history, p_f, p_r: (np.ones_like(p_f), np.ones_like(p_r)),
    "wheels": lambda own, history: _on_wheels(history.v),
    "axle_moment": lambda car, own, motion: (np.zeros_like(motion.v), np.zeros_like(motion.v)),
    "inertia": lambda own: (0.0, 0.0),
    "radius": lambda own: (1.0, 1.0),
    "load_shift": lambda car, own, history: np.zeros_like(history.v),
    "body_force": lambda car, own, motion: np.zeros_like(motion.v),
    "wheel_speed": lambda car, own, motion: _on_wheels(motion.v),
    "mass": lambda own: 1.0,
    "accelerometer": lambda car, own, history, a_x: a_x,
    "accelerometer_lag": lambda own: (0.0, 0.0),
    "speed_delay": lambda own: 0.0,
    "wheel_speed_delay": lambda own: 0.0,
}
"""Each hook without effect: its arguments, and the form of its result."""


def _guarded(name: str, hook: Callable[..., Any], path: str) -> Callable[..., Any]:
    def call(*arguments: Any) -> Any:
        try:
            with np.errstate(all="ignore"):
                result = hook(*arguments)
        except Exception as cause:
            raise _raised(cause, path, f"{name} raises ") from cause
        nothing = _NOTHING[name](*arguments)
        try:
            return _like(nothing, result)
        except (AttributeError, KeyError, TypeError, ValueError):
            raise ModelError(
                f"{name} returns {_form(result)}",
                where=_begin(path, hook),
                expected=f"finite numbers in the form of {_form(nothing)}",
            ) from None

    return call


def _begin(path: str, hook: Callable[..., Any]) -> str:
    """The line of a file where a function begins."""
    code = getattr(hook, "__code__", None)
    return f"{path}:{code.co_firstlineno}" if code else path


def _like(nothing: Any, result: Any) -> Any:
    """A result in the form of ``nothing``. Raises an error of Python for another form."""
    if isinstance(nothing, dict):
        return {w: _like(nothing[w], value) for w, value in result.items()}
    if isinstance(nothing, tuple):
        return tuple(_like(*pair) for pair in zip(nothing, result, strict=True))
    array = np.asarray(result, float)
    if array.shape != np.shape(nothing) or not np.all(np.isfinite(array)):
        raise ValueError
    return array if array.shape else float(array)


def _form(value: Any) -> str:
    if isinstance(value, tuple | list):
        return f"({', '.join(map(_form, value))})"
    if isinstance(value, dict):
        return f"a dict of {', '.join(map(str, value))}"
    return f"shape {np.shape(value)}" if isinstance(value, np.ndarray) else repr(value)


_CAR = Vehicle(
    *("trial", 1744.0, 1.1556, 1.6494, 0.615, 1.55),
    front=Axle(0.322, 1.2, 28.84e-4, 0.1309, 2, 0.38),
    rear=Axle(0.322, 1.1, 11.34e-4, 0.124, 2, 0.38),
)
"""Tables I and II of the paper."""


def trial(hook: str, parameters: Mapping[str, float]) -> tuple[Any, ...]:
    """Arguments of a hook in a braking from 30 m/s to a stand, released at 3 s; read-only."""
    time = np.linspace(0.0, 3.99, 400)
    v = 30.0 - 7.5 * time
    angle = np.cumsum(v) * 0.01 / _CAR.front.rolling_radius
    pedal = np.clip(time - 0.5, 0.0, 1.0) - np.clip(4.0 * (time - 3.0), 0.0, 1.0)
    pressed = 40e5 * pedal + 1e3 * np.sin(50.0 * time)  # noise: below zero at first
    discs = {"f": 150.0 + 60.0 * time, "r": 90.0 + 30.0 * time}
    history = replace(
        constant_speed(time, pressed, 30.0, discs, "trial"),
        v=v,
        z=0.018e-5 * pressed,
        angle_f=angle,
        angle_r=angle,
        energy_f=60e3 * time,
        energy_r=20e3 * time,
    )
    motion = Motion(history.v, *axle_loads(_CAR, history.z), history)
    rear, a_x = 0.8 * history.p_mc, -G * history.z
    for array in (rear, a_x, *vars(motion).values(), *vars(history).values()):
        if isinstance(array, np.ndarray):
            array.flags.writeable = False
    arguments = {"car": _CAR, "own": dict(parameters), "history": history, "motion": motion}
    arguments |= {"p_f": history.p_mc, "p_r": rear, "a_x": a_x}
    return tuple(arguments[name] for name in signature(_NOTHING[hook]).parameters)
