"""What eta and the slips read on the lead-in, where no brake acts: the radii of the day.

A motor slips the wheels there too; the table's tyre curve says by how much, and only the rest is
zeroed. Wrong by the drive's slip times what the road's stiffness differs from that of the ramp. For
the baselines and the drawings; the step finds its own zeros.
"""

import math

import numpy as np
from numpy.typing import NDArray

from calib.car.balance import ForceBalance
from calib.car.forces import speed_ratio
from calib.car.vehicle import Vehicle
from calib.run.axle_signals import Signals, eta_of
from calib.run.noise import SensorNoise, aged
from calib.table.table import Table

Array = NDArray[np.float64]
Pair = tuple[Array, Array]


def drive_slips(table: Table, road: ForceBalance) -> Pair:
    """Slip of both axles [1] (n,) that engine or motor causes; zero where none is logged."""

    def slip(force: Array, load: Array) -> Array:
        F = force / load
        return np.asarray(np.sign(F) * np.interp(np.abs(F), table.tyre.force, table.tyre.slip))

    return slip(road.drive_f, road.load_f), slip(road.drive_r, road.load_r)


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
