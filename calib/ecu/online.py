"""The estimator sample by sample, as an ECU runs it: the reference of the C code.

    sample --in range?--> axle means --50 ms--> block --step of the table--> answer until the next

A log as a whole is `calib.estimation.estimator`; here nothing knows what comes later, a sensor may
fail, and the clock is the task of the ECU.
"""

import math

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import StoreError
from calib.base.names import WHEELS, G
from calib.car.bias import front_share
from calib.car.braking import MOVING
from calib.ecu import channels as at
from calib.estimation.constants import Constants, constants
from calib.estimation.known import known_effects
from calib.estimation.readout import given, pads_of
from calib.estimation.reasons import HARDEST, RECOVER, Reason, disturbed, locks
from calib.estimation.state import Sample, State, started
from calib.estimation.step import step
from calib.model.resistance import RESISTANCE
from calib.run.blocks import Blocks, samples_of_block
from calib.run.driving_record import NOMINAL_RADIUS
from calib.run.lateral import LATERAL_TIME, turning
from calib.run.noise import SensorNoise
from calib.table.table import Table

HELD_TIME, HELD_PRESSURE = 0.1, 5e5
"""Time [s] for which a_x keeps a value while the pressure moves by so much [Pa], and the car rolls:
it is frozen."""

RESTS = 1.5
"""Speed of every wheel below which a car may get other numbers [rad/s]."""

REASONS = tuple(Reason)


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


