"""All effects of a car together, at each link of the chain in `calib.car.effects.effect`.

Factors are multiplied, forces and moments are added. Pressures and readings pass through the
effects one after the other: in the physical order of the catalogue, then effects of the user.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from calib.base.arrays import Array
from calib.car.effects import catalogue
from calib.car.effects.catalogue import all_effects, definition
from calib.car.effects.effect import Effect, Pair, Parameters, acts_on
from calib.car.effects.effects import Effects, EmpiricalTerm
from calib.car.effects.empirical import effect_of
from calib.car.history import Motion, RunHistory
from calib.car.lag import low_pass
from calib.car.vehicle import Vehicle

_NO_LAG = 1e-6  # time constant [s] that counts as no lag: far less than a sample time

_NOT_SENSED = {
    "temperature": "the temperature of the discs",
    "elapsed": "when the run began",
    "distance": "where the run began",
}
"""Signal that an ECU lacks, by the driver of an empirical term."""


def on_links(effects: Effects, links: tuple[str, ...]) -> Effects:
    """Return the effects and terms on these links. Raises ModelError for an unknown effect."""
    names = (name for name in effects.names if acts_on(definition(effects, name), links))
    terms = tuple(term for term in effects.terms if acts_on(effect_of(term), links))
    return replace(effects.only(*names), terms=terms)


def not_sensed(effects: Effects) -> dict[str, str]:
    """Return the signal that an ECU lacks, by effect or term that the ECU cannot take out.

    An effect of the user whose file was not given is left out.
    """
    by_name = all_effects(effects)
    signals = {name: by_name[name].card.not_sensed for name in effects.names if name in by_name}
    signals |= {_name_of(term): _NOT_SENSED.get(term.driver, "") for term in effects.terms}
    return {name: signal for name, signal in signals.items() if signal}


def sensed(effects: Effects) -> Effects:
    """Return the effects that an ECU can take out."""
    excluded = not_sensed(effects)
    terms = tuple(term for term in effects.terms if _name_of(term) not in excluded)
    return replace(effects.without(*excluded), terms=terms)


def _name_of(term: EmpiricalTerm) -> str:
    return f"{term.place}:{term.driver}"


def _hooks(
    effects: Effects, link: str, names: tuple[str, ...] | None = None
) -> Iterator[tuple[Callable[..., Any], Parameters]]:
    """Yield the hooks on a link, each with the parameters of its effect.

    ``names`` are effects in the order in which they act, by default all effects and then the terms.
    """
    acting_names = effects.names if names is None else [name for name in names if name in effects]
    acting: list[tuple[Effect, Parameters]] = [
        (definition(effects, name), effects.parameters[name]) for name in acting_names
    ]
    if names is None:
        acting += [(effect_of(term), {}) for term in effects.terms]
    for effect, parameters in acting:
        hook = getattr(effect, link)
        if hook is not None:
            yield hook, parameters


def as_driven(vehicle: Vehicle, effects: Effects) -> Vehicle:
    """Return the vehicle with mass, rolling radii and wheel inertias as the effects change them."""
    front, rear, mass = vehicle.front, vehicle.rear, vehicle.mass
    for radius, parameters in _hooks(effects, "radius"):
        factor_f, factor_r = radius(parameters)
        front, rear = front.with_radius(factor_f), rear.with_radius(factor_r)
    for inertia, parameters in _hooks(effects, "inertia"):
        extra_f, extra_r = inertia(parameters)
        front = replace(front, wheel_inertia=front.wheel_inertia + extra_f)
        rear = replace(rear, wheel_inertia=rear.wheel_inertia + extra_r)
    for mass_factor, parameters in _hooks(effects, "mass"):
        mass *= mass_factor(parameters)
    return replace(vehicle, front=front, rear=rear, mass=mass)


def line_pressure(effects: Effects, history: RunHistory) -> Pair:
    """Pressure [Pa] (n,) at the front and the rear wheels, before the calipers."""
    p_f = p_r = history.p_mc
    for hook, parameters in _hooks(effects, "pressure", catalogue.LINE_EFFECTS):
        p_f, p_r = hook(parameters, history, p_f, p_r)
    return p_f, p_r


def caliper_pressure(effects: Effects, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Clamping pressure [Pa] (n,) of the front and the rear pads, from the wheel pressures."""
    names = (*catalogue.CALIPER_EFFECTS, *effects.user_defined)
    for hook, parameters in _hooks(effects, "pressure", names):
        p_f, p_r = hook(parameters, history, p_f, p_r)
    return p_f, p_r


