"""What follows from a vehicle file: loads, torque per pressure, distribution, first lock."""

import math
from dataclasses import dataclass

import numpy as np

from calib.base.names import G
from calib.car.bias import (
    force_per_pressure,
    friction_used,
    front_share,
    ideal_front_share,
    locks_at,
    pressure_per_g,
)
from calib.car.forces import axle_loads, front_biased_up_to
from calib.car.vehicle import Axle, Vehicle

DECELERATIONS = tuple(k / 10.0 for k in range(1, 11))
"""Rows of the distribution [g]."""
FRICTIONS = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0)
"""Roads of the first lock [1], from ice to dry asphalt."""
HALF_G = 0.5


@dataclass(frozen=True)
class AxleFacts:
    """One axle; loads of the axle in kg of mass that it carries.

    ``torque_per_bar_wheel``, ``torque_per_bar_axle`` [N m/bar] with nominal pads;
    ``static_load`` at rest and ``load_at_half_g`` at 0.5 g [kg]; ``wheel_mass`` mass at the rolling
    radius that has the wheel's moment of inertia [kg].
    """

    torque_per_bar_wheel: float
    torque_per_bar_axle: float
    static_load: float
    load_at_half_g: float
    wheel_mass: float


@dataclass(frozen=True)
class Braking:
    """One deceleration.

    ``deceleration`` [g]; ``pressure`` [bar]; ``front_share`` of the brake force and
    ``ideal_front_share``, at which both axles use the same friction [1]; ``friction_f``,
    ``friction_r`` used by the axles [1], null where the axle has no load; ``torque_f``,
    ``torque_r`` of the axles [N m].
    """

    deceleration: float
    pressure: float
    front_share: float
    ideal_front_share: float
    friction_f: float | None
    friction_r: float | None
    torque_f: float
    torque_r: float


@dataclass(frozen=True)
class FirstLock:
    """One road: its ``friction`` [1], the ``axle`` that locks first, "front" or "rear".

    ``deceleration`` [g] and ``pressure`` [bar] at that moment.
    """

    friction: float
    axle: str
    deceleration: float
    pressure: float


@dataclass(frozen=True)
class VehicleFacts:
    """What follows from a vehicle file with its nominal pads, without drag.

    ``wheelbase`` [m]; ``pressure_per_g`` [bar]; ``front_share`` of the brake force [1];
    ``front_biased_up_to`` deceleration below which the front axle locks first [g], null if at all;
    ``rear_lifts_at`` deceleration [g] at which the rear axle has no load.
    """

    wheelbase: float
    pressure_per_g: float
    front_share: float
    front_biased_up_to: float | None
    rear_lifts_at: float
    front: AxleFacts
    rear: AxleFacts
    distribution: tuple[Braking, ...]
    first_lock: tuple[FirstLock, ...]


def what_follows(vehicle: Vehicle) -> VehicleFacts:
    """Return the facts of a vehicle; the inertia of the wheels is neglected, as in (9).

    >>> import calib
    >>> facts = what_follows(calib.read_vehicle(calib.sample_logs() / "sedan" / "vehicle.toml"))
    >>> round(facts.pressure_per_g, 1), round(facts.front_share, 3)  # bar, 1
    (69.9, 0.729)
    """
    half = axle_loads(vehicle, np.array([HALF_G]))
    front, rear = (
        _axle(axle, static, float(load[0]))
        for axle, static, load in zip(
            (vehicle.front, vehicle.rear), vehicle.static_loads, half, strict=True
        )
    )
    return VehicleFacts(
        wheelbase=vehicle.wheelbase,
        pressure_per_g=pressure_per_g(vehicle) / BAR,
        front_share=front_share(vehicle),
        front_biased_up_to=_finite(front_biased_up_to(vehicle)),
        rear_lifts_at=vehicle.cg_to_front_axle / vehicle.cg_height,
        front=front,
        rear=rear,
        distribution=tuple(_distribution(vehicle)),
        first_lock=tuple(_first_lock(vehicle, mu) for mu in FRICTIONS),
    )


BAR = 1e5


def _axle(axle: Axle, static: float, half: float) -> AxleFacts:
    per_bar = axle.pad_friction * axle.torque_gain * BAR  # (2), (3)
    wheel_mass = axle.wheel_inertia / axle.rolling_radius**2
    return AxleFacts(per_bar, 2.0 * per_bar, static / G, half / G, wheel_mass)


def _distribution(vehicle: Vehicle) -> list[Braking]:
    z = np.array(DECELERATIONS)
    pressure = z * pressure_per_g(vehicle)
    ideal, (used_f, used_r) = ideal_front_share(vehicle, z), friction_used(vehicle, z)
    share = front_share(vehicle)
    per_pressure = force_per_pressure(vehicle)
    torque_f = per_pressure[0] * vehicle.front.rolling_radius * pressure
    torque_r = per_pressure[1] * vehicle.rear.rolling_radius * pressure
    return [
        Braking(
            float(z[i]), float(pressure[i]) / BAR, share, float(ideal[i]),
            _finite(float(used_f[i])), _finite(float(used_r[i])),
            float(torque_f[i]), float(torque_r[i]),
        )
        for i in range(z.size)
    ]  # fmt: skip


def _first_lock(vehicle: Vehicle, friction: float) -> FirstLock:
    front, rear = locks_at(vehicle, friction)
    z = min(front, rear)
    axle = "front" if front <= rear else "rear"
    return FirstLock(friction, axle, z, z * pressure_per_g(vehicle) / BAR)


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
