"""What eta and the slips read on the lead-in, where no brake acts: the radii of the day.

Engine, motor and other known effects slip the wheels besides the brakes; the table's tyre curve
says by how much, and only the rest is zeroed. Wrong by that slip times what the road's stiffness
differs from that of the ramp. The zeros are for baselines and drawings; the step finds its own.
"""

import math

import numpy as np
from numpy.typing import NDArray

from calib.car.balance import ForceBalance, braked_tyres, turning_shares
from calib.car.bias import front_share
from calib.car.forces import axle_loads, speed_ratio
from calib.car.vehicle import Vehicle
from calib.run.axle_signals import Signals, eta_of
from calib.run.noise import SensorNoise, aged
from calib.table.table import Table

Array = NDArray[np.float64]
Pair = tuple[Array, Array]


def known_slips(table: Table, car: Vehicle, road: ForceBalance) -> Pair:
    """Slip of both axles [1] (n,) besides that of a car which nothing but its brakes slows.

    Other moments on the wheels, engine or motor among them, add to the force of an axle; its load
    is that of the whole deceleration, and what known effects move. The map of a table knows none
    of them. ``car`` with the pads of the file; those of the ramp share the brake force.
    """
    alone = road.demanded / (1.0 + sum(turning_shares(car)))
    share = front_share(car, table.calibration.pad_log_ratio.value)

    def slip(force: Array, load: Array) -> Array:
        F = force / np.maximum(load, 0.1 * car.weight)
        return np.asarray(np.sign(F) * np.interp(np.abs(F), table.tyre.force, table.tyre.slip))

    front, rear = braked_tyres(car, share, road.demanded, alone)
    load_f, load_r = axle_loads(car, alone / car.weight)
    return (
        slip(front + road.other_f, road.load_f) - slip(front, load_f),
        slip(rear + road.other_r, road.load_r) - slip(rear, load_r),
    )


def zero_of_eta(s: Signals, driven: Pair, noise: SensorNoise, car: Vehicle) -> float:
    """Zero of eta [1]: the mean of (22) over the lead-in less what the drive does to it.

    Without a lead-in that of the radii of ``car``, within one per cent.
    """
    if not s.lead_in.any():
        return car.front.rolling_radius / car.rear.rolling_radius - 1.0
    eta = eta_of(s.omega_f, s.omega_r) / speed_ratio(*driven)
    return _mean(s, eta, math.sqrt(2.0) * noise.omega / _turning(s)) - 1.0


def zeroed_slips(s: Signals, driven: Pair, noise: SensorNoise) -> Pair | None:
    """Slips (19), (20) of the axles [1] with the radii of the lead-in; None without v or it."""
    if s.v is None or not s.lead_in.any():
        return None
    v = np.maximum(s.v, 0.5)
    density = np.hypot(noise.v / v, noise.omega / _turning(s))
    slips = []
    for omega, slip in zip((s.omega_f, s.omega_r), driven, strict=True):
        per_radius = _mean(s, omega / v / (1.0 - slip), density)
        slips.append(1.0 - omega / v / per_radius)
    return slips[0], slips[1]


def _turning(s: Signals) -> Array:
    """Front wheel speed [rad/s], at least 1."""
    return np.maximum(s.omega_f, 1.0)


def _mean(s: Signals, x: Array, density: Array) -> float:
    """Mean of ``x`` (n,) over the lead-in, the last seconds most, `calib.run.noise`.

    ``density`` of its noise [s^0.5] (n,).
    """
    weights = aged(s.time, s.lead_in, density)[s.lead_in] ** -2.0
    return float(np.average(x[s.lead_in], weights=weights))
