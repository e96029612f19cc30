"""What an ECU answers with a table: nothing knows what comes later, and sensors fail.

    samples --in range?--> signals --50 ms--> blocks --step of the table--> answer until the next

What `calib.estimation.estimator` has of an ECU, and the reference of its C code.
"""

from dataclasses import replace

import numpy as np

from calib.base.arrays import Array, Mask
from calib.base.names import G
from calib.estimation import channels as at
from calib.estimation.constants import Constants
from calib.estimation.readout import Readout, read_out
from calib.estimation.reasons import Reason, disturbances
from calib.logs.log import Log
from calib.run.axle_signals import Signals, axle_pressure
from calib.run.blocks import blocks
from calib.run.filters import block_mean
from calib.run.noise import SensorNoise
from calib.table.table import Table

READ_OUT = ("level", "ratio", "pads_f", "pads_r", "torque_f", "torque_r", "torque_sum")
"""Fields of a `Readout` by the order of `ANSWERS`."""


def online(
    table: Table, log: Log, factors: tuple[Array | float, Array | float] = (1.0, 1.0)
) -> Readout:
    """Run the step of a ``table`` over a ``log`` as `read_out`, with what an ECU reads of it alone.

    ``factors`` as of `read_out`. Where a sensor fails its last good reading counts.
    """
    front, rear = table.vehicle.front, table.vehicle.rear
    x, good = _held(at.samples_of(log), log.sample_time, front.rolling_radius)
    log = replace(log, channels=log.channels | dict(zip(at.CHANNELS, x.T, strict=True)))
    p, (drive_f, drive_r) = (axle_pressure(log, "f"), axle_pressure(log, "r")), x[:, at.DRIVE].T
    omega_f, omega_r = 0.5 * (x[:, at.FL] + x[:, at.FR]), 0.5 * (x[:, at.RL] + x[:, at.RR])
    z, speed, never = -x[:, at.A_X] / G, rear.rolling_radius * omega_r, np.zeros_like(good)
    s = Signals(
        log.time, *p, drive_f, drive_r, z, omega_f, omega_r, None, speed, never, log.sample_time
    )
    b = blocks(s)
    fault = block_mean(np.where(good, 0.0, 1.0), b.samples) > 0.0
    held = fault | np.append(False, fault[:-1])  # of such a reading no spin is known
    spin_f = np.where(held, -G * b.z / front.rolling_radius, b.spin_f)
    spin_r = np.where(held, -G * b.z / rear.rolling_radius, b.spin_r)
    b = replace(b, spin_f=spin_f, spin_r=spin_r)
    why, driven = np.where(good, disturbances(table, log, s), Reason.FAULT), x[:, at.DRIVEN] > 0.5
    told = read_out(table, SensorNoise(**table.noise), s, b, why, factors, driven)
    reason = np.where(good, told.step.reason, Reason.FAULT)
    return replace(told, step=told.step._replace(reason=reason))


def answered(table: Table, sample_time: float, samples: Array) -> Array:
    """Reasons and answers (n, 22) to samples (n, 10), a block or more, as `bte_run` has them.

    ``sample_time`` of the ECU's task [s]. A row has a `Reason`, then `ANSWERS`, each a median with
    its bounds; all are finite.
    """
    time = sample_time * np.arange(len(samples), dtype=np.float64)
    channels = {"time": time, **dict(zip(at.CHANNELS, samples.T, strict=True))}
    told = online(table, Log("", "", "", channels))
    return np.vstack([told.step.reason, *(getattr(told, name) for name in READ_OUT)]).T


def _held(x: Array, sample_time: float, radius: float) -> tuple[Array, Mask]:
    """Samples (n, 10) with the last good readings, and where all sensors work (n,)."""
    low, high, jump = at.limits(sample_time)
    inside = (x >= low) & (x <= high)
    raw = _last(x, inside)
    taken = inside & (np.abs(np.diff(raw, axis=0, prepend=raw[:1])) <= jump)
    last = _last(x, taken)
    a_x, p = last[:, at.A_X], last[:, at.P_MC]
    changed = np.append(True, x[1:, at.A_X] != a_x[:-1])
    since_when = np.maximum.accumulate(np.where(changed, np.arange(len(x)), 0))
    held_time, c = sample_time * (np.arange(len(x)) - since_when), Constants
    frozen = held_time > c.held_time - 0.5 * sample_time
    frozen &= np.abs(p - p[since_when]) > c.held_pressure
    frozen &= radius * last[:, at.FL] > c.moving
    return last, taken.all(axis=1) & ~frozen


def _last(x: Array, good: Mask) -> Array:
    """The last good values of columns (n, k), 0 before the first."""
    rows = np.maximum.accumulate(np.where(good, 1 + np.arange(len(x))[:, None], 0))
    return np.take_along_axis(np.vstack([np.zeros_like(x[:1]), x]), rows, axis=0)
