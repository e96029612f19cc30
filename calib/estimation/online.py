"""What an ECU answers with a table: nothing knows what comes later, and sensors fail.

    samples --in range?--> signals --50 ms--> blocks --step of the table--> answer until the next

What `calib.estimation.estimator` has of an ECU, and the reference of its C code.
"""

from dataclasses import replace

import numpy as np

from calib.base.arrays import Array, Mask
from calib.base.names import G
from calib.car.vehicle import Vehicle
from calib.estimation import channels as at
from calib.estimation.constants import Constants
from calib.estimation.known import as_driven
from calib.estimation.readout import Readout, read_out
from calib.estimation.reasons import Reason, disturbances
from calib.logs.log import Log
from calib.run.filters import block_mean
from calib.run.noise import SensorNoise
from calib.run.run import Run
from calib.table.table import Table

READ_OUT = ("level", "ratio", "pads_f", "pads_r", "torque_f", "torque_r", "torque_sum")
"""Fields of a `Readout` by the order of `ANSWERS`."""


def online(table: Table, car: Vehicle, log: Log) -> Readout:
    """What an ECU with a ``table`` answers to a ``log``, of which it reads `CHANNELS` alone.

    ``car`` as it is driven, with the known effects that it takes out; the pad frictions are those
    that act, with them. Where a sensor fails, as in a gap of the log, its last good reading counts.
    """
    rows, step, radius = at.rows_of(log), log.sample_time, car.front.rolling_radius
    x, good = _held(at.samples_of(log), step, radius)
    time = step * np.arange(len(x), dtype=np.float64)
    held = {"time": time, **dict(zip(at.CHANNELS, x.T, strict=True))}
    run = Run(replace(log, channels=held), car, causal=True)
    b, ran = run.blocks, run.corrected
    fault = block_mean(np.where(good, 0.0, 1.0), b.samples) > 0.0
    unsure = fault | np.append(False, fault[:-1])  # of a reading that is held no spin is known
    spin_f = np.where(unsure, -G * b.z / radius, b.spin_f)
    spin_r = np.where(unsure, -G * b.z / car.rear.rolling_radius, b.spin_r)
    b, used = replace(b, spin_f=spin_f, spin_r=spin_r), as_driven(table, ran.vehicle)
    why = np.where(good, disturbances(used, ran.log, run.signals), Reason.FAULT)
    told = read_out(used, SensorNoise(**table.noise), run.signals, b, why, x[:, at.DRIVEN] > 0.5)
    reason = np.where(good, told.step.reason, Reason.FAULT)
    told = told.with_pads(ran.factor_f, ran.factor_r)
    told = replace(told, step=told.step._replace(reason=reason))
    return told.at(rows) if rows.size < reason.size else told


def answered(table: Table, sample_time: float, samples: Array) -> Array:
    """Reasons and answers (n, 22) to samples (n, 10), a block or more, as `bte_run` has them.

    ``sample_time`` of the ECU's task [s]. A row has a `Reason`, then `ANSWERS`, each a median with
    its bounds; all are finite.
    """
    time = sample_time * np.arange(len(samples), dtype=np.float64)
    channels = {"time": time, **dict(zip(at.CHANNELS, samples.T, strict=True))}
    told = online(table, table.vehicle, Log("", "", "", channels))
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
