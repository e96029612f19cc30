"""Run a log through the step of a table: pad friction and torque of both axles, with bounds.

signals --blocks--> step --> level, ratio --samples--> pads, torques, their sum
"""

import itertools
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.base.intervals import Z95
from calib.base.names import AXLES, WHEELS
from calib.car.balance import brake_forces, front_share
from calib.car.effects.effect import Pair
from calib.car.forces import speed_ratio
from calib.car.vehicle import Vehicle
from calib.estimation.constants import Constants, constants
from calib.estimation.known import known_effects, known_slips
from calib.estimation.reasons import Reason
from calib.estimation.state import Sample
from calib.estimation.step import Answer, run, widened
from calib.run.axle_signals import Signals
from calib.run.blocks import Blocks, block_balance
from calib.run.noise import SensorNoise
from calib.table.table import Table


class Bounded(NamedTuple):
    """A quantity with its 95 % interval, (n,) each."""

    value: Array
    lower: Array
    upper: Array

    @property
    def sigma(self) -> Array:
        """Standard deviation of the logarithm of the quantity (n,), by its interval."""
        return np.log(self.upper / self.lower) / (2.0 * Z95)

    def deviations(self, true: Array) -> Array:
        """ln of value over ``true``, in standard deviations (n,): +-1.96 at the bounds.

        The standard deviation is that of the half of the interval on the side of the truth.
        """
        side = np.where(true > self.value, self.upper / self.value, self.value / self.lower)
        return np.log(self.value / true) / (np.log(side) / Z95)


@dataclass(frozen=True)
class Readout:
    """The answer of the step for each sample, (n,), and the pads and torques by this answer.

    Pad frictions are without known effects, torques are those that act.
    """

    inputs: Sample[Array]  # of the step, for each block
    step: Answer  # for each sample that of the last whole block
    level: Bounded  # sum of the brake torques over that of the file's pads [1]
    ratio: Bounded  # front pads over rear ones [1]
    pads_f: Bounded  # pad friction [1]
    pads_r: Bounded
    change_f: Bounded  # pad friction over that of the ramp [1]
    change_r: Bounded
    torque_f: Bounded  # of one wheel [N m]
    torque_r: Bounded
    torque_sum: Bounded  # of all

    @property
    def valid(self) -> Mask:
        """Samples in which the model holds."""
        return np.asarray(self.step.reason == Reason.VALID)

    def with_pads(self, factor_f: Array, factor_r: Array) -> "Readout":
        """The same with pad frictions times a factor (n,)."""
        pads_f, pads_r = (
            Bounded(*(factor * x for x in pads))
            for pads, factor in ((self.pads_f, factor_f), (self.pads_r, factor_r))
        )
        return replace(self, pads_f=pads_f, pads_r=pads_r)

    def take(self, rows: Index) -> "Readout":
        """The samples at ``rows`` alone."""
        bounded = ((name, x) for name, x in vars(self).items() if isinstance(x, Bounded))
        at_rows: dict[str, Any] = {name: Bounded(*(y[rows] for y in x)) for name, x in bounded}
        return replace(self, step=self.step.take(rows), **at_rows)

    def columns(self) -> dict[str, Array | Mask]:
        """The columns of an answer by the names of `UNITS`, in their order."""
        columns: list[Array] = []
        for name in FIELDS.values():
            field = getattr(self, name)
            columns += field if isinstance(field, Bounded) else [field]
        return dict(zip(UNITS, columns, strict=True))


FIELDS = (
    {f"pad_friction_{axle}": f"pads_{axle}" for axle in AXLES}
    | {f"brake_torque_{wheel}": f"torque_{wheel[0]}" for wheel in WHEELS}
    | {"valid": "valid"}
    | {f"pad_change_{axle}": f"change_{axle}" for axle in AXLES}
    | {"pad_level": "level", "pad_ratio": "ratio", "brake_torque_sum": "torque_sum"}
)
"""Fields of a `Readout` by their columns; both wheels of an axle have the same torque."""
UNITS = {
    f"{name}{end}": "N*m" if "torque" in name else "1"
    for name in FIELDS
    for end in (("",) if name == "valid" else ("", "_lower", "_upper"))
}
"""Columns of an answer as a table and as a file, with their units."""


def read_out(
    table: Table,
    noise: SensorNoise,
    s: Signals,
    b: Blocks,
    disturbed: Index,
    driven: Mask | bool = False,
) -> Readout:
    """Run the step of a ``table`` over the signals of a log.

    The table's vehicle is as driven, with the pads of the file. ``b`` are means of the signals
    ``s`` over blocks; ``disturbed`` (n,) as by `disturbances`; ``driven`` (n,) whether the
    accelerator is pressed.
    """
    in_blocks = slice(b.end.size * b.samples)
    worst, thrust = (
        np.broadcast_to(x, s.time.shape)[in_blocks].reshape(-1, b.samples).max(axis=1)
        for x in (disturbed, driven)
    )
    x = step_inputs(table, b, worst, thrust)
    c = constants(table, noise, b.length)
    answer = with_before(c, run(c, x))
    block = np.searchsorted(b.end, s.time, side="right")  # the last complete one, 0 before any
    bounded = [quantity[:, block] for quantity in of_blocks(table, x, answer)]
    level, _, pads_f, pads_r, *_ = bounded
    bounded += torques_of(table.vehicle, (s.p_f, s.p_r), level, (pads_f, pads_r))
    return Readout(x, answer.take(block), *itertools.starmap(Bounded, bounded))


