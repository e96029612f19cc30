"""Characteristics of a car with its nominal pads: loads, torques, distribution of the brake force.

Without drag, and without the inertia of the wheels, as in (9).
"""

from dataclasses import dataclass

import numpy as np

from calib.base.names import G
from calib.base.plain import finite
from calib.base.units import BAR
from calib.car.balance import (
    force_per_pressure,
    friction_used,
    front_biased_up_to,
    front_share,
    ideal_front_share,
    pressure_per_g,
)
from calib.car.forces import axle_loads
from calib.car.vehicle import Axle, Vehicle

_DECELERATIONS = tuple(k / 10.0 for k in range(1, 11))
"""Rows of the distribution [g]."""


@dataclass(frozen=True)
class _AxleCharacteristics:
    """An axle: torques [N m/bar], loads as the mass carried [kg], at rest and at 0.5 g.

    ``wheel_mass`` mass at the rolling radius that has the wheel's moment of inertia [kg].
    """

    torque_per_bar_wheel: float
    torque_per_bar_axle: float
    static_load: float
    load_at_half_g: float
    wheel_mass: float


@dataclass(frozen=True)
class _BrakingPoint:
    """The brakes at a ``deceleration`` [g] and its ``pressure`` [bar].

    ``front_share`` of the brake force [1]; at the ideal one both axles use the same friction.
    ``friction_f``, ``friction_r`` [1] used by the axles, null where the axle has no load;
    ``torque_f``, ``torque_r`` of the axles [N m].
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
class _Characteristics:
    """A car: ``wheelbase`` [m]; ``pressure_per_g`` [bar]; ``front_share`` of the brake force [1].

    Up to ``front_biased_up_to`` [g] the front axle locks first, null if always; at
    ``rear_lifts_at`` [g] the rear axle has no load.
    """

    wheelbase: float
    pressure_per_g: float
    front_share: float
    front_biased_up_to: float | None
    rear_lifts_at: float
    front: _AxleCharacteristics
    rear: _AxleCharacteristics
    distribution: tuple[_BrakingPoint, ...]


def characteristics(vehicle: Vehicle) -> _Characteristics:
    """Return the characteristics of a vehicle.

    >>> import calib
    >>> car = characteristics(calib.read_vehicle(calib.sample_logs() / "sedan" / "vehicle.toml"))
    >>> round(car.pressure_per_g, 1), round(car.front_share, 3)  # bar, 1
    (69.9, 0.729)
    """
    z = np.array(_DECELERATIONS)
    pressure, share = z * pressure_per_g(vehicle), front_share(vehicle, 0.0)
    axles = (vehicle.front, vehicle.rear)
    torques = (
        force * axle.rolling_radius * pressure
        for force, axle in zip(force_per_pressure(vehicle), axles, strict=True)
    )
    shares = (np.full_like(z, share), ideal_front_share(vehicle, z), *friction_used(vehicle, z))
    columns = (z, pressure / BAR, *shares, *torques)
    rows = zip(*(column.tolist() for column in columns), strict=True)
    half = (float(load[0]) for load in axle_loads(vehicle, np.array([0.5])))
    front, rear = map(_axle, axles, vehicle.static_loads, half)
    return _Characteristics(
        wheelbase=vehicle.wheelbase,
        pressure_per_g=pressure_per_g(vehicle) / BAR,
        front_share=share,
        front_biased_up_to=finite(front_biased_up_to(vehicle)),
        rear_lifts_at=vehicle.cg_to_front_axle / vehicle.cg_height,
        front=front,
        rear=rear,
        distribution=tuple(_BrakingPoint(*r[:4], *map(finite, r[4:6]), *r[6:]) for r in rows),
    )


def _axle(axle: Axle, static: float, half: float) -> _AxleCharacteristics:
    per_bar = axle.pad_friction * axle.torque_gain * BAR  # (2), (3)
    return _AxleCharacteristics(per_bar, 2.0 * per_bar, static / G, half / G, axle.wheel_mass)
