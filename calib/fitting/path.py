"""The ramp as the tyre of a table's posterior has it, over z: forces and slips."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.base.names import G
from calib.car.balance import brake_forces
from calib.car.forces import axle_loads, speed_ratio
from calib.car.vehicle import Vehicle
from calib.model.parameters import RampParameters, tyres_of
from calib.table.table import TyrePosterior

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Path:
    """The ramp over z. Shapes (n,), all [1]."""

    z: Array
    F_f: Array
    F_r: Array
    slip_f: Array
    slip_r: Array

    @property
    def eta(self) -> Array:
        """(22)."""
        return speed_ratio(self.slip_f, self.slip_r)

    @property
    def D(self) -> Array:
        """F_f - F_r."""
        return self.F_f - self.F_r


def path(vehicle: Vehicle, parameters: RampParameters[float], z: Array) -> Path:
    """Forces and slips over z [1], quasi-steady: no drag, wheels slowed with the car.

    The tyres carry W z; the brakes also stop the wheels themselves, J d omega/dt with
    d omega/dt = -g z/R. One master-cylinder pressure for both axles.
    """
    B_f, B_r = brake_forces(vehicle, np.ones(()), np.ones(()), parameters.log_pad_ratio)
    return _shared(vehicle, parameters, z, B_f / (B_f + B_r))


def path_of(vehicle: Vehicle, parameters: RampParameters[float], B_f: Array, B_r: Array) -> Path:
    """The same for brake forces at the road [N] of front and rear axle, (n,), not both zero."""
    inertia = sum(
        2.0 * a.wheel_inertia * G / a.rolling_radius**2 for a in (vehicle.front, vehicle.rear)
    )
    brakes = B_f + B_r
    return _shared(vehicle, parameters, brakes / (vehicle.weight + inertia), B_f / brakes)


def _shared(vehicle: Vehicle, parameters: RampParameters[float], z: Array, share: Array) -> Path:
    """The path whose front brakes give ``share`` of the brake force [1]."""
    load_f, load_r = axle_loads(vehicle, z)
    inertia_f, inertia_r = (
        2.0 * a.wheel_inertia * G * z / a.rolling_radius**2 for a in (vehicle.front, vehicle.rear)
    )
    brakes = vehicle.weight * z + inertia_f + inertia_r
    F_f = (share * brakes - inertia_f) / load_f
    F_r = ((1.0 - share) * brakes - inertia_r) / load_r
    slips = tyres_of(parameters).slips((F_f, F_r), (load_f, load_r), vehicle.static_loads)
    return Path(z, F_f, F_r, *slips)


def delta_sigma(f: Callable[[RampParameters[float]], Array], posterior: TyrePosterior) -> Array:
    """Standard deviation of f(parameters) by the delta method, central differences."""
    mean, covariance = np.asarray(posterior.mean), np.asarray(posterior.covariance)
    columns = []
    for i, sigma in enumerate(np.sqrt(np.diag(covariance))):
        step = np.zeros_like(mean)
        step[i] = 0.1 * sigma
        above, below = (f(RampParameters(*x)) for x in (mean + step, mean - step))
        columns.append((above - below) / (0.2 * sigma))
    J = np.stack(columns, axis=-1)
    return np.asarray(np.sqrt(np.einsum("...i,ij,...j->...", J, covariance, J)))
