"""Several effects together, at each link of the chain from the pedal to the accelerometer.

Factors are multiplied, forces and moments are added. Pressures and readings pass through the
effects in their physical order, and last through those of the user.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from calib.base.arrays import Array
from calib.car.effects.catalogue import CALIPER, LINE, SENSOR, definition, every_effect
from calib.car.effects.effect import Pair, Parameters, acts_on
from calib.car.effects.effects import Effects, EmpiricalTerm
from calib.car.effects.empirical import effect_of
from calib.car.history import Motion, RunHistory
from calib.car.lag import low_pass
from calib.car.vehicle import Vehicle

_SHORTEST = 1e-6
"""Time constant [s] up to which an accelerometer has no lag: far less than a sample."""


def on_links(effects: Effects, links: tuple[str, ...]) -> Effects:
    """The effects and terms that act on one of these links.

    Raises ModelError for an unknown name.
    """
    names = (name for name in effects.names if acts_on(definition(effects, name), links))
    terms = tuple(term for term in effects.terms if acts_on(effect_of(term), links))
    return replace(effects.only(*names), terms=terms)


def not_sensed(effects: Effects) -> dict[str, str]:
    """The effects that an ECU cannot take out, with the signal that it lacks.

    A term is named by its place and driver. An effect of the user without its file counts as
    sensed.
    """
    every = every_effect(effects)
    reasons = {name: every[name].card.not_sensed for name in effects.names if name in every}
    reasons |= {_term(term): _DRIVERS.get(term.driver, "") for term in effects.terms}
    return {name: why for name, why in reasons.items() if why}


def sensed(effects: Effects) -> Effects:
    """The effects that an ECU can take out."""
    missing = not_sensed(effects)
    terms = tuple(term for term in effects.terms if _term(term) not in missing)
    return replace(effects.without(*missing), terms=terms)


_DRIVERS = {
    "temperature": "the temperature of the discs",
    "elapsed": "when the run began",
    "distance": "where the run began",
}
"""Signals that an ECU lacks, by the driver of a term."""


def _term(term: EmpiricalTerm) -> str:
    return f"{term.place}:{term.driver}"


def _hooks(
    effects: Effects, link: str, names: tuple[str, ...] | None = None
) -> Iterator[tuple[Callable[..., Any], Parameters]]:
    """Hooks on a link with their parameters: of these ``names``, or of all and then the terms."""
    pairs = [
        (definition(effects, name), effects.parameters[name])
        for name in (effects.names if names is None else names)
        if name in effects
    ]
    if names is None:
        pairs += [(effect_of(term), {}) for term in effects.terms]
    for effect, parameters in pairs:
        hook = getattr(effect, link)
        if hook is not None:
            yield hook, parameters


def as_driven(vehicle: Vehicle, effects: Effects) -> Vehicle:
    """Return the vehicle with mass, rolling radii and wheel inertias as the effects change them."""
    front, rear, mass = vehicle.front, vehicle.rear, vehicle.mass
    for radius, parameters in _hooks(effects, "radius"):
        R_f, R_r = radius(parameters)
        front, rear = front.with_radius(R_f), rear.with_radius(R_r)
    for inertia, parameters in _hooks(effects, "inertia"):
        front, rear = (
            replace(axle, wheel_inertia=axle.wheel_inertia + more)
            for axle, more in zip((front, rear), inertia(parameters), strict=True)
        )
    for factor, parameters in _hooks(effects, "mass"):
        mass *= factor(parameters)
    return replace(vehicle, front=front, rear=rear, mass=mass)


def line_pressure(effects: Effects, history: RunHistory) -> Pair:
    """Pressure [Pa] (n,) at the front and the rear wheels; reads only time and p_mc."""
    p_f = p_r = history.p_mc
    for hook, parameters in _hooks(effects, "pressure", LINE):
        p_f, p_r = hook(parameters, history, p_f, p_r)
    return p_f, p_r


def caliper_pressure(effects: Effects, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Pressure [Pa] (n,) that clamps the pads of one side, from its wheel pressures."""
    for hook, parameters in _hooks(effects, "pressure", (*CALIPER, *effects.user_defined)):
        p_f, p_r = hook(parameters, history, p_f, p_r)
    return p_f, p_r


