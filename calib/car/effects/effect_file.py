"""Read an effect of the user: a Python file that defines ``EFFECT``, an `Effect`.

The file is executed with all rights of this process, see `brake-cal manual own_effects`. Each hook
is then tried on a braking. A hook that fails there or later raises a ModelError with file and line.
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

    A hook is a function of the effect; its link is the field of `Effect` where it acts.
    Raises ModelError, with the line, for a file that is missing, is not Python or raises an
    exception; for a missing ``EFFECT`` or an incomplete card; for a name that the catalogue has;
    and for a hook that raises, returns another shape or a number that is not finite, or has an
    effect at the neutral strength.
    """
    return tuple(map(_read, paths))


def _read(path: Path) -> OwnEffect:
    source = bytes_of(path, EFFECT, ModelError, "a Python file")
    effect = _executed(source, str(path)).get("EFFECT")
    if not (isinstance(effect, Effect) and isinstance(effect.card, Card)):
        expected = "EFFECT = Effect(card=Card(...), ...) at the top level"
        do = "see `brake-cal manual own_effects`"
        raise ModelError(f"EFFECT is {effect!r}", where=path, expected=expected, do=do)
    if effect.card.name in CATALOGUE or not effect.card.parameters:
        flaw = f"{effect.card.name!r} is an effect of the catalogue, or has no parameter"
        expected = "another name, and a first parameter that is its strength"
        raise ModelError(flaw, where=path, expected=expected)
    return OwnEffect(path.name, sha256(source), effect=checked(effect, str(path)))


def _executed(source: bytes, path: str) -> dict[str, Any]:
    """Execute a file and return the names that it defines. Its output goes to stderr."""
    names: dict[str, Any] = {"__name__": "own_effect", "__file__": path}
    try:
        with redirect_stdout(sys.stderr):
            exec(compile(source, path, "exec", dont_inherit=True), names)
    except (Exception, SystemExit) as cause:
        raise _raised(cause, path) from cause
    return names


def _raised(cause: BaseException, path: str, prefix: str = "") -> ModelError:
    """Return an error with the words of ``cause`` and the last line of the file that led to it."""
    frames = traceback.extract_tb(cause.__traceback__)
    lines = [frame.lineno for frame in frames if frame.filename == path]
    line = lines[-1] if lines else getattr(cause, "lineno", None)
    text = f"{prefix}{type(cause).__name__}: {getattr(cause, 'msg', cause)}".strip(": ")
    return ModelError(text, where=f"{path}:{line}" if line else path)


def checked(effect: Effect, path: str) -> Effect:
    """Return the effect of the file ``path`` with hooks that raise ModelError where they fail.

    Each hook is tried with the arguments of `trial`, at the typical and at the neutral strength.
    """
    links = [f.name for f in fields(effect) if f.name != "card"]
    hooks = {link: getattr(effect, link) for link in links if getattr(effect, link) is not None}
    if not hooks or not all(map(callable, hooks.values())):
        raise ModelError("a hook is no function", where=path, expected="one hook of Effect or more")
    strength, neutral = effect.card.parameters[0].name, float(effect.card.neutral)
    typical = {p.name: float(p.typical) for p in effect.card.parameters}
    guarded: dict[str, Any] = {link: _guarded(link, hook, path) for link, hook in hooks.items()}
    for link, hook in guarded.items():
        hook(*trial(link, typical))
        arguments = trial(link, {**typical, strength: neutral})
        unchanged, result = _NEUTRAL_HOOKS[link](*arguments), hook(*arguments)
        if isinstance(result, dict):  # a hook may return only some of the wheels
            unchanged, result = [unchanged[w] for w in result], list(result.values())
        if not np.allclose(unchanged, result, rtol=1e-9, atol=1e-9):
            flaw = f"{link} still does something at {strength} = {neutral:g}, the neutral strength"
            expected = "no effect there, for any value of other parameters"
            raise ModelError(flaw, where=_begin(path, hooks[link]), expected=expected)
    return replace(effect, **guarded)