def pad_factors(effects: Effects, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Factors [1] (n,) on front and rear pad friction at the clamping pressures [Pa] (n,).

    Raises ModelError for an empirical term over a temperature that is not known.
    """
    front, rear = np.ones_like(p_f), np.ones_like(p_r)
    for hook, parameters in _hooks(effects, "friction"):
        factor_f, factor_r = hook(parameters, history, p_f, p_r)
        front, rear = front * factor_f, rear * factor_r
    return front, rear


def wheel_factors(effects: Effects, history: RunHistory) -> dict[str, Array]:
    """Factors [1] (n,) on brake torques by wheel, for the wheels of axles whose sides differ."""
    return _product(hook(parameters, history) for hook, parameters in _hooks(effects, "wheels"))


def wheel_speed_factors(vehicle: Vehicle, effects: Effects, motion: Motion) -> dict[str, Array]:
    """Factors [1] (n,) on the wheel speeds as read, by wheel; only of wheels that are changed."""
    hooks = _hooks(effects, "wheel_speed")
    return _product(hook(vehicle, parameters, motion) for hook, parameters in hooks)


def _product(mappings: Iterator[Mapping[str, Array]]) -> dict[str, Array]:
    product: dict[str, Array] = {}
    for factors in mappings:
        for w, factor in factors.items():
            product[w] = product[w] * factor if w in product else factor
    return product


def total_load_shift(vehicle: Vehicle, effects: Effects, history: RunHistory) -> Array:
    """Sum of the loads that are shifted from the front to the rear axle, over W [1] (n,)."""
    hooks = _hooks(effects, "load_shift")
    shifts = (hook(vehicle, parameters, history) for hook, parameters in hooks)
    return np.asarray(sum(shifts, 0.0 * history.z))


def total_body_force(vehicle: Vehicle, effects: Effects, motion: Motion) -> Array:
    """Sum of the forces that slow the body directly [N] (n,)."""
    hooks = _hooks(effects, "body_force")
    forces = (hook(vehicle, parameters, motion) for hook, parameters in hooks)
    return np.asarray(sum(forces, 0.0 * motion.v))


def total_axle_moment(vehicle: Vehicle, effects: Effects, motion: Motion) -> Pair:
    """Sum of the moments on the wheels besides the brake [N m per axle] (n,), front and rear."""
    front, rear = 0.0 * motion.v, 0.0 * motion.v
    for hook, parameters in _hooks(effects, "axle_moment"):
        moment_f, moment_r = hook(vehicle, parameters, motion)
        front, rear = front + moment_f, rear + moment_r
    return front, rear


def as_read(vehicle: Vehicle, effects: Effects, history: RunHistory, a_x: Array) -> Array:
    """Reading of the accelerometer [m/s^2] (n,), with its lag, at the true ``a_x`` (n,)."""
    reading = as_sensed(vehicle, effects, history, a_x)
    for hook, parameters in _hooks(effects, "accelerometer_lag"):
        T, S = hook(parameters)  # of S a'' + T a' + a = b
        if T > _NO_LAG:
            reading = low_pass(history.time, reading, T, S)
    return reading


def as_sensed(vehicle: Vehicle, effects: Effects, history: RunHistory, a_x: Array) -> Array:
    """Reading of an accelerometer without lag [m/s^2] (n,) at the true ``a_x`` (n,)."""
    names = (*catalogue.SENSOR_EFFECTS, *effects.user_defined)
    for hook, parameters in _hooks(effects, "accelerometer", names):
        a_x = hook(vehicle, parameters, history, a_x)
    return a_x


def accelerometer_lag(effects: Effects) -> float:
    """Time [s] by which a slow acceleration is read late: the sum of T of `Effect`."""
    hooks = _hooks(effects, "accelerometer_lag")
    return sum((time_constants(parameters)[0] for time_constants, parameters in hooks), 0.0)


def reading_delay(effects: Effects, link: str) -> float:
    """Time [s] by which v (``speed_delay``) or all wheels (``wheel_speed_delay``) are read late."""
    return sum((delay(parameters) for delay, parameters in _hooks(effects, link)), 0.0)