def pad_factors(effects: Effects, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Factors [1] (n,) on the pad friction of one side at its caliper pressures [Pa] (n,).

    Raises ModelError for an empirical term without its temperature.
    """
    front, rear = np.ones_like(p_f), np.ones_like(p_r)
    for hook, parameters in _hooks(effects, "friction"):
        f, r = hook(parameters, history, p_f, p_r)
        front, rear = front * f, rear * r
    return front, rear


def wheel_factors(effects: Effects, history: RunHistory) -> dict[str, Array]:
    """Factors [1] (n,) on the torques of the wheels that differ from the other side, by wheel."""
    return _product(hook(own, history) for hook, own in _hooks(effects, "wheels"))


def wheel_speed_factors(vehicle: Vehicle, effects: Effects, motion: Motion) -> dict[str, Array]:
    """Factors [1] (n,) on the wheel speeds as read; only of wheels that an effect changes."""
    return _product(hook(vehicle, own, motion) for hook, own in _hooks(effects, "wheel_speed"))


def _product(several: Iterator[Mapping[str, Array]]) -> dict[str, Array]:
    factors: dict[str, Array] = {}
    for one in several:
        for w, factor in one.items():
            factors[w] = factors[w] * factor if w in factors else factor
    return factors


def total_load_shift(vehicle: Vehicle, effects: Effects, history: RunHistory) -> Array:
    """Sum of the load that is shifted from the front to the rear axle, over W [1] (n,)."""
    shifts = (hook(vehicle, own, history) for hook, own in _hooks(effects, "load_shift"))
    return np.asarray(sum(shifts, 0.0 * history.z))


def total_body_force(vehicle: Vehicle, effects: Effects, motion: Motion) -> Array:
    """Sum of the forces that slow the body directly [N] (n,)."""
    forces = (hook(vehicle, own, motion) for hook, own in _hooks(effects, "body_force"))
    return np.asarray(sum(forces, 0.0 * motion.v))


def total_axle_moment(vehicle: Vehicle, effects: Effects, motion: Motion) -> Pair:
    """Sum of the moments on the wheels besides the brake [N m per axle] (n,), front and rear."""
    front, rear = 0.0 * motion.v, 0.0 * motion.v
    for hook, parameters in _hooks(effects, "axle_moment"):
        f, r = hook(vehicle, parameters, motion)
        front, rear = front + f, rear + r
    return front, rear


def as_read(vehicle: Vehicle, effects: Effects, history: RunHistory, a_x: Array) -> Array:
    """Reading of the accelerometer [m/s^2] (n,) at the acceleration ``a_x`` [m/s^2] (n,)."""
    reading = as_sensed(vehicle, effects, history, a_x)
    for hook, parameters in _hooks(effects, "accelerometer_lag"):
        lag, second = hook(parameters)
        if lag > _SHORTEST:
            reading = low_pass(history.time, reading, lag, second)
    return reading


def as_sensed(vehicle: Vehicle, effects: Effects, history: RunHistory, a_x: Array) -> Array:
    """Reading of an accelerometer [m/s^2] (n,) that follows ``a_x`` [m/s^2] (n,) at once."""
    for hook, parameters in _hooks(effects, "accelerometer", (*SENSOR, *effects.user_defined)):
        a_x = hook(vehicle, parameters, history, a_x)
    return a_x


def accelerometer_lag(effects: Effects) -> float:
    """Time [s] by which a slow acceleration is read late."""
    return sum((hook(own)[0] for hook, own in _hooks(effects, "accelerometer_lag")), 0.0)


def reading_delay(effects: Effects, link: str) -> float:
    """Time [s] by which v (``speed_delay``) or all wheels (``wheel_speed_delay``) are read late."""
    return sum((hook(own) for hook, own in _hooks(effects, link)), 0.0)
