"""Run the estimator of `calib.estimation.online` sample by sample, for tests in a closed loop.

sample --check range--> readings of a block --50 ms--> step of the table --> answer of a block
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from calib.base.arrays import Array
from calib.base.names import G
from calib.estimation import online as ecu
from calib.estimation.constants import constants
from calib.estimation.known import as_driven, require_plain
from calib.estimation.readout import ENDS, pads_of_blocks, step_inputs, torques_of, with_before
from calib.estimation.reasons import Reason, first_reason
from calib.estimation.state import Sample
from calib.estimation.step import Answer, started, step
from calib.run.blocks import Blocks, samples_of_block, time_of_block
from calib.run.lateral import LATERAL_TIME, turning
from calib.run.noise import SensorNoise
from calib.store.version import Stored, table_in
from calib.table.table import Table


class Online:
    """The estimator of a ``table`` with its state, called every ``sample_time`` [s]."""

    def __init__(self, table: Table, sample_time: float) -> None:
        require_plain(table)
        self._table, self._dt = as_driven(table, table.vehicle), sample_time
        self._limits = ecu.limits(sample_time, table.vehicle)
        self._n, block = samples_of_block(sample_time), time_of_block(sample_time)
        self._c = constants(self._table, SensorNoise(**table.noise), block)
        self._state = started(self._c)
        self._since_lock = self._since_abs = math.inf
        self._omega: Array | None = None  # wheel speeds of the axles in the last block [rad/s] (2,)
        self._faulty = False  # whether the last block had a fault
        self._fastest = self._lateral = 0.0  # wheel speed [rad/s], lateral acceleration [m/s^2]
        # last readings in range, and last good ones, (11,) each
        self._readings: tuple[Array, Array] | None = None
        self._wheels = list[Array]()  # wheel speeds of the last three samples [rad/s] (4,)
        self._rows, self._reasons = list[Array](), list[int]()  # samples of the present block
        self._end_block(is_first=True)  # answers as before any block

    def step(self, sample: Mapping[str, float]) -> dict[str, float]:
        """Return the `Reason` and `ANSWERS` with bounds after a sample, by their names in C.

        ``sample`` is in SI by the names of a log; a channel that is missing reads 0.
        """
        x = np.array([sample.get(name, 0.0) for name in ecu.CHANNELS])
        readings = ecu.held_readings(x[None], self._limits, self._readings)  # (1, 11) each
        in_range, last_good, works = (y[0] for y in readings)
        all_work = bool(works.all())
        self._rows.append(last_good)
        disturbance = self._disturbance(last_good)
        self._reasons.append(disturbance if all_work else Reason.FAULT)
        self._readings = in_range, last_good
        if len(self._rows) == self._n:
            self._end_block()
        level, _, pads_f, pads_r = self._answers
        pressures = last_good[ecu.P_MC], last_good[ecu.P_MC]
        front, rear, total = torques_of(self._table.vehicle, pressures, level, (pads_f, pads_r))
        answers = *self._answers, front, front, rear, rear, total
        out = {"reason": float(self._reason if all_work else Reason.FAULT)}
        for name, bounded in zip(ecu.ANSWERS, answers, strict=True):
            for end, value in zip(ENDS, bounded, strict=True):
                out[f"{name}{end}"] = float(value)
        return out

    def _disturbance(self, x: Array) -> int:
        """Return the `Reason` by good readings ``x`` (11,), as `disturbances` of a log does."""
        c, car = self._c, self._table.vehicle
        earlier = self._wheels or [x[ecu.OMEGA], x[ecu.OMEGA]]
        self._wheels = [*earlier, x[ecu.OMEGA]][-3:]
        first, last, current = self._wheels
        # median of three, several times as fast as that of NumPy
        middle = np.clip(current, np.minimum(first, last), np.maximum(first, last))
        self._fastest = max(float(middle.max()), self._fastest - c.slows * self._dt)
        locks = self._fastest - middle.min() > c.lock * max(self._fastest, 1.0)
        locks = locks and self._fastest > c.turning
        self._since_lock = 0.0 if locks else self._since_lock + self._dt
        self._since_abs = 0.0 if x[ecu.ABS_ACTIVE] > 0.5 else self._since_abs + self._dt
        mean = 0.5 * (x[ecu.RL] + x[ecu.RR])
        speed = car.rear.rolling_radius * mean
        sides = (x[ecu.RR] - x[ecu.RL]) / max(mean, 1.0)  # as `calib.run.lateral.sides`
        slip = np.interp(-x[ecu.A_X] / G, self._table.tyre.force, self._table.tyre.slip)
        turned = turning(sides, speed, car.track_width, slip, car.cg_height)
        share = 1.0 - math.exp(-self._dt / LATERAL_TIME) if self._readings else 1.0
        self._lateral += share * float(turned - self._lateral)
        signals = self._since_abs, self._since_lock, self._lateral, x[ecu.STEERING]
        return int(first_reason(*signals, self._dt))

    def _end_block(self, *, is_first: bool = False) -> None:
        """Run the step on a block. If ``is_first``, set the answers before any block instead."""
        x = np.array(self._rows or [np.zeros(len(ecu.CHANNELS))])
        fault, disturbed = Reason.FAULT in self._reasons, max(self._reasons, default=0)
        driven = np.array([x[:, ecu.DRIVEN].max() > 0.5])
        self._rows, self._reasons = [], []
        p, a_x = x[:, ecu.P_MC].mean(), x[:, ecu.A_X].mean()
        fl, fr, rl, rr = x[:, ecu.OMEGA].mean(axis=0)
        omega, z, car = np.array([fl + fr, rl + rr]) / 2.0, -a_x / G, self._table.vehicle
        radii = np.array([car.front.rolling_radius, car.rear.rolling_radius])
        spin = np.zeros(2) if self._omega is None else (omega - self._omega) / self._c.block
        if self._faulty or fault:  # the spin of a held reading is wrong
            spin = -G * z / radii
        drive_f, drive_r = x[:, ecu.DRIVE].mean(axis=0)
        means = {
            "p_f": p, "omega_f": omega[0], "spin_f": spin[0], "drive_f": drive_f,
            "p_r": p, "omega_r": omega[1], "spin_r": spin[1], "drive_r": drive_r,
            "z": z, "speed": radii[1] * omega[1], "end": 0.0, "lead_in": False,
        }  # fmt: skip
        columns: dict[str, Any] = {name: np.array([mean]) for name, mean in means.items()}
        b = Blocks(**columns, v=None, samples=self._n, length=self._c.block)
        inputs = step_inputs(self._table, b, np.array([disturbed]), driven)
        block = Sample(*(float(y[0]) for y in inputs))
        state = started(self._c) if is_first else self._state
        if not is_first:
            self._omega, self._faulty = omega, fault
        of_block = Answer(*(np.asarray(y)[..., None] for y in step(self._c, state, block)))
        answer, place = with_before(self._c, of_block), 0 if is_first else 1
        self._reason = int(answer.reason[place])
        # level, ratio and pads of both axles, (3,) each
        self._answers = [y[:, place] for y in pads_of_blocks(self._table, inputs, answer)[:4]]


def online(table: Table | Stored, sample_time: float) -> Online:
    """Return an estimator that takes in one sample after the other, as in an ECU.

    ``sample_time`` is the time between samples [s]. Raises StoreError as `require_plain`.

    >>> import calib
    >>> logs = calib.sample_logs() / "simulation_study"
    >>> car = calib.read_vehicle(logs / "vehicle.toml")
    >>> table = calib.fit(car, [calib.read_log(logs / "ramp_noisy.parquet")])
    >>> stop = calib.read_log(logs / "stop_noisy.parquet")
    >>> estimator = calib.online(table, stop.sample_time)
    >>> for row in zip(*stop.channels.values()):
    ...     answer = estimator.step(dict(zip(stop.channels, row, strict=True)))
    >>> answer["brake_torque_fl"] > 0.0
    True
    """
    return Online(table_in(table), sample_time)
