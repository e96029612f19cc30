"""The explicit list of effects, and what several of them do together.

A new effect is one file and one line here. One that changes a pressure or the reading of the
accelerometer also has its place in `LINE`, `CALIPER` or `SENSOR`: there the order is physics.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from calib.errors import ModelError
from calib.physics.effects import (
    accelerometer_bias,
    accelerometer_scale,
    aerodynamic_drag,
    brake_threshold_pressure,
    caliper_hysteresis,
    disc_thickness_variation,
    engine_drag,
    hydraulic_delay,
    hydraulic_lag,
    mass_error,
    pad_pressure_dependence,
    pad_speed_dependence,
    pad_thermal_fade,
    pitch_coupling,
    rear_proportioning,
    road_grade,
    rolling_radius_mismatch,
    rolling_resistance,
    side_imbalance,
    wet_pad_recovery,
    wheel_inertia,
)
from calib.physics.effects.effect import (
    Array,
    Effect,
    Motion,
    Pair,
    Parameters,
    RunHistory,
)
from calib.physics.effects.empirical import Empirical
from calib.physics.vehicle import Axle, Vehicle

Effects = Mapping[str, Parameters | Empirical]
"""Parameters [SI] by effect name; an empirical term stands under a name of its own."""

CATALOGUE: dict[str, Effect] = {
    effect.card.name: effect
    for effect in (
        aerodynamic_drag.EFFECT,
        rolling_resistance.EFFECT,
        road_grade.EFFECT,
        engine_drag.EFFECT,
        pad_thermal_fade.EFFECT,
        pad_speed_dependence.EFFECT,
        pad_pressure_dependence.EFFECT,
        wet_pad_recovery.EFFECT,
        rolling_radius_mismatch.EFFECT,
        brake_threshold_pressure.EFFECT,
        hydraulic_lag.EFFECT,
        hydraulic_delay.EFFECT,
        rear_proportioning.EFFECT,
        caliper_hysteresis.EFFECT,
        pitch_coupling.EFFECT,
        accelerometer_bias.EFFECT,
        accelerometer_scale.EFFECT,
        wheel_inertia.EFFECT,
        side_imbalance.EFFECT,
        disc_thickness_variation.EFFECT,
        mass_error.EFFECT,
    )
}

LINE = ("hydraulic_delay", "hydraulic_lag", "rear_proportioning")
"""Between the master cylinder and the wheels, in the order in which the fluid meets them."""

CALIPER = ("brake_threshold_pressure", "caliper_hysteresis")
"""In the caliper, behind a wheel pressure sensor."""

SENSOR = ("road_grade", "pitch_coupling", "accelerometer_scale", "accelerometer_bias")
"""What is sensed comes before how it is read."""


def effect_named(name: str) -> Effect:
    """Return the effect of that name. Raises ModelError naming the known ones."""
    if name not in CATALOGUE:
        raise ModelError(
            f"unknown effect {name!r}",
            expected=f"one of {', '.join(CATALOGUE)}",
            do="see calib/physics/effects",
        )
    return CATALOGUE[name]


def nothing(name: str) -> dict[str, float]:
    """Parameters [SI] at which the effect changes nothing: neutral strength, else what is typical.

    Raises ModelError for an unknown name.
    """
    card = effect_named(name).card
    strength, *others = card.parameters
    return {strength.name: card.neutral} | {p.name: p.typical for p in others}


def as_driven(vehicle: Vehicle, effects: Effects) -> Vehicle:
    """Return the vehicle with the mass, rolling radii and wheel inertias that it really has."""
    front, rear, mass = vehicle.front, vehicle.rear, vehicle.mass
    for effect, parameters in _each(effects):
        R_f, R_r = effect.radius(parameters)
        J_f, J_r = effect.inertia(parameters)
        front, rear = _axle(front, R_f, J_f), _axle(rear, R_r, J_r)
        mass *= effect.mass(parameters)
    return replace(vehicle, front=front, rear=rear, mass=mass)


def _axle(axle: Axle, radius: float, inertia: float) -> Axle:
    return replace(
        axle,
        rolling_radius=axle.rolling_radius * radius,
        wheel_inertia=axle.wheel_inertia + inertia,
    )


def line_pressure(effects: Effects, trace: RunHistory) -> Pair:
    """Pressure [Pa] that reaches the front and the rear wheels from ``trace.p_mc``.

    Reads ``time`` and ``p_mc`` of the trace only: what the fluid does does not depend on the car.
    """
    p_f = p_r = trace.p_mc
    for effect, parameters in _each(effects, LINE):
        p_f, p_r = effect.pressure(parameters, trace, p_f, p_r)
    return p_f, p_r


def caliper_pressure(effects: Effects, trace: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Pressure [Pa] that clamps the pads of one side, from that of its wheels; see above."""
    for effect, parameters in _each(effects, CALIPER):
        p_f, p_r = effect.pressure(parameters, trace, p_f, p_r)
    return p_f, p_r


def pad_factors(effects: Effects, trace: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Factors [1] on the pad friction of one side at its caliper pressures [Pa]."""
    front, rear = np.ones_like(p_f), np.ones_like(p_r)
    for effect, parameters in _each(effects):
        f, r = effect.friction(parameters, trace, p_f, p_r)
        front, rear = front * f, rear * r
    return front, rear


def wheel_factors(effects: Effects, trace: RunHistory) -> dict[str, Array]:
    """Factors [1] on the torques of the wheels that differ from the other side."""
    factors: dict[str, Array] = {}
    for effect, parameters in _each(effects):
        for w, factor in effect.wheels(parameters, trace).items():
            factors[w] = factors[w] * factor if w in factors else factor
    return factors


def total_load_shift(vehicle: Vehicle, effects: Effects, trace: RunHistory) -> Array:
    """Sum of what the front axle lacks of its load, and the rear has too much of, over W [1]."""
    total = 0.0 * trace.z
    for effect, parameters in _each(effects):
        total = total + effect.load_shift(vehicle, parameters, trace)
    return total


def total_body_force(vehicle: Vehicle, effects: Effects, motion: Motion) -> Array:
    """Sum of what slows the body directly [N]."""
    total = 0.0 * motion.v
    for effect, parameters in _each(effects):
        total = total + effect.body_force(vehicle, parameters, motion)
    return total


def total_axle_moment(vehicle: Vehicle, effects: Effects, motion: Motion) -> Pair:
    """Sum of what slows the wheels besides the brake [N m per axle], front and rear."""
    front, rear = 0.0 * motion.v, 0.0 * motion.v
    for effect, parameters in _each(effects):
        f, r = effect.axle_moment(vehicle, parameters, motion)
        front, rear = front + f, rear + r
    return front, rear


def as_read(vehicle: Vehicle, effects: Effects, trace: RunHistory, a_x: Array) -> Array:
    """What the accelerometer says [m/s^2] when the car has ``a_x`` [m/s^2]."""
    for effect, parameters in _each(effects, SENSOR):
        a_x = effect.accelerometer(vehicle, parameters, trace, a_x)
    return a_x


def _each(
    effects: Effects, order: tuple[str, ...] | None = None
) -> Iterator[tuple[Effect, Parameters]]:
    """The effects with their parameters; those of ``order`` in that order, or all as they come."""
    for name in effects if order is None else (n for n in order if n in effects):
        present = effects[name]
        if isinstance(present, Empirical):
            yield present.effect(), {}
        else:
            yield effect_named(name), present