def torques_of(
    car: Vehicle, pressures: tuple[Array | float, Array | float], level: Array, pads: Pair
) -> tuple[Array, Array, Array]:
    """Torque of a front, of a rear wheel and of all [N m], each with its bounds (3, n).

    ``pressures`` of the axles [Pa] (n,); their ``level`` and ``pads`` [1] with bounds (3, n).
    """
    gains = (
        axle.torque_gain * np.maximum(pressure, 0.0)
        for axle, pressure in zip((car.front, car.rear), pressures, strict=True)
    )
    front, rear = (gain * friction for gain, friction in zip(gains, pads, strict=True))
    return front, rear, level / level[0] * 2.0 * (front[0] + rear[0])


def of_blocks(table: Table, x: Sample[Array], answer: Answer) -> tuple[Array, ...]:
    """Level, ratio, pads of both axles and their change since the ramp, each with its bounds.

    ``x`` of blocks (k,), ``answer`` before the first and of each, (1 + k,).
    """
    car, calibration = table.vehicle, table.calibration
    share = front_share(car, np.append(x.log_odds[0], x.log_odds))
    file_pads = np.array([car.front.pad_friction, car.rear.pad_friction])
    ramp_pads = np.array([calibration.pad_friction_f.value, calibration.pad_friction_r.value])
    change = answer.change + calibration.pad_log_ratio.value
    scaled = (file_pads, answer.ratio), (file_pads / ramp_pads, change)
    pads, changed = (by[:, None, None] * _pads_of(share, answer.level, x) for by, x in scaled)
    level, ratio = np.exp(answer.level), np.exp(answer.ratio)
    return level, file_pads[0] / file_pads[1] * ratio, *pads, *changed


def with_before(c: Constants, answer: Answer) -> Answer:
    """Answers (1 + k,) of k blocks; the first, any pads, is for the time before a block ends."""
    answer = answer.take(np.append(0, np.arange(answer.reason.size)))
    for x in (answer.level, answer.ratio, answer.change):
        x[:, 0] = np.log([1.0, c.least_level, c.most_level])
    answer.reason[0], answer.diagnosis[0] = Reason.NOT_BRAKED, 0.0
    return answer


def step_inputs(table: Table, b: Blocks, disturbed: Index, driven: Mask) -> Sample[Array]:
    """Inputs of the step by block (k,), without known resistance and slips by known effects.

    ``disturbed`` is the number of a `Reason` of each block (k,); the others as in `read_out`.
    """
    car = table.vehicle
    brake_f, brake_r = brake_forces(car, b.p_f, b.p_r)
    road = block_balance(car, known_effects(table), b)
    slips = known_slips(table, road)
    eta_less_1 = b.eta / speed_ratio(*slips) - 1.0
    return Sample(
        demand=road.demanded / car.weight,
        nominal=(brake_f + brake_r) / car.weight,
        pressure=np.maximum(b.p_f, b.p_r),
        z=b.z,
        eta_less_1=eta_less_1,
        rim=np.maximum(car.front.rolling_radius * b.omega_f / (1.0 - slips[0]), Constants.slowest),
        rear_share=road.load_r / car.weight,
        v=np.full(b.end.size, np.nan) if b.v is None else b.v,
        disturbed=disturbed.astype(np.float64),
        log_odds=np.log(np.maximum(b.p_f, 1e4) / np.maximum(b.p_r, 1e4)),
        driven=driven.astype(np.float64),
        drive=(b.drive_f / car.front.rolling_radius + b.drive_r / car.rear.rolling_radius)
        / car.weight,
        eta_by_drive=eta_less_1 - (b.eta - 1.0),
    )


def _pads_of(share: Array, level: Array, ratio: Array) -> Array:
    """Front and rear pads over those of the file [1], each with bounds (2, 3, k), by (S14), (S15).

    ``share`` of the front axle with the file's pads (k,), ln of ``level`` and ``ratio`` (3, k).
    Errors of level and ratio are independent: distances to the bounds add up as squares.
    """
    rear = -np.log(share * np.exp(ratio) + 1.0 - share)
    by_ratio = np.stack([ratio + rear, rear[[0, 2, 1]]])  # a higher ratio means weaker rear pads
    return np.exp(np.stack([widened(level + x[0], x[0] - x) for x in by_ratio]))
