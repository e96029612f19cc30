"""Several effects together, at each link of the chain from the pedal to the accelerometer.

Each function uses only the effects that act on its link. Factors are multiplied, forces and
moments are added; pressures and readings pass through the effects in the order of the catalogue,
then through the user's own: a pressure in the caliper, a reading at the end.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from calib.car.effects.catalogue import CALIPER, LINE, SENSOR
from calib.car.effects.effect import Array, Effect, Pair, Parameters
from calib.car.effects.effects import Effects
from calib.car.effects.empirical import effect_of
from calib.car.history import Motion, RunHistory
from calib.car.lag import low_pass
from calib.car.own_effects.own_effect import definition
from calib.car.vehicle import Axle, Vehicle

SHORTEST = 1e-6
"""Time constant [s] up to which an accelerometer follows at once: far less than a sample."""


def chosen(effects: Effects, test: Callable[[Effect], bool]) -> Effects:
    """The effects, terms among them, that pass a test. Raises ModelError for an unknown name."""
    kept = effects.only(*(name for name in effects.names if test(definition(effects, name))))
    return replace(kept, terms=tuple(term for term in effects.terms if test(effect_of(term))))


def as_driven(vehicle: Vehicle, effects: Effects) -> Vehicle:
    """Return the vehicle with mass, rolling radii and wheel inertias as the effects change them.

    Its list of effects is not changed.
    """
    front, rear, mass = vehicle.front, vehicle.rear, vehicle.mass
    for effect, parameters in _all(effects):
        if effect.radius is not None:
            R_f, R_r = effect.radius(parameters)
            front, rear = front.with_radius(R_f), rear.with_radius(R_r)
        if effect.inertia is not None:
            J_f, J_r = effect.inertia(parameters)
            front, rear = _with_inertia(front, J_f), _with_inertia(rear, J_r)
        if effect.mass is not None:
            mass *= effect.mass(parameters)
    return replace(vehicle, front=front, rear=rear, mass=mass)


def _with_inertia(axle: Axle, more: float) -> Axle:
    return replace(axle, wheel_inertia=axle.wheel_inertia + more)


def line_pressure(effects: Effects, history: RunHistory) -> Pair:
    """Pressure [Pa] (n,) that reaches the front and the rear wheels from ``history.p_mc``.

    Reads ``time`` and ``p_mc`` of the history only: the pressure does not depend on the motion.
    """
    return _through(LINE, effects, history, history.p_mc, history.p_mc)


def caliper_pressure(effects: Effects, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Pressure [Pa] (n,) that clamps the pads of one side, from its wheel pressures [Pa] (n,)."""
    return _through((*CALIPER, *effects.own), effects, history, p_f, p_r)


def _through(
    order: tuple[str, ...], effects: Effects, history: RunHistory, p_f: Array, p_r: Array
) -> Pair:
    for effect, parameters in _in_order(effects, order):
        if effect.pressure is not None:
            p_f, p_r = effect.pressure(parameters, history, p_f, p_r)
    return p_f, p_r


