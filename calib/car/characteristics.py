"""Characteristics of a car with its nominal pads: loads, torques, share of the front axle.

Without drag, and without the inertia of the wheels, as in (9).
"""

from typing import Any

import numpy as np

from calib.base.names import AXLE_NAMES, G
from calib.base.plain import finite_or_none
from calib.base.units import BAR
from calib.car.balance import front_biased_up_to, front_share, pressure_per_g
from calib.car.forces import axle_loads
from calib.car.vehicle import Vehicle


def characteristics(vehicle: Vehicle) -> dict[str, Any]:
    """Return the characteristics of a vehicle, JSON-able.

    Of the car ``wheelbase`` [m], ``pressure_per_g`` [bar], ``front_share`` of the brake force [1],
    ``front_biased_up_to`` [g], beyond which the rear axle locks first, None if never, and
    ``rear_lifts_at`` [g]. Of ``front`` and ``rear`` torques [N m/bar], loads at rest and at 0.5 g
    as the mass carried [kg], and ``wheel_mass`` that has a wheel's moment of inertia at its rolling
    radius [kg].
    """
    axles, loads = (vehicle.front, vehicle.rear), axle_loads(vehicle, np.array([0.0, 0.5]))
    car = {
        "wheelbase": vehicle.wheelbase,
        "pressure_per_g": pressure_per_g(vehicle) / BAR,
        "front_share": front_share(vehicle, 0.0),
        "front_biased_up_to": finite_or_none(front_biased_up_to(vehicle)),
        "rear_lifts_at": vehicle.cg_to_front_axle / vehicle.cg_height,
    }
    of_axles = {}
    for name, axle, load in zip(AXLE_NAMES.values(), axles, loads, strict=True):
        per_bar = axle.pad_friction * axle.torque_gain * BAR  # (2), (3)
        of_axles[name] = {
            "torque_per_bar_wheel": per_bar,
            "torque_per_bar_axle": 2.0 * per_bar,
            "static_load": float(load[0]) / G,
            "load_at_half_g": float(load[1]) / G,
            "wheel_mass": axle.wheel_mass,
        }
    return {**car, **of_axles}
