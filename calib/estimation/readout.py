"""A log through the step of the table: pad friction and torque of both axles, each with its bounds.

    signals --blocks--> step --> level, ratio --samples--> pads, torques, their sum

What is handed out: the same numbers for every command, and for an ECU without a speed.
"""

from dataclasses import dataclass, replace

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.base.intervals import Z95
from calib.car.balance import ForceBalance, brake_forces
from calib.car.bias import front_share
from calib.car.braking import BITE
from calib.car.forces import speed_ratio
from calib.car.vehicle import Vehicle
from calib.estimation.constants import constants
from calib.estimation.known import known_slips
from calib.estimation.reasons import Reason
from calib.estimation.state import Sample
from calib.estimation.step import Answer, run
from calib.run.axle_signals import Signals
from calib.run.blocks import Blocks
from calib.run.noise import SensorNoise
from calib.table.table import Table


@dataclass(frozen=True)
class Bounded:
    """A quantity with its 95 % interval, (n,) each."""

    value: Array
    lower: Array
    upper: Array

    def at(self, which: Index | Mask) -> "Bounded":
        """The same at other places."""
        return Bounded(self.value[which], self.lower[which], self.upper[which])

    @property
    def sigma(self) -> Array:
        """Standard deviation of the logarithm of the quantity (n,), by its interval."""
        return np.log(self.upper / self.lower) / (2.0 * Z95)

    def deviations(self, true: Array) -> Array:
        """How far its logarithm is from that of ``true``, in standard deviations (n,).

        By the side that looks there: what is inside the interval is within 1.96 of them.
        """
        side = np.where(true > self.value, self.upper / self.value, self.value / self.lower)
        return np.log(self.value / true) / (np.log(side) / Z95)

    def times(self, factor: Array | float) -> "Bounded":
        """The same times a factor that is known."""
        return Bounded(factor * self.value, factor * self.lower, factor * self.upper)


@dataclass(frozen=True)
class Readout:
    """What the step gives for each sample, (n,).

    ``level`` sum of the brake torques over that of the file's pads, ``pads_f``, ``pads_r`` pad
    friction, ``change_f``, ``change_r`` pad friction over that of the ramp, all [1];
    ``torque_f``, ``torque_r`` of one wheel, ``torque_sum`` of all [N m]; ``reason`` a `Reason`;
    ``lag`` of the brakes [s]; ``ratio`` front pads over rear ones [1], ``change`` its ln over that
    of the ramp; ``noise``, ``accelerometer`` variance of ln of the level, ``zeros`` of that of the
    ratio by sensors; ``slip`` ln(slip/z) with its ``slip_sigma``. ``innovation`` of the wheels is
    of each block, in standard deviations (k,).
    """

    level: Bounded
    pads_f: Bounded
    pads_r: Bounded
    change_f: Bounded
    change_r: Bounded
    torque_f: Bounded
    torque_r: Bounded
    torque_sum: Bounded
    ratio: Bounded
    change: Bounded
    noise: Array
    accelerometer: Array
    zeros: Array
    lag: Array
    slip: Array
    slip_sigma: Array
    innovation: Array
    reason: Index

    def without(self, factor_f: Array | float, factor_r: Array | float) -> "Readout":
        """The same with pad frictions of which known effects are taken out by these factors."""
        front, rear = self.pads_f.times(factor_f), self.pads_r.times(factor_r)
        return replace(self, pads_f=front, pads_r=rear)

    @property
    def valid(self) -> Mask:
        """Samples in which the model holds."""
        return np.asarray(self.reason == Reason.VALID)

    def columns(self) -> dict[str, Array | Mask]:
        """By the names of a file; torque is per wheel, both wheels of an axle have the same."""
        named = {
            "pad_friction_f": self.pads_f,
            "pad_friction_r": self.pads_r,
            "pad_change_f": self.change_f,
            "pad_change_r": self.change_r,
            "pad_level": self.level,
            "pad_ratio": self.ratio,
            "brake_torque_fl": self.torque_f,
            "brake_torque_fr": self.torque_f,
            "brake_torque_rl": self.torque_r,
            "brake_torque_rr": self.torque_r,
            "brake_torque_sum": self.torque_sum,
        }
        out: dict[str, Array | Mask] = {}
        for name, x in named.items():
            out |= {name: x.value, f"{name}_lower": x.lower, f"{name}_upper": x.upper}
        return out


_PARTS = ("noise", "accelerometer", "zeros", "lag", "slip", "slip_sigma")


