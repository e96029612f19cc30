"""How the brakes of a car share the braking, and which axle locks first.

    friction used |      front ___.--   an axle locks where it uses what the road offers;
                  | __.--'  .--'        the axle that uses more locks first
                  |   rear-'
                  +---------------- z

At one pressure on both axles, in a straight line, without drag and without control of the slip. The
inertia of the wheels is neglected, as in (9).
"""

import math
from typing import TypeVar

import numpy as np

from calib.base.arrays import Array
from calib.car.balance import brake_forces
from calib.car.forces import axle_loads
from calib.car.vehicle import Vehicle

T = TypeVar("T", float, Array)


def force_per_pressure(vehicle: Vehicle) -> tuple[float, float]:
    """Brake force of the front and of the rear axle at the road per pressure [N/Pa], (2)."""
    one = np.ones(1)
    front, rear = brake_forces(vehicle, one, one)
    return float(front[0]), float(rear[0])


def pressure_per_g(vehicle: Vehicle) -> float:
    """Pressure that decelerates the car by g [Pa], (5) with nominal pads."""
    return vehicle.weight / sum(force_per_pressure(vehicle))


def front_share(vehicle: Vehicle, log_ratio: T) -> T:
    """Share of the front axle in the brake force [1], the same at every pressure.

    ``log_ratio`` ln of the pads' ratio, front over rear, over that of the vehicle file [1]; where
    the axles have pressures of their own, plus ln of the front one over the rear one.
    """
    front, rear = force_per_pressure(vehicle)
    share: T = front / (front + rear * math.e**-log_ratio)
    return share


def front_biased_up_to(vehicle: Vehicle) -> float:
    """z [1] at which F_f = F_r with nominal pads: the car is front-biased below it.

    From (2), (9) and the I curve: the front share of the tyre force equals that of the load. With
    a rear brake it is below the z of rear-wheel lift; infinite without a rear brake; zero when the
    car is rear-biased at every z.
    """
    share = front_share(vehicle, 0.0)
    z = (share * vehicle.wheelbase - vehicle.cg_to_rear_axle) / vehicle.cg_height
    return math.inf if share == 1.0 else max(z, 0.0)


def ideal_front_share(vehicle: Vehicle, z: Array) -> Array:
    """Share of the front axle [1] (n,) at which both use the same friction at z [1], (6)."""
    return np.asarray(axle_loads(vehicle, z)[0] / vehicle.weight)


def friction_used(vehicle: Vehicle, z: Array) -> tuple[Array, Array]:
    """Friction that the front and the rear axle use at z [1] (n,) each; infinite when lifted."""
    share = front_share(vehicle, 0.0)
    front, rear = (
        np.where(load > 0.0, part * z * vehicle.weight / np.where(load > 0.0, load, 1.0), math.inf)
        for part, load in zip((share, 1.0 - share), axle_loads(vehicle, z), strict=True)
    )
    return front, rear


def locks_at(vehicle: Vehicle, friction: float) -> tuple[float, float]:
    """z [1] at which the front and the rear axle lock on a road of ``friction`` [1].

    Infinite for an axle that never locks. Only the smaller of the two is reached.
    """
    share, L, h = front_share(vehicle, 0.0), vehicle.wheelbase, vehicle.cg_height
    left = share * L - friction * h  # phi z L = mu (l_r + z h), from (6)
    front = friction * vehicle.cg_to_rear_axle / left if left > 0.0 else math.inf
    rear = friction * vehicle.cg_to_front_axle / ((1.0 - share) * L + friction * h)  # from (7)
    return front, rear


def lock_efficiency(vehicle: Vehicle, friction: float) -> float:
    """Deceleration at the first lock over the one that the road offers [1], 1 at best."""
    return min(locks_at(vehicle, friction)) / friction
