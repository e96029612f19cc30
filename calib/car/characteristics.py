"""Characteristics of a car with its nominal pads: loads, torques, share of the front axle.

Without drag, and without the inertia of the wheels, as in (9).
"""

from dataclasses import dataclass

import numpy as np

from calib.base.names import G
from calib.base.plain import finite
from calib.base.units import BAR
from calib.car.balance import front_biased_up_to, front_share, pressure_per_g
from calib.car.forces import axle_loads
from calib.car.vehicle import Axle, Vehicle


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


def characteristics(vehicle: Vehicle) -> _Characteristics:
    """Return the characteristics of a vehicle.

    >>> import calib
    >>> car = characteristics(calib.read_vehicle(calib.sample_logs() / "sedan" / "vehicle.toml"))
    >>> round(car.pressure_per_g, 1), round(car.front_share, 3)  # bar, 1
    (69.9, 0.729)
    """
    half = (float(load[0]) for load in axle_loads(vehicle, np.array([0.5])))
    front, rear = map(_axle, (vehicle.front, vehicle.rear), vehicle.static_loads, half)
    return _Characteristics(
        wheelbase=vehicle.wheelbase,
        pressure_per_g=pressure_per_g(vehicle) / BAR,
        front_share=front_share(vehicle, 0.0),
        front_biased_up_to=finite(front_biased_up_to(vehicle)),
        rear_lifts_at=vehicle.cg_to_front_axle / vehicle.cg_height,
        front=front,
        rear=rear,
    )


def _axle(axle: Axle, static: float, half: float) -> _AxleCharacteristics:
    per_bar = axle.pad_friction * axle.torque_gain * BAR  # (2), (3)
    return _AxleCharacteristics(per_bar, 2.0 * per_bar, static / G, half / G, axle.wheel_mass)
