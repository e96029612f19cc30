"""Means over blocks of 50 ms: causal, a block is complete at its end.

If one axle alone brakes, its share of the force is known, and its slip gives the stiffness of its
tyres without the pads.
"""

from dataclasses import dataclass, fields, replace
from typing import Any, Literal

import numpy as np

from calib.base.arrays import Array
from calib.car.balance import ForceBalance, force_balance
from calib.car.braking import BITE
from calib.car.effects.effects import Effects
from calib.car.vehicle import Vehicle
from calib.logs.log import Log
from calib.run.axle_signals import AxleSignals, Signals, axle_pressure, eta_of
from calib.run.filters import block_mean

BLOCK = 0.05
"""Length of a block [s]: ten samples at 200 Hz, short compared with a brake application (0.2 s)."""


@dataclass(frozen=True, kw_only=True)
class Blocks(AxleSignals):
    """Means over blocks of ``samples`` each, shapes (k,), SI; ``end`` of each block [s].

    ``spin_f``, ``spin_r`` are d omega/dt from one block to the next (causal).
    """

    end: Array
    spin_f: Array
    spin_r: Array
    samples: int
    length: float

    def with_z(self, z: Array) -> "Blocks":
        """The same with another deceleration [1] (k,)."""
        return replace(self, z=z)

    @property
    def eta(self) -> Array:
        """Eta of (22), not zeroed [1]; 1 where the front wheels stand."""
        return eta_of(self.omega_f, self.omega_r)


def blocks(s: Signals, length: float = BLOCK) -> Blocks:
    """Means over consecutive blocks of about ``length`` [s]; a shorter rest is left out."""
    n = samples_of_block(s.sample_time, length)
    last = slice(n - 1, s.time.size // n * n, n)
    step = round(n * s.sample_time, 9)  # the mean step would change as a log goes on
    shared = (field.name for field in fields(AxleSignals) if field.name != "lead_in")
    signals = ((name, getattr(s, name)) for name in shared)
    means: dict[str, Any] = {name: x if x is None else block_mean(x, n) for name, x in signals}
    omega_f, omega_r = (means[f"omega_{axle}"] for axle in "fr")
    return Blocks(
        **means,
        end=s.time[last],
        spin_f=np.diff(omega_f, prepend=omega_f[0]) / step,
        spin_r=np.diff(omega_r, prepend=omega_r[0]) / step,
        lead_in=s.lead_in[last],
        samples=n,
        length=step,
    )


def samples_of_block(sample_time: float, length: float = BLOCK) -> int:
    """Samples of a block of about ``length`` [s], at least one: at 50 Hz two, at 150 Hz seven."""
    return max(1, int(length / sample_time + 0.45))  # no usual rate is near the edge of rounding


def time_of_block(sample_time: float) -> float:
    """Length [s] of a block of a steady clock, rounded to 1 ns."""
    return round(samples_of_block(sample_time) * sample_time, 9)


def block_balance(vehicle: Vehicle, effects: Effects, b: Blocks) -> ForceBalance:
    """`force_balance` of each block, with the measured spin of the wheels, (k,)."""
    drive, spin = (b.drive_f, b.drive_r), (b.spin_f, b.spin_r)
    return force_balance(vehicle, effects, b.end, b.speed, b.z, b.p_f, drive, spin)


Axle = Literal["f", "r"]


def braked_alone(log: Log) -> Axle | None:
    """The axle whose pressure alone passes `BITE`, else None; blind to a motor on the other."""
    if "p_mc" not in log:
        return None
    n = samples_of_block(log.sample_time)
    front, rear = (bool(np.any(block_mean(axle_pressure(log, axle), n) > BITE)) for axle in "fr")
    return None if front == rear else "f" if front else "r"