_NEUTRAL_HOOKS: dict[str, Callable[..., Any]] = {
    "pressure": lambda parameters, history, p_f, p_r: (p_f, p_r),
    "friction": lambda parameters, history, p_f, p_r: (np.ones_like(p_f), np.ones_like(p_r)),
    "wheels": lambda parameters, history: {w: np.ones_like(history.v) for w in WHEELS},
    "axle_moment": lambda car, parameters, motion: (0.0 * motion.v, 0.0 * motion.v),
    "inertia": lambda parameters: (0.0, 0.0),
    "radius": lambda parameters: (1.0, 1.0),
    "load_shift": lambda car, parameters, history: 0.0 * history.v,
    "body_force": lambda car, parameters, motion: 0.0 * motion.v,
    "wheel_speed": lambda car, parameters, motion: {w: np.ones_like(motion.v) for w in WHEELS},
    "mass": lambda parameters: 1.0,
    "accelerometer": lambda car, parameters, history, a_x: a_x,
    "accelerometer_lag": lambda parameters: (0.0, 0.0),
    "speed_delay": lambda parameters: 0.0,
    "wheel_speed_delay": lambda parameters: 0.0,
}
"""For each link a hook that changes nothing. A hook of the user must take the same arguments, which
`trial` makes by their names here, and return a result of the same form."""


def _guarded(link: str, hook: Callable[..., Any], path: str) -> Callable[..., Any]:
    """Return the hook with a check of its result, which raises ModelError where the hook fails."""

    def call(*arguments: Any) -> Any:
        try:
            with np.errstate(all="ignore"):
                result = hook(*arguments)
        except Exception as cause:
            raise _raised(cause, path, f"{link} raises ") from cause
        example = _NEUTRAL_HOOKS[link](*arguments)
        try:
            return _like(example, result)
        except (AttributeError, KeyError, TypeError, ValueError):
            flaw = f"{link} returns {_form(result)}"
            expected = f"finite numbers in the form of {_form(example)}"
            raise ModelError(flaw, where=_begin(path, hook), expected=expected) from None

    return call


def _begin(path: str, hook: Callable[..., Any]) -> str:
    """Return file and first line of a hook; the file alone for a callable that is no function."""
    code = getattr(hook, "__code__", None)
    return f"{path}:{code.co_firstlineno}" if code else path


def _like(example: Any, result: Any) -> Any:
    """Return a result as numbers and arrays in the form of ``example``.

    Raises AttributeError, KeyError, TypeError or ValueError for a result in another form.
    """
    if isinstance(example, dict):  # by wheel
        return {w: _like(example[w], value) for w, value in result.items()}
    if isinstance(example, tuple):
        return tuple(_like(*pair) for pair in zip(example, result, strict=True))
    array = np.asarray(result, float)
    if array.shape != np.shape(example) or not np.all(np.isfinite(array)):
        raise ValueError
    return array if array.shape else float(array)


def _form(value: Any) -> str:
    if isinstance(value, tuple | list):
        return f"({', '.join(map(_form, value))})"
    if isinstance(value, dict):
        return f"a dict of {', '.join(map(str, value))}"
    return f"shape {np.shape(value)}" if isinstance(value, np.ndarray) else repr(value)


_FRONT = Axle(0.322, 1.2, 28.84e-4, 0.1309, 2, 0.38)  # Tables I and II of the paper
_REAR = Axle(0.322, 1.1, 11.34e-4, 0.124, 2, 0.38)
_CAR = Vehicle("trial", 1744.0, 1.1556, 1.6494, 0.615, 1.55, _FRONT, _REAR)


def trial(link: str, parameters: Mapping[str, float]) -> tuple[Any, ...]:
    """Return read-only arguments for a hook: a braking from 30 m/s to 0, released after 3 s.

    Speed and pressure need not fit each other: only the forms of results are checked.
    """
    time = np.linspace(0.0, 3.99, 400)
    v = 30.0 - 7.5 * time
    angle = np.cumsum(v) * 0.01 / _CAR.front.rolling_radius
    pedal = np.clip(time - 0.5, 0.0, 1.0) - np.clip(4.0 * (time - 3.0), 0.0, 1.0)
    p_mc = 40e5 * pedal + 1e3 * np.sin(50.0 * time)  # with noise, so below zero at first
    disc_temperatures = {"f": 150.0 + 60.0 * time, "r": 90.0 + 30.0 * time}
    history = replace(
        constant_speed(time, p_mc, 30.0, disc_temperatures, "trial"),
        v=v,
        z=0.018e-5 * p_mc,
        angle_f=angle,
        angle_r=angle,
        energy_f=60e3 * time,
        energy_r=20e3 * time,
    )
    motion = Motion(history.v, *axle_loads(_CAR, history.z), history)
    p_r, a_x = 0.8 * history.p_mc, -G * history.z
    for value in (p_r, a_x, *vars(motion).values(), *vars(history).values()):
        if isinstance(value, np.ndarray):
            value.flags.writeable = False
    arguments = {"car": _CAR, "parameters": dict(parameters), "history": history, "motion": motion}
    arguments |= {"p_f": history.p_mc, "p_r": p_r, "a_x": a_x}
    return tuple(arguments[name] for name in signature(_NEUTRAL_HOOKS[link]).parameters)
