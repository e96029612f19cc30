"""Run a log through the step of a table: pad friction and torque of both axles, with bounds.

signals --blocks--> step --> level, ratio --> pads, changes --samples--> torques, their sum
"""

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
        """ln of value over ``true``, in standard deviations (n,): +-1.96 at the bounds."""
        # the half of the interval on the side of the truth
        half = np.where(true > self.value, self.upper / self.value, self.value / self.lower)
        return np.log(self.value / true) / (np.log(half) / Z95)


@dataclass(frozen=True)
class Readout:
    """Answer of the step for each sample (n,), and the pads and torques by this answer.

    Pad frictions of an `Estimate` are without known effects on the pads, torques with them.
    """

    inputs: Sample[Array]  # inputs of the step, for each block (k,)
    step: Answer  # answer of the last whole block, for each sample
    level: Bounded  # sum of the brake torques over that of the file's pads [1]
    ratio: Bounded  # front pads over rear ones [1]
    pads_f: Bounded  # pad friction [1]
    pads_r: Bounded
    change_f: Bounded  # pad friction over that of the ramp [1]
    change_r: Bounded
    torque_f: Bounded  # of one wheel [N m]
    torque_r: Bounded
    torque_sum: Bounded  # of all wheels

    @property
    def valid(self) -> Mask:
        """Samples in which the model holds."""
        return np.asarray(self.step.reason == Reason.VALID)

    def with_pads(self, factor_f: Array, factor_r: Array) -> "Readout":
        """Return the readout with pad frictions times a factor (n,)."""
        pads_f = Bounded(*(factor_f * x for x in self.pads_f))
        pads_r = Bounded(*(factor_r * x for x in self.pads_r))
        return replace(self, pads_f=pads_f, pads_r=pads_r)

    def take(self, rows: Index) -> "Readout":
        """Return the samples at ``rows`` alone."""
        fields = [(name, x) for name, x in vars(self).items() if isinstance(x, Bounded)]
        at_rows: dict[str, Any] = {name: Bounded(*(y[rows] for y in x)) for name, x in fields}
        return replace(self, step=self.step.take(rows), **at_rows)

    def columns(self) -> dict[str, Array | Mask]:
        """Return the columns of an answer by the names of `UNITS`, in the same order."""
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
ENDS = "", "_lower", "_upper"  # endings of three columns: a median and its bounds
UNITS = {
    f"{name}{end}": "N*m" if "torque" in name else "1"
    for name in FIELDS
    for end in (ENDS[:1] if name == "valid" else ENDS)
}
"""Units of the columns of an answer by name, in the order of the columns."""


def read_out(
    table: Table,
    noise: SensorNoise,
    s: Signals,
    b: Blocks,
    disturbed: Index,
    driven: Mask | bool = False,
) -> Readout:
    """Run the step of a ``table`` over the signals ``s`` of a log, with means over blocks ``b``.

    The table's vehicle is as driven, with the pads of the file. ``disturbed`` (n,) is as by
    `disturbances`, ``driven`` (n,) is whether the accelerator is pressed.
    """
    whole, by_block = b.end.size * b.samples, (-1, b.samples)  # samples in whole blocks
    reason = disturbed[:whole].reshape(by_block).max(axis=1)
    pressed = np.broadcast_to(driven, s.time.shape)[:whole].reshape(by_block).max(axis=1)
    x = step_inputs(table, b, reason, pressed)
    c = constants(table, noise, b.length)
    answer = with_before(c, run(c, x))
    # number of blocks that ended up to each sample: their place in ``answer``, whose first entry is
    # the answer before any block
    block = np.searchsorted(b.end, s.time, side="right")
    pads = [quantity[:, block] for quantity in pads_of_blocks(table, x, answer)]
    level, _, pads_f, pads_r, *_ = pads
    torques = torques_of(table.vehicle, (s.p_f, s.p_r), level, (pads_f, pads_r))
    # in the order of the fields of a `Readout`
    return Readout(x, answer.take(block), *(Bounded(*quantity) for quantity in (*pads, *torques)))


