"""Blocks: means of the axle signals over 50 ms, and the balance of forces in each block."""

from dataclasses import dataclass, fields
from typing import Any, Literal

import numpy as np

from calib.base.arrays import Array
from calib.base.names import AXLES, G
from calib.car.balance import ForceBalance, force_balance
from calib.car.braking import BITE
from calib.car.effects.effects import Effects
from calib.car.vehicle import Vehicle
from calib.logs.log import Log
from calib.run.axle_signals import AxleSignals, Signals, axle_pressure, eta_of
from calib.run.filters import block_mean

Axle = Literal["f", "r"]
BLOCK = 0.05  # intended length of a block [s]: short compared with a brake application (0.2 s)


@dataclass(frozen=True, kw_only=True)
class Blocks(AxleSignals):
    """Means over blocks of equal length, shapes (k,), SI."""

    end: Array  # time of the last sample of each block [s], when an ECU has the block
    spin_f: Array  # d omega/dt from the block before [rad/s^2]
    spin_r: Array
    samples: int  # of a block
    length: float  # of a block [s]

    @property
    def eta(self) -> Array:
        """Eta of (22), not zeroed [1]; 1 where the front wheels stand."""
        return eta_of(self.omega_f, self.omega_r)

    def rim_speed(self, car: Vehicle) -> Array:
        """Mean speed of the rims of both axles of a ``car`` [m/s]."""
        radius_f, radius_r = car.front.rolling_radius, car.rear.rolling_radius
        return 0.5 * (radius_f * self.omega_f + radius_r * self.omega_r)

    def speed_lost(self, z: Array) -> Array:
        """Speed that a deceleration ``z`` [1] takes off up to the middle of each block [m/s]."""
        return G * self.length * (np.cumsum(z) - 0.5 * z)


def blocks(s: Signals) -> Blocks:
    """Means over consecutive blocks; a shorter rest is left out."""
    n, length = samples_of_block(s.sample_time), time_of_block(s.sample_time)
    last = slice(n - 1, s.time.size // n * n, n)
    means: dict[str, Any] = {}
    for name in (field.name for field in fields(AxleSignals) if field.name != "lead_in"):
        x = getattr(s, name)
        means[name] = None if x is None else block_mean(x, n)
    omega_f, omega_r = means["omega_f"], means["omega_r"]
    return Blocks(
        **means,
        end=s.time[last],
        spin_f=np.diff(omega_f, prepend=omega_f[0]) / length,
        spin_r=np.diff(omega_r, prepend=omega_r[0]) / length,
        lead_in=s.lead_in[last],
        samples=n,
        length=length,
    )


def samples_of_block(sample_time: float) -> int:
    """Number of samples of a block of about `BLOCK`: at 50 Hz two, at 150 Hz seven."""
    # with 0.5 instead of 0.45, usual rates would be at the edge of rounding, and jitter decide
    return max(1, int(BLOCK / sample_time + 0.45))


def time_of_block(sample_time: float) -> float:
    """Length of a block [s], rounded to 1 ns: the mean ``sample_time`` varies as a log grows."""
    return round(samples_of_block(sample_time) * sample_time, 9)


def block_balance(vehicle: Vehicle, effects: Effects, b: Blocks) -> ForceBalance:
    """Forces on the car in each block, (k,), with the measured spin of the wheels."""
    drive, spin = (b.drive_f, b.drive_r), (b.spin_f, b.spin_r)
    return force_balance(vehicle, effects, b.end, b.speed, b.z, b.p_f, drive, spin)


def braked_alone(log: Log) -> Axle | None:
    """Return the axle that alone has a pressure above `BITE`, or None.

    Such an axle makes all of the brake force, so its slip gives the stiffness of its tyres, however
    its pads are. A motor that brakes the other axle is not seen.
    """
    if "p_mc" not in log:
        return None
    n = samples_of_block(log.sample_time)
    front, rear = (bool(np.any(block_mean(axle_pressure(log, axle), n) > BITE)) for axle in AXLES)
    if front == rear:
        return None
    return "f" if front else "r"
