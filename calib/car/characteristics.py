"""Characteristics of a car with its nominal pads; drag and wheel inertia are neglected (9)."""

from typing import Any

import numpy as np

from calib.base.names import AXLE_NAMES, G
from calib.base.plain import finite_or_none
from calib.base.units import BAR
from calib.car.balance import front_biased_up_to, front_share, pressure_per_g
from calib.car.forces import axle_loads
from calib.car.vehicle import Vehicle


def characteristics(vehicle: Vehicle) -> dict[str, Any]:
    """Return the characteristics of a vehicle as JSON types.

    The car has ``wheelbase`` [m], ``pressure_per_g`` [bar], ``front_share`` of the brake force [1],
    ``front_biased_up_to`` [g], beyond which the rear axle locks first (None if it never does), and
    ``rear_lifts_at`` [g]. Each axle, ``front`` and ``rear``, has torques [N m/bar], loads at rest
    and at 0.5 g as the mass that it carries [kg], and `Axle.wheel_mass` [kg].
    """
    axles, loads = (vehicle.front, vehicle.rear), axle_loads(vehicle, np.array([0.0, 0.5]))
    values: dict[str, Any] = {
        "wheelbase": vehicle.wheelbase,
        "pressure_per_g": pressure_per_g(vehicle) / BAR,
        "front_share": front_share(vehicle, 0.0),
        "front_biased_up_to": finite_or_none(front_biased_up_to(vehicle)),
        "rear_lifts_at": vehicle.cg_to_front_axle / vehicle.cg_height,
    }
    for name, axle, load in zip(AXLE_NAMES.values(), axles, loads, strict=True):
        torque_per_bar = axle.pad_friction * axle.torque_gain * BAR  # (2), (3)
        values[name] = {
            "torque_per_bar_wheel": torque_per_bar,
            "torque_per_bar_axle": 2.0 * torque_per_bar,
            "static_load": float(load[0]) / G,
            "load_at_half_g": float(load[1]) / G,
            "wheel_mass": axle.wheel_mass,
        }
    return values