def pad_factors(effects: Effects, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Factors [1] (n,) on the pad friction of one side at its caliper pressures [Pa] (n,).

    Raises ModelError where an empirical term needs a temperature that is not known.
    """
    front, rear = np.ones_like(p_f), np.ones_like(p_r)
    for effect, parameters in _all(effects):
        if effect.friction is not None:
            f, r = effect.friction(parameters, history, p_f, p_r)
            front, rear = front * f, rear * r
    return front, rear


def wheel_factors(effects: Effects, history: RunHistory) -> dict[str, Array]:
    """Factors [1] (n,) on the torques of the wheels that differ from the other side, by wheel."""
    factors: dict[str, Array] = {}
    for effect, parameters in _all(effects):
        if effect.wheels is not None:
            for w, factor in effect.wheels(parameters, history).items():
                factors[w] = factors[w] * factor if w in factors else factor
    return factors


def wheel_speed_factors(vehicle: Vehicle, effects: Effects, motion: Motion) -> dict[str, Array]:
    """Factors [1] (n,) on the wheel speeds as read; only of wheels that an effect changes."""
    factors: dict[str, Array] = {}
    for effect, parameters in _all(effects):
        if effect.wheel_speed is not None:
            for w, factor in effect.wheel_speed(vehicle, parameters, motion).items():
                factors[w] = factors[w] * factor if w in factors else factor
    return factors


def total_load_shift(vehicle: Vehicle, effects: Effects, history: RunHistory) -> Array:
    """Sum of the load that is shifted from the front to the rear axle, over W [1] (n,)."""
    total = 0.0 * history.z
    for effect, parameters in _all(effects):
        if effect.load_shift is not None:
            total = total + effect.load_shift(vehicle, parameters, history)
    return total


def body_load_shift(vehicle: Vehicle, effects: Effects, history: RunHistory) -> Array:
    """The part of `total_load_shift` by effects that are a force on the body: where it acts."""
    slow = [name for name in effects.names if definition(effects, name).body_force is not None]
    return total_load_shift(vehicle, effects.only(*slow), history)


def total_body_force(vehicle: Vehicle, effects: Effects, motion: Motion) -> Array:
    """Sum of the forces that slow the body directly [N] (n,)."""
    total = 0.0 * motion.v
    for effect, parameters in _all(effects):
        if effect.body_force is not None:
            total = total + effect.body_force(vehicle, parameters, motion)
    return total


def total_axle_moment(vehicle: Vehicle, effects: Effects, motion: Motion) -> Pair:
    """Sum of the moments on the wheels besides the brake [N m per axle] (n,), front and rear."""
    front, rear = 0.0 * motion.v, 0.0 * motion.v
    for effect, parameters in _all(effects):
        if effect.axle_moment is not None:
            f, r = effect.axle_moment(vehicle, parameters, motion)
            front, rear = front + f, rear + r
    return front, rear


def as_read(vehicle: Vehicle, effects: Effects, history: RunHistory, a_x: Array) -> Array:
    """Reading of the accelerometer [m/s^2] (n,) at the acceleration ``a_x`` [m/s^2] (n,)."""
    reading = as_sensed(vehicle, effects, history, a_x)
    for effect, parameters in _all(effects):
        if effect.accelerometer_lag is not None:
            lag, second = effect.accelerometer_lag(parameters)
            if lag > SHORTEST:
                reading = low_pass(history.time, reading, lag, second)
    return reading


def as_sensed(vehicle: Vehicle, effects: Effects, history: RunHistory, a_x: Array) -> Array:
    """Reading of an accelerometer [m/s^2] (n,) that follows ``a_x`` [m/s^2] (n,) at once."""
    for effect, parameters in _in_order(effects, (*SENSOR, *effects.own)):
        if effect.accelerometer is not None:
            a_x = effect.accelerometer(vehicle, parameters, history, a_x)
    return a_x


def accelerometer_lag(effects: Effects) -> float:
    """Time [s] by which a slow acceleration is read late."""
    hooks = ((effect.accelerometer_lag, parameters) for effect, parameters in _all(effects))
    return sum((hook(parameters)[0] for hook, parameters in hooks if hook is not None), 0.0)


def speed_delay(effects: Effects) -> float:
    """Time [s] by which v is read late."""
    return _seconds(effects, lambda effect: effect.speed_delay)


def wheel_speed_delay(effects: Effects) -> float:
    """Time [s] by which all wheel speeds are read late."""
    return _seconds(effects, lambda effect: effect.wheel_speed_delay)


def _seconds(
    effects: Effects, hook_of: Callable[[Effect], Callable[[Parameters], float] | None]
) -> float:
    hooks = ((hook_of(effect), parameters) for effect, parameters in _all(effects))
    return sum((hook(parameters) for hook, parameters in hooks if hook is not None), 0.0)


def _all(effects: Effects) -> Iterator[tuple[Effect, Parameters]]:
    """Every effect with its parameters, the terms last."""
    for name, parameters in effects.parameters.items():
        yield definition(effects, name), parameters
    for term in effects.terms:
        yield effect_of(term), {}


def _in_order(effects: Effects, order: tuple[str, ...]) -> Iterator[tuple[Effect, Parameters]]:
    """The effects of ``order`` that are among ``effects``, in that order."""
    for name in order:
        if name in effects:
            yield definition(effects, name), effects.parameters[name]
