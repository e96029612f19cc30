"""The estimator sample by sample, as an ECU runs it: the reference of the C code.

    sample --in range?--> axle means --50 ms--> block --step of the table--> answer until the next

A log as a whole is `calib.estimation.estimator`; here nothing knows what comes later, a sensor may
fail, and the clock is the task of the ECU.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import StoreError
from calib.base.names import AXLES, WHEELS, G
from calib.car.bias import front_share
from calib.car.braking import MOVING
from calib.estimation.constants import Constants, constants
from calib.estimation.known import known_effects
from calib.estimation.readout import given, pads_of
from calib.estimation.reasons import HARDEST, LATERAL, LOCK, RECOVER, STEERING, Reason
from calib.estimation.state import Sample, State, started
from calib.estimation.step import step
from calib.model.resistance import RESISTANCE
from calib.run.blocks import BLOCK, Blocks
from calib.run.driving_record import NOMINAL_RADIUS
from calib.run.lateral import LATERAL_TIME
from calib.run.noise import SensorNoise
from calib.table.table import Table

RANGES = {
    "p_mc": (-1e6, 4e7),
    "a_x": (-30.0, 30.0),
    **{f"omega_{w}": (-50.0, 500.0) for w in WHEELS},
    "steering": (-50.0, 50.0),
    "driven": (0.0, 1.0),
    **{f"T_drive_{axle}": (-2e4, 2e4) for axle in AXLES},
}
"""Range of each channel [SI] that a sensor has while it works."""

JUMPS = {"p_mc": 1e7, "a_x": 15.0}
OMEGA_JUMP, SPIN = 5.0, 5e3
"""Change from sample to sample that only an error of the bus makes: of pressure [Pa], of a_x
[m/s^2], of a wheel [rad/s], and the acceleration of a wheel besides [rad/s^2]."""

HELD_TIME, HELD_PRESSURE = 0.1, 5e5
"""Time [s] for which a_x keeps a value while the pressure moves by so much [Pa], and the car rolls:
it is frozen."""

REASONS = tuple(Reason)

_RESTS = 1.5  # speed of every wheel below which a car may get other numbers [rad/s]


class Told(NamedTuple):
    """An answer: medians with their 95 % bounds, (3,), and a `Reason`; every number is finite."""

    reason: Reason
    level: Array  # brake torque over that of the file's pads [1]
    ratio: Array  # front pads over rear ones [1]
    pad_friction_f: Array
    pad_friction_r: Array
    brake_torque_f: Array  # of one wheel [N m]
    brake_torque_r: Array
    brake_torque_sum: Array


def require_plain(table: Table) -> None:
    """Raise StoreError for a car with known effects that the code of an ECU does not take out."""
    known = known_effects(table)
    more = [name for name in known.names if name not in RESISTANCE]
    if more or known.terms:
        raise StoreError(
            f"the code takes out no {', '.join(more) or 'empirical term'}",
            expected=" and ".join(RESISTANCE) + " alone",
            do="hand out the table in another format, and take the effect out before it is read",
        )


@dataclass(frozen=True)
class Timing:
    """Samples of a block, and its length [s]; blocks before a bite on which no zero rests."""

    samples: int
    block: float
    waiting: int

    @classmethod
    def of(cls, sample_time: float) -> "Timing":
        """By the time from sample to sample [s], as a log of it is averaged."""
        samples = max(1, round(BLOCK / sample_time))
        block = round(samples * sample_time, 9)
        return cls(samples, block, max(1, round(Constants.before_bite / block)))


class Online:
    """One ECU with a table; ``sample_time`` [s] of its task.

    Raises StoreError as `require_plain`.
    """

    def __init__(self, table: Table, sample_time: float) -> None:
        require_plain(table)
        self.table, self.sample_time, self.timing = table, sample_time, Timing.of(sample_time)
        self.constants = constants(table, SensorNoise(**table.noise), self.timing.block)
        self.state: State = started(self.constants)
        self.last, self.raw = dict.fromkeys(RANGES, 0.0), dict.fromkeys(RANGES, 0.0)
        self.jumps = dict.fromkeys(RANGES, math.inf) | JUMPS
        self.jumps |= {f"omega_{w}": OMEGA_JUMP + SPIN * sample_time for w in WHEELS}
        self.fastest, self.faulty = 0.0, False
        self.begun = False
        self.held, self.p_held, self.lateral, self.since_lock = 0.0, 0.0, 0.0, 2.0 * RECOVER
        self.before = np.zeros((2, len(WHEELS)))
        self.rows: list[tuple[float, ...]] = []
        self.omega: Array | None = None
        car, c = table.vehicle, Constants
        self.filed = np.array([car.front.pad_friction, car.rear.pad_friction])
        self.reason = Reason.NOT_BRAKED
        self.level = np.array([1.0, c.least_level, c.most_level])
        self.ratio = self.filed[0] / self.filed[1] * self.level
        self.pads = self.filed[:, None] * self.level

    def step(self, sample: dict[str, float]) -> Told:
        """Take in a sample, by channel as in `RANGES`, and answer."""
        fine = self._good(sample)
        disturbed = self._disturbed(fine)
        x, self.begun = self.last, True
        front, rear = (0.5 * (x[f"omega_{a}l"] + x[f"omega_{a}r"]) for a in "fr")
        driven = x["driven"] > 0.5
        drive = x["T_drive_f"], x["T_drive_r"]
        self.rows.append((x["p_mc"], -x["a_x"] / G, front, rear, *drive, disturbed, driven))
        if len(self.rows) == self.timing.samples:
            self._take()
        return self._told(x["p_mc"], fine)

    def run(self, samples: Array) -> Array:
        """Answers (n, 22) to samples (n, 10), as `bte_run` has them."""
        rows = (dict(zip(RANGES, row, strict=True)) for row in samples.tolist())
        return np.array([(one.reason, *np.concatenate(one[1:])) for one in map(self.step, rows)])

    def exchange(self, table: Table) -> bool:
        """Take another table and forget everything; only at rest, else False."""
        if max(abs(self.last[f"omega_{w}"]) for w in WHEELS) >= _RESTS:
            return False
        self.__init__(table, self.sample_time)  # type: ignore[misc]
        return True

    def _good(self, sample: dict[str, float]) -> bool:
        """Whether all sensors work; the last good reading of one that fails counts."""
        same, fine = self.begun and sample["a_x"] == self.last["a_x"], True
        for name, (low, high) in RANGES.items():
            x = sample[name]
            inside = low <= x <= high
            good = inside and not (self.begun and abs(x - self.raw[name]) > self.jumps[name])
            self.raw[name] = x if inside else self.raw[name]
            self.last[name] = x if good else self.last[name]
            fine = fine and good
        self.held = self.held + self.sample_time if same else 0.0
        self.p_held = self.p_held if same else self.last["p_mc"]
        moved = abs(self.last["p_mc"] - self.p_held)
        rim = self.table.vehicle.front.rolling_radius * self.last["omega_fl"]
        held = self.held > HELD_TIME - 0.5 * self.sample_time  # else a rounding could decide it
        return fine and not (held and moved > HELD_PRESSURE and rim > MOVING)

    def _disturbed(self, fine: bool) -> Reason:
        """As `disturbances` of a log, by what is past."""
        x, car = self.last, self.table.vehicle
        wheels = np.array([x[f"omega_{w}"] for w in WHEELS])
        seen = np.vstack([self.before, wheels]) if self.begun else np.tile(wheels, (3, 1))
        self.before = seen[1:]
        middle = np.median(seen, axis=0)
        mean = 0.5 * (wheels[2] + wheels[3])
        speed = car.rear.rolling_radius * mean
        slowed = self.fastest - HARDEST / NOMINAL_RADIUS * self.sample_time
        self.fastest = fastest = max(middle.max(), slowed)
        locks = fastest - middle.min() > LOCK * max(fastest, 1.0)
        locks = locks and fastest > MOVING / NOMINAL_RADIUS
        self.since_lock = 0.0 if locks else self.since_lock + self.sample_time
        z = -x["a_x"] / G
        slip = math.copysign(np.interp(abs(z), self.table.tyre.force, self.table.tyre.slip), z)
        leaned = 4.0 * max(slip, 0.0) * car.cg_height / (G * car.track_width)
        turned = (wheels[3] - wheels[2]) / max(mean, 1.0)
        turned /= car.track_width / max(speed, MOVING) ** 2 + leaned
        part = 1.0 - math.exp(-self.sample_time / LATERAL_TIME)
        self.lateral = self.lateral + part * (turned - self.lateral) if self.begun else turned
        causes = (
            (Reason.FAULT, not fine),
            (Reason.LOCKED, self.since_lock <= RECOVER + 0.5 * self.sample_time),
            (Reason.CORNERS, not abs(self.lateral) < LATERAL),
            (Reason.TURNED, not abs(x["steering"]) < STEERING),
        )
        return next((reason for reason, holds in causes if holds), Reason.VALID)

    def _take(self) -> None:
        """The block that is complete."""
        means = np.mean(self.rows, axis=0)
        p, z, omega, drive = means[0], means[1], means[2:4], means[4:6]
        worst, driven = np.max(self.rows, axis=0)[6:]
        nothing, car = np.zeros(1), self.table.vehicle
        spin = np.zeros(2) if self.omega is None else (omega - self.omega) / self.timing.block
        if self.faulty or worst == Reason.FAULT:  # of a reading that was held nothing is known
            spin = -G * z / np.array([car.front.rolling_radius, car.rear.rolling_radius])
        self.omega, self.faulty = omega, worst == Reason.FAULT
        self.rows = []
        b = Blocks(
            end=nothing, p_f=p + nothing, p_r=p + nothing,
            drive_f=drive[0] + nothing, drive_r=drive[1] + nothing,
            z=z + nothing, omega_f=omega[0] + nothing, omega_r=omega[1] + nothing, v=None,
            speed=car.rear.rolling_radius * omega[1] + nothing,
            spin_f=spin[0] + nothing, spin_r=spin[1] + nothing, lead_in=nothing > 0.0,
            samples=self.timing.samples, length=self.timing.block,
        )  # fmt: skip
        rows = given(self.table, b, worst + nothing, with_v=False)._replace(driven=driven + nothing)
        answer = step(self.constants, self.state, Sample(*(float(x[0]) for x in rows)))
        share = front_share(car, rows.log_odds)
        pads = pads_of(share, answer.level[:, None], answer.ratio[:, None])[..., 0]
        self.pads = self.filed[:, None] * pads
        self.level = np.exp(answer.level)
        self.ratio = self.filed[0] / self.filed[1] * np.exp(answer.ratio)
        self.reason = REASONS[int(answer.reason)]

    def _told(self, p_mc: float, fine: bool) -> Told:
        car = self.table.vehicle
        gains = np.array([car.front.torque_gain, car.rear.torque_gain])
        torques = gains[:, None] * max(p_mc, 0.0) * self.pads
        total = self.level / self.level[0] * 2.0 * np.sum(torques[:, 0])
        reason = self.reason if fine else Reason.FAULT
        front, rear = self.pads
        torque_f, torque_r = torques
        return Told(reason, self.level, self.ratio, front, rear, torque_f, torque_r, total)