class Online:
    """One ECU with a table; ``sample_time`` [s] of its task.

    Raises StoreError as `require_plain`.
    """

    def __init__(self, table: Table, sample_time: float) -> None:
        require_plain(table)
        self.table, self.sample_time, car = table, sample_time, table.vehicle
        self.samples = samples_of_block(sample_time)
        self.block = round(self.samples * sample_time, 9)
        self.constants = constants(table, SensorNoise(**table.noise), self.block)
        self.state: State = started(self.constants)
        self.low, self.high, self.jump = at.limits(sample_time)
        self.last, self.raw = np.zeros((2, len(at.CHANNELS)))
        self.begun, self.faulty, self.fastest = False, False, 0.0
        self.held, self.p_held, self.lateral, self.since_lock = 0.0, 0.0, 0.0, 2.0 * RECOVER
        self.lateral_part = 1.0 - math.exp(-sample_time / LATERAL_TIME)
        self.before = np.zeros((2, len(WHEELS)))
        self.rows: list[tuple[float, ...]] = []
        self.omega: list[Array] = []
        self.gains = np.array([[axle.torque_gain] for axle in (car.front, car.rear)])
        pads, c = (car.front.pad_friction, car.rear.pad_friction), Constants
        self.filed = np.array([pads[0] / pads[1], *pads])
        bounds = 1.0, c.least_level, c.most_level  # any pads, before anything is known
        self.of_block, self.reason = np.outer([1.0, *self.filed], bounds), Reason.NOT_BRAKED

    def step(self, sample: Array) -> tuple[Reason, Array]:
        """Take in a sample (10,) of `CHANNELS`, and give `ANSWERS` (7, 3); all are finite."""
        fine = self._good(sample)
        worst = self._disturbed(fine)
        x, self.begun = self.last, True
        front, rear = 0.5 * (x[at.FL] + x[at.FR]), 0.5 * (x[at.RL] + x[at.RR])
        driven = x[at.DRIVEN] > 0.5
        self.rows.append((x[at.P_MC], -x[at.A_X] / G, front, rear, *x[at.DRIVE], worst, driven))
        if len(self.rows) == self.samples:
            self._take()
        level, _, *pads = self.of_block
        torques = self.gains * max(x[at.P_MC], 0.0) * pads
        total = level / level[0] * 2.0 * np.sum(torques[:, 0])
        return self.reason if fine else Reason.FAULT, np.vstack([self.of_block, torques, total])

    def run(self, samples: Array) -> Array:
        """Reasons and answers (n, 22) to samples (n, 10), as `bte_run` has them."""
        told = map(self.step, samples)
        return np.array([(reason, *answers.ravel()) for reason, answers in told])

    def exchange(self, table: Table) -> bool:
        """Take another table and forget everything; only at rest, else False."""
        if np.max(np.abs(self.last[at.OMEGA])) >= RESTS:
            return False
        self.__init__(table, self.sample_time)  # type: ignore[misc]
        return True

    def _good(self, x: Array) -> bool:
        """Whether all sensors work; the last good reading of one that fails counts."""
        same = self.begun and x[at.A_X] == self.last[at.A_X]
        inside = (x >= self.low) & (x <= self.high)
        good = inside & ~(self.begun & (np.abs(x - self.raw) > self.jump))
        self.raw, self.last = np.where(inside, x, self.raw), np.where(good, x, self.last)
        self.held = self.held + self.sample_time if same else 0.0
        self.p_held = self.p_held if same else self.last[at.P_MC]
        moved = abs(self.last[at.P_MC] - self.p_held)
        rim = self.table.vehicle.front.rolling_radius * self.last[at.FL]
        held = self.held > HELD_TIME - 0.5 * self.sample_time  # else a rounding could decide it
        return bool(good.all()) and not (held and moved > HELD_PRESSURE and rim > MOVING)

    def _disturbed(self, fine: bool) -> Reason:
        """As `disturbances` of a log, by what is past."""
        x, car, tyre = self.last, self.table.vehicle, self.table.tyre
        wheels = x[at.OMEGA]
        seen = np.vstack([self.before, wheels]) if self.begun else np.tile(wheels, (3, 1))
        self.before, middle = seen[1:], np.median(seen, axis=0)
        slowed = self.fastest - HARDEST / NOMINAL_RADIUS * self.sample_time
        self.fastest = max(middle.max(), slowed)
        locked = locks(self.fastest, middle.min())
        self.since_lock = 0.0 if locked else self.since_lock + self.sample_time
        z, mean = -x[at.A_X] / G, 0.5 * (x[at.RL] + x[at.RR])
        slip = np.copysign(np.interp(abs(z), tyre.force, tyre.slip), z)
        apart, speed = (x[at.RR] - x[at.RL]) / max(mean, 1.0), car.rear.rolling_radius * mean
        turned = float(turning(apart, speed, car.track_width, slip, car.cg_height))
        part = self.lateral_part if self.begun else 1.0
        self.lateral += part * (turned - self.lateral)
        recent = self.since_lock <= RECOVER + 0.5 * self.sample_time
        told = disturbed(recent, self.lateral, x[at.STEERING])
        return REASONS[told] if fine else Reason.FAULT

    def _take(self) -> None:
        """The block that is complete, as arrays (1,)."""
        p, z, *omega, drive_f, drive_r = np.mean(self.rows, axis=0)[:6, None]
        worst, driven = np.max(self.rows, axis=0)[6:, None]
        before, nothing, car = self.omega or omega, np.zeros(1), self.table.vehicle
        spin = [(x - was) / self.block for x, was in zip(omega, before, strict=True)]
        if self.faulty or worst == Reason.FAULT:  # of a reading that was held nothing is known
            spin = [-G * z / axle.rolling_radius for axle in (car.front, car.rear)]
        self.omega, self.faulty, self.rows = omega, bool(worst == Reason.FAULT), []
        b = Blocks(
            end=nothing, p_f=p, p_r=p, drive_f=drive_f, drive_r=drive_r,
            z=z, omega_f=omega[0], omega_r=omega[1], v=None,
            speed=car.rear.rolling_radius * omega[1],
            spin_f=spin[0], spin_r=spin[1], lead_in=nothing > 0.0,
            samples=self.samples, length=self.block,
        )  # fmt: skip
        rows = given(self.table, b, worst, with_v=False)._replace(driven=driven)
        answer = step(self.constants, self.state, Sample(*(float(x[0]) for x in rows)))
        share = front_share(car, rows.log_odds)
        pads = pads_of(share, answer.level[:, None], answer.ratio[:, None])[..., 0]
        relative = np.vstack([np.exp(answer.ratio), pads])
        self.of_block = np.vstack([np.exp(answer.level), self.filed[:, None] * relative])
        self.reason = REASONS[int(answer.reason)]