def torques_of(
    car: Vehicle, pressures: tuple[Array | float, Array | float], level: Array, pads: Pair
) -> tuple[Array, Array, Array]:
    """Return the torque of a front wheel, of a rear wheel and of all [N m], (3, n) each, by (S16).

    ``pressures`` are those of the axles [Pa] (n,); ``level`` and ``pads`` [1] have bounds (3, n).
    """
    front = car.front.torque_gain * np.maximum(pressures[0], 0.0) * pads[0]
    rear = car.rear.torque_gain * np.maximum(pressures[1], 0.0) * pads[1]
    total = 2.0 * (front[0] + rear[0])
    return front, rear, level / level[0] * total  # its relative bounds are those of the level


def pads_of_blocks(table: Table, x: Sample[Array], answer: Answer) -> tuple[Array, ...]:
    """Return level, ratio, pads of both axles, and their quotients by the ramp's, (3, 1 + k) each.

    ``x`` are the inputs of blocks (k,), ``answer`` is that of `with_before` (1 + k,).
    """
    car, calibration = table.vehicle, table.calibration
    log_odds = np.concatenate([x.log_odds[:1], x.log_odds])  # also for the answer before any block
    share = front_share(car, log_odds)
    file_pads = np.array([car.front.pad_friction, car.rear.pad_friction])
    ramp_pads = np.array([calibration.pad_friction_f.value, calibration.pad_friction_r.value])
    pads = file_pads[:, None, None] * _pads_of(share, answer.level, answer.ratio)
    # the bounds of the quotients are those of level and change: the ramp's ratio counts as exact
    ratio = calibration.pad_log_ratio.value + answer.change
    changes = (file_pads / ramp_pads)[:, None, None] * _pads_of(share, answer.level, ratio)
    level, ratio_over_file = np.exp(answer.level), np.exp(answer.ratio)
    return level, file_pads[0] / file_pads[1] * ratio_over_file, *pads, *changes


def with_before(c: Constants, answer: Answer) -> Answer:
    """Prepend the answer before any block, with the widest bounds: (1 + k,) for k blocks."""
    answer = answer.take(np.append(0, np.arange(answer.reason.size)))
    for x in (answer.level, answer.ratio, answer.change):
        x[:, 0] = np.log([1.0, c.least_level, c.most_level])
    answer.reason[0], answer.diagnosis[0] = Reason.NOT_BRAKED, 0.0
    return answer


def step_inputs(table: Table, b: Blocks, disturbed: Index, driven: Mask) -> Sample[Array]:
    """Return the inputs of the step (k,), without known resistance and slips by known effects.

    ``disturbed`` is the `Reason` of each block (k,), ``driven`` whether the accelerator is pressed.
    """
    car = table.vehicle
    brake_f, brake_r = brake_forces(car, b.p_f, b.p_r)
    road = block_balance(car, known_effects(table), b)
    slips = known_slips(table, road)
    eta_less_1 = b.eta / speed_ratio(*slips) - 1.0
    drive = b.drive_f / car.front.rolling_radius + b.drive_r / car.rear.rolling_radius  # [N]
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
        # ln of front over rear pressure, 0.1 bar at least, adds to the log odds of the front share
        log_odds=np.log(np.maximum(b.p_f, 1e4) / np.maximum(b.p_r, 1e4)),
        driven=driven.astype(np.float64),
        drive=drive / car.weight,
        eta_by_drive=eta_less_1 - (b.eta - 1.0),
    )


def _pads_of(share: Array, level: Array, ratio: Array) -> Array:
    """Return front and rear pads over those of the file [1], with bounds (2, 3, k), (S14), (S15).

    ``share`` is that of the front axle with the file's pads (k,), ``level`` and ``ratio`` are
    logarithms (3, k) with independent errors: distances to the bounds add up as squares.
    """
    log_rear = -np.log(share * np.exp(ratio) + 1.0 - share)
    # ln of the pads at a level of 1, (2, 3, k); a higher ratio means weaker rear pads
    log_pads = np.stack([ratio + log_rear, log_rear[[0, 2, 1]]])
    # ln of an axle's pads (3, k): the bounds of the level about the median of the pads, widened by
    # the distances of the bounds of the pads
    return np.exp(np.stack([widened(level + axle[0], axle[0] - axle) for axle in log_pads]))
