"""What follows from a vehicle file: loads, torque per pressure, distribution of the brake force.

`brake-cal vehicle show --json` has them under ``facts``.
"""

from dataclasses import dataclass

import numpy as np

from calib.base.names import G
from calib.base.plain import finite
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
_BAR = 1e5


@dataclass(frozen=True)
class _AxleFacts:
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
class _Braking:
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
class _VehicleFacts:
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
    front: _AxleFacts
    rear: _AxleFacts
    distribution: tuple[_Braking, ...]


def what_follows(vehicle: Vehicle) -> _VehicleFacts:
    """Return the facts of a vehicle; the inertia of the wheels is neglected, as in (9).

    >>> import calib
    >>> facts = what_follows(calib.read_vehicle(calib.sample_logs() / "sedan" / "vehicle.toml"))
    >>> round(facts.pressure_per_g, 1), round(facts.front_share, 3)  # bar, 1
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
    columns = (z, pressure / _BAR, *shares, *torques)
    rows = zip(*(column.tolist() for column in columns), strict=True)
    half = (float(load[0]) for load in axle_loads(vehicle, np.array([0.5])))
    front, rear = map(_axle, axles, vehicle.static_loads, half)
    return _VehicleFacts(
        wheelbase=vehicle.wheelbase,
        pressure_per_g=pressure_per_g(vehicle) / _BAR,
        front_share=share,
        front_biased_up_to=finite(front_biased_up_to(vehicle)),
        rear_lifts_at=vehicle.cg_to_front_axle / vehicle.cg_height,
        front=front,
        rear=rear,
        distribution=tuple(_Braking(*r[:4], *map(finite, r[4:6]), *r[6:]) for r in rows),
    )


def _axle(axle: Axle, rest: float, half: float) -> _AxleFacts:
    per_bar = axle.pad_friction * axle.torque_gain * _BAR  # (2), (3)
    return _AxleFacts(per_bar, 2.0 * per_bar, rest / G, half / G, axle.wheel_mass)
