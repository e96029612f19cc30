"""Compute the answers of an ECU with a table: causal, with sensors that may fail.

    samples --check range--> signals --50 ms--> blocks --step of the table--> answer of a block

An answer stands until the next block ends. `online` makes the answers ``ecu`` of an `Estimate`, and
is the reference of the C code.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.base.names import G
from calib.base.plain import rows
from calib.car.vehicle import Vehicle
from calib.estimation.known import as_driven
from calib.estimation.readout import FIELDS, Readout, read_out
from calib.estimation.reasons import Reason, disturbances
from calib.logs.clock import GAP
from calib.logs.log import Log
from calib.run.filters import block_mean
from calib.run.noise import SensorNoise
from calib.run.run import Run
from calib.table.table import Table


class Variable(NamedTuple):
    """A variable of the ECU or of an FMU, in SI: a row of `variables.csv`, with its columns."""

    estimator: str  # causality and variability in the FMU of the estimator, "" if not in it
    car: str  # the same in the FMU of the car
    name: str
    unit: str
    meaning: str
    low: float  # least and largest reading of a working sensor
    high: float
    jump: float  # a working sensor changes by at most jump + rate dt over a time dt
    rate: float


def _read(row: dict[str, str]) -> Variable:
    """Return the variable of a row; an empty number is NaN."""
    estimator, car, name, unit, meaning, *numbers = row.values()
    return Variable(estimator, car, name, unit, meaning, *(float(x or "nan") for x in numbers))


VARIABLES = {x.name: x for x in map(_read, rows("variables.csv", "calib.estimation"))}
CHANNELS = {x.name: x for x in VARIABLES.values() if "input" in x.estimator}
"""Channels that an ECU reads; a sample (11,) has this order, in Python and in C."""

P_MC, A_X, FL, FR, RL, RR, STEERING, DRIVEN, DRIVE_F, DRIVE_R, ABS_ACTIVE = range(len(CHANNELS))
OMEGA, DRIVE = slice(FL, RR + 1), slice(DRIVE_F, DRIVE_R + 1)
"""Places of channels in a sample."""

REASON = VARIABLES.pop("reason")
ANSWERS = {x.name: x for x in VARIABLES.values() if "output" in x.estimator}
"""Quantities of an answer (9, 3), each a median with its 95 % bounds, without the `Reason`."""
READ_OUT = tuple(FIELDS[name] for name in ANSWERS)  # the fields of a `Readout` with `ANSWERS`

_LONGEST_GAP = 10.0  # a longer gap of a log [s] counts as this: it ends a stop all the same


def rows_of(log: Log) -> Index:
    """Return the row (n,) of each sample of a log in `samples_of`, which has rows for gaps, too."""
    steps, longest = np.diff(log.time) / log.sample_time, _LONGEST_GAP / log.sample_time
    rows_ahead = np.where(steps > GAP, np.round(np.minimum(steps, longest)), 1.0)
    return np.append(0, np.cumsum(rows_ahead)).astype(np.intp)


def samples_of(log: Log) -> Array:
    """Return the samples of a log as an ECU reads `CHANNELS` (m, 11), NaN in gaps of the log."""
    rows = rows_of(log)
    samples = np.full((rows[-1] + 1, len(CHANNELS)), np.nan)
    nothing = np.zeros_like(log.time)
    samples[rows] = np.stack([log.channels.get(name, nothing) for name in CHANNELS], axis=1)
    return samples


_GRIP = 1.2  # force of an axle over the weight of the car that no tyres reach [1]
_FASTEST = 110.0  # speed that no car reaches [m/s]


def limits(sample_time: float, car: Vehicle) -> tuple[Array, Array, Array]:
    """Return least and largest readings of `CHANNELS` and largest change in ``sample_time`` [s]."""
    sensors = CHANNELS.values()
    low, high, jump, rate = np.array([(x.low, x.high, x.jump, x.rate) for x in sensors]).T
    torque = [_GRIP * car.weight * axle.rolling_radius for axle in (car.front, car.rear)]
    low[DRIVE], high[DRIVE] = np.negative(torque), torque
    high[OMEGA] = np.minimum(high[OMEGA], _FASTEST / car.front.rolling_radius)
    return low, high, np.minimum(jump + rate * sample_time, high - low)


def online(table: Table, car: Vehicle, log: Log) -> Readout:
    """Return the answers of an ECU with a ``table`` to the `CHANNELS` of a ``log``.

    ``car`` is as driven, with the known effects that the ECU takes out; pad frictions include them.
    While a sensor fails, as in a gap of the log, the last good reading counts.
    """
    rows, step = rows_of(log), log.sample_time
    _, readings, works = held_readings(samples_of(log), limits(step, car))
    good = works.all(axis=1)
    run = Run(replace(log, channels=_channels_of(readings, step)), car, causal=True)
    b, corrected = run.blocks, run.corrected
    fault = block_mean(np.where(good, 0.0, 1.0), b.samples) > 0.0
    # Spin is a difference of two blocks, so a held reading spoils the spin of its block and of the
    # next one. The deceleration replaces both.
    wrong = fault | np.append(False, fault[:-1])
    spin_f = np.where(wrong, -G * b.z / car.front.rolling_radius, b.spin_f)
    spin_r = np.where(wrong, -G * b.z / car.rear.rolling_radius, b.spin_r)
    b, used = replace(b, spin_f=spin_f, spin_r=spin_r), as_driven(table, corrected.vehicle)
    disturbed_by = np.where(good, disturbances(used, corrected.log, run.signals), Reason.FAULT)
    readout = read_out(
        used, SensorNoise(**table.noise), run.signals, b, disturbed_by, readings[:, DRIVEN] > 0.5
    )
    reason = np.where(good, readout.step.reason, Reason.FAULT)
    readout = readout.with_pads(corrected.factor_f, corrected.factor_r)
    # bit i is set while channel i fails; the bits of the step follow those of the channels
    diagnosis = (~works) @ (2.0 ** np.arange(len(CHANNELS)))
    diagnosis += 2.0 ** len(CHANNELS) * readout.step.diagnosis
    readout = replace(readout, step=readout.step._replace(reason=reason, diagnosis=diagnosis))
    return readout.take(rows) if rows.size < reason.size else readout


def answered(table: Table, sample_time: float, samples: Array) -> Array:
    """Return finite answers (n, 28) to ``samples`` (n, 11), as `bte_run` of the C code.

    ``sample_time`` is that of the ECU's task [s]. A row has `Reason`, then `ANSWERS` with bounds.
    """
    log = Log("", "", "", _channels_of(samples, sample_time))
    readout = online(table, table.vehicle, log)
    return np.vstack([readout.step.reason, *(getattr(readout, name) for name in READ_OUT)]).T


def _channels_of(samples: Array, sample_time: float) -> dict[str, Array]:
    """Return the channels of a log, with its time, from ``samples`` (n, 11)."""
    time = sample_time * np.arange(len(samples), dtype=np.float64)
    return {"time": time, **dict(zip(CHANNELS, samples.T, strict=True))}


def held_readings(
    x: Array, bounds: tuple[Array, Array, Array], last_readings: tuple[Array, Array] | None = None
) -> tuple[Array, Array, Mask]:
    """Return the last readings in range, the last good ones, and which sensors work, of ``x``.

    ``x`` and the results are (n, 11); a good reading is in range and no jump. ``bounds`` are from
    `limits`, ``last_readings`` the first two results before ``x``, (11,) each, None at the start.
    """
    low, high, jump = bounds
    inside = (x >= low) & (x <= high)
    nothing = np.zeros(x.shape[1])
    first, last_good = last_readings or (nothing, nothing)
    in_range = _last(x, inside, first)
    previous = np.vstack([in_range[0] if last_readings is None else first, in_range[:-1]])
    works = inside & (np.abs(in_range - previous) <= jump)
    return in_range, _last(x, works, last_good), works


def _last(x: Array, good: Mask, first: Array) -> Array:
    """Return the last ``good`` value by column of ``x`` (n, k); ``first`` (k,) before any."""
    rows = np.maximum.accumulate(np.where(good, 1 + np.arange(len(x))[:, None], 0))
    return np.take_along_axis(np.vstack([first, x]), rows, axis=0)
