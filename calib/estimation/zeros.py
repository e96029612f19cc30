"""What eta and the slips read on the lead-in, where no brake acts: the radii of the day.

A motor slips the wheels there too; the table's tyre curve says by how much, and only the rest is
zeroed. Wrong by the drive's slip times what the road's stiffness differs from that of the ramp. For
the baselines and the drawings; the split filter finds its own zeros.
"""

import numpy as np
from numpy.typing import NDArray

from calib.physics.balance import ForceBalance
from calib.physics.forces import speed_ratio
from calib.signals.axle_signals import Signals
from calib.table.table import Table

Array = NDArray[np.float64]
Pair = tuple[Array, Array]


def drive_slips(table: Table, road: ForceBalance) -> Pair:
    """Slip of both axles [1] (n,) that engine or motor causes; zero where none is logged."""

    def slip(force: Array, load: Array) -> Array:
        F = force / load
        return np.asarray(np.sign(F) * np.interp(np.abs(F), table.tyre.force, table.tyre.slip))

    return slip(road.drive_f, road.load_f), slip(road.drive_r, road.load_r)


def zero_of_eta(s: Signals, driven: Pair) -> float:
    """Zero of eta [1]: the mean of (22) over the lead-in less what the drive does to it."""
    rolling = np.mean(s.omega_r[s.lead_in]) / np.mean(s.omega_f[s.lead_in])
    return float(rolling / np.mean(speed_ratio(*driven)[s.lead_in])) - 1.0


def zeroed_slips(s: Signals, driven: Pair) -> Pair | None:
    """Slips (19), (20) of the axles [1] with the rolling radii of the lead-in; None without v."""
    if s.v is None:
        return None
    slips = []
    for omega, slip in zip((s.omega_f, s.omega_r), driven, strict=True):
        radius = np.mean((s.v * (1.0 - slip))[s.lead_in]) / np.mean(omega[s.lead_in])
        slips.append(1.0 - radius * omega / np.maximum(s.v, 0.5))
    return slips[0], slips[1]