def read_out(
    table: Table,
    noise: SensorNoise,
    s: Signals,
    b: Blocks,
    road: ForceBalance,
    disturbed: Index,
    *,
    with_v: bool = True,
) -> Readout:
    """Run the step of a ``table`` over the signals of a log.

    The table's vehicle is as driven, with the pads of the file; ``b`` means of the signals over
    blocks and ``road`` their balance; ``disturbed`` as `disturbances` has it, (n,); ``with_v``
    whether the reference speed is used where it is logged.
    """
    car = table.vehicle
    B_f, B_r = brake_forces(car, b.p_f, b.p_r)
    R = car.front.rolling_radius
    driven = known_slips(table, road)
    columns = (
        road.demanded / car.weight,
        (B_f + B_r) / car.weight,
        np.maximum(b.p_f, b.p_r),
        b.z,
        b.eta / speed_ratio(*driven),
        np.maximum(R * b.omega_f / (1.0 - driven[0]), 0.3),
        road.load_r / car.weight,
        b.v if with_v and b.v is not None else np.full(b.end.size, np.nan),
        disturbed[: b.end.size * b.samples].reshape(-1, b.samples).max(axis=1),
        np.log(np.maximum(b.p_f, 1e4) / np.maximum(b.p_r, 1e4)),
    )
    # by the mean of its sample times a log that goes on would have another length
    c = constants(table, noise, round(b.length, 9))
    answers = run(c, map(Sample._make, zip(*(x.tolist() for x in columns), strict=True)))
    biting = np.maximum(b.p_f, b.p_r) > BITE
    share = np.where(biting, B_f / np.maximum(B_f + B_r, 1.0), front_share(car, 0.0))
    return _per_sample(table, car, s, (answers, share), b.last_complete(s.time))


def _per_sample(
    table: Table, car: Vehicle, s: Signals, answers: tuple[Array, Array], at: Index
) -> Readout:
    """From level and ratio of each block to pads and torques of each sample.

    ``answers`` of the step (k, ...), and the share of the front axle with the file's pads (k,).
    """
    a, share_f = answers
    level, ratio, change = (Bounded(*a[:, k : k + 3].T) for k in (0, 3, 6))
    known = _exp(level).at(at)
    pads = table.calibration
    then = pads.pad_log_ratio.value
    front, rear = _pads(share_f, level, ratio)
    # over the ramp's pads: the tyres are those of today, and fall out
    changed = _pads(
        share_f, level, Bounded(*(x + then for x in (change.value, change.lower, change.upper)))
    )
    f, r = car.front, car.rear
    gains = [axle.torque_gain * np.maximum(p, 0.0) for axle, p in ((f, s.p_f), (r, s.p_r))]
    pads_f, pads_r = (x.at(at) for x in (front.times(f.pad_friction), rear.times(r.pad_friction)))
    nominal = 2.0 * (f.pad_friction * gains[0] + r.pad_friction * gains[1])
    torque_f, torque_r = pads_f.times(gains[0]), pads_r.times(gains[1])
    total = 2.0 * (torque_f.value + torque_r.value)
    share = np.divide(total, nominal, out=known.value.copy(), where=nominal > 0.0)
    relative = known.lower / known.value, known.upper / known.value
    return Readout(
        level=Bounded(share, share * relative[0], share * relative[1]),
        pads_f=pads_f,
        pads_r=pads_r,
        change_f=changed[0].at(at).times(f.pad_friction / pads.pad_friction_f.value),
        change_r=changed[1].at(at).times(r.pad_friction / pads.pad_friction_r.value),
        torque_f=torque_f,
        torque_r=torque_r,
        torque_sum=Bounded(total, total * relative[0], total * relative[1]),
        ratio=_exp(ratio).at(at).times(f.pad_friction / r.pad_friction),
        change=change.at(at),
        innovation=a[:, Answer._fields.index("innovation")],
        **{name: a[:, Answer._fields.index(name)][at] for name in _PARTS},
        reason=a[:, Answer._fields.index("reason")][at].astype(np.int64),
    )


def _exp(level: Bounded) -> Bounded:
    """A quantity from its logarithm."""
    return Bounded(np.exp(level.value), np.exp(level.lower), np.exp(level.upper))


def _pads(share: Array, level: Bounded, ratio: Bounded) -> tuple[Bounded, Bounded]:
    """Front and rear pads over those of the file [1] from ln of level and ratio.

    ``share`` of the front axle with the file's pads. Level and ratio err on their own: their
    distances to the bounds add up as squares.
    """

    def more(x: Array) -> tuple[Array, Array]:
        whole = np.log(share * np.exp(x) + 1.0 - share)
        return x - whole, -whole

    (front, rear), (front_low, rear_high), (front_high, rear_low) = (
        more(x) for x in (ratio.value, ratio.lower, ratio.upper)
    )
    below, above = level.value - level.lower, level.upper - level.value
    out = []
    for middle, low, high in ((front, front_low, front_high), (rear, rear_low, rear_high)):
        value = level.value + middle
        out.append(
            _exp(
                Bounded(
                    value,
                    value - np.hypot(below, middle - low),
                    value + np.hypot(above, high - middle),
                )
            )
        )
    return out[0], out[1]
