"""What an ECU answers with the estimator of a table, of many samples: the reference of the C code.

    samples --in range?--> signals --50 ms--> blocks --step of the table--> answer until the next

Nothing knows what comes later. To a log of `calib.estimation.estimator` that adds what an ECU must
live with: sensors fail, and nobody cleaned what they read.
"""

from dataclasses import replace

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.base.errors import StoreError
from calib.base.names import G
from calib.car.braking import MOVING
from calib.car.vehicle import Vehicle
from calib.ecu import channels as at
from calib.estimation.constants import Constants
from calib.estimation.known import known_effects
from calib.estimation.readout import read_out
from calib.estimation.reasons import RECOVER, Reason, disturbed, locks
from calib.logs.log import Log
from calib.model.resistance import RESISTANCE
from calib.run.axle_signals import Signals
from calib.run.blocks import blocks
from calib.run.filters import block_mean, since
from calib.run.lateral import lateral
from calib.run.noise import SensorNoise
from calib.table.table import Table

HELD_TIME, HELD_PRESSURE = 0.1, 5e5
"""Time [s] for which a_x keeps a value while the pressure moves by so much [Pa], and the car rolls:
it is frozen."""

READ_OUT = ("level", "ratio", "pads_f", "pads_r", "torque_f", "torque_r", "torque_sum")
"""Fields of a `Readout` by the order of `ANSWERS`."""


def require_plain(table: Table) -> None:
    """Raise StoreError for a car with known effects that the code of an ECU does not take out."""
    known = known_effects(table)
    if not set(known.names) <= set(RESISTANCE) or known.terms:
        more = [name for name in known.names if name not in RESISTANCE]
        raise StoreError(
            f"the code takes out no {', '.join(more) or 'empirical term'}",
            expected=" and ".join(RESISTANCE) + " alone",
            do="hand out the table in another format, and take the effect out before it is read",
        )


def unknown(car: Vehicle) -> Array:
    """Level, ratio and pads with their bounds (4, 3) before the first block: any pads."""
    pads = [axle.pad_friction for axle in (car.front, car.rear)]
    bounds = 1.0, Constants.least_level, Constants.most_level
    return np.outer([1.0, pads[0] / pads[1], *pads], bounds)


def answered(table: Table, sample_time: float, samples: Array) -> Array:
    """Reasons and answers (n, 22) to samples (n, 10), a block or more, as `bte_run` has them.

    ``sample_time`` of the ECU's task [s]. A row has a `Reason`, then `ANSWERS`, each a median with
    its bounds; all are finite. Raises StoreError as `require_plain`.
    """
    require_plain(table)
    car, noise = table.vehicle, SensorNoise(**table.noise)
    time = sample_time * np.arange(len(samples), dtype=np.float64)
    front, rear = car.front, car.rear
    x, good = _held(samples, sample_time, front.rolling_radius)
    p, (drive_f, drive_r) = x[:, at.P_MC], x[:, at.DRIVE].T
    omega_f, omega_r = 0.5 * (x[:, at.FL] + x[:, at.FR]), 0.5 * (x[:, at.RL] + x[:, at.RR])
    speed, z = rear.rolling_radius * omega_r, -x[:, at.A_X] / G
    s = Signals(
        time, p, p, drive_f, drive_r, z, omega_f, omega_r, None, speed, time < 0.0, sample_time
    )
    b = blocks(s)
    fault = block_mean(np.where(good, 0.0, 1.0), b.samples) > 0.0
    held = fault | np.append(False, fault[:-1])  # of such a reading no spin is known
    spin_f = np.where(held, -G * b.z / front.rolling_radius, b.spin_f)
    spin_r = np.where(held, -G * b.z / rear.rolling_radius, b.spin_r)
    b = replace(b, spin_f=spin_f, spin_r=spin_r)
    why, driven = np.where(good, _disturbed(table, x, s), Reason.FAULT), x[:, at.DRIVEN] > 0.5
    told = read_out(table, noise, s, b, why, with_v=False, driven=driven)
    early = np.arange(len(x)) < b.samples - 1
    answers = np.where(early, unknown(car)[..., None], [getattr(told, x) for x in READ_OUT[:4]])
    gains = np.outer([front.torque_gain, rear.torque_gain], np.maximum(p, 0.0))
    torques = gains[:, None] * answers[2:]
    total = answers[:1] / answers[:1, :1] * 2.0 * torques[:, 0].sum(axis=0)
    rows = np.concatenate([answers, torques, total]).reshape(-1, len(x))
    reason = np.where(early, Reason.NOT_BRAKED, told.step.reason)
    return np.vstack([np.where(good, reason, Reason.FAULT), rows]).T


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
    frozen = sample_time * (np.arange(len(x)) - since_when) > HELD_TIME - 0.5 * sample_time
    frozen &= np.abs(p - p[since_when]) > HELD_PRESSURE
    frozen &= radius * last[:, at.FL] > MOVING
    return last, taken.all(axis=1) & ~frozen


def _last(x: Array, good: Mask) -> Array:
    """The last good values of columns (n, k), 0 before the first."""
    rows = np.maximum.accumulate(np.where(good, 1 + np.arange(len(x))[:, None], 0))
    return np.take_along_axis(np.vstack([np.zeros_like(x[:1]), x]), rows, axis=0)


def _disturbed(table: Table, x: Array, s: Signals) -> Index:
    """As `disturbances` of a log, by what is past (n,)."""
    car, tyre, wheels = table.vehicle, table.tyre, x[:, at.OMEGA]
    seen = np.vstack([wheels[:1], wheels[:1], wheels])
    middle = np.median([seen[:-2], seen[1:-1], seen[2:]], axis=0)
    locked = since(s.time, locks(s.time, middle.max(axis=1), middle.min(axis=1)))
    log = Log("", "", "", dict(zip(at.CHANNELS, x.T, strict=True)))
    slip = np.interp(s.z, tyre.force, tyre.slip)
    bend = lateral(log, s, car.track_width, slip=slip, height=car.cg_height)
    # within half a sample: else a rounding could decide it
    return disturbed(locked <= RECOVER + 0.5 * s.sample_time, bend, x[:, at.STEERING])
