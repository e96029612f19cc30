r"""The estimator of the table: one step for each block of 50 ms, causal, with fixed memory.

    sample --follow--> what is seen: level, slip, means of z and eta - 1
           --answer--> level; the map: ln of the pads' ratio, given the slip; with 95 % bounds
            --keep---> the best informed ratio, which ages as pads that warm up do

What is recursive stands in `calib.estimation.state`; the rest is a function of the state, written
once for any number of blocks: those of a whole log, or one.
"""

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.base.intervals import Z95
from calib.estimation.constants import LEVEL, PADS, Constants
from calib.estimation.reasons import Reason
from calib.estimation.state import LEAST, USUAL_Z, Numbers, Sample, Seen, State, follow, started


class Answer(NamedTuple):
    """What is told of each block: its median with the 95 % bounds, (3, k), or one number, (k,)."""

    level: Array  # ln of the pads' level
    ratio: Array  # ln of the ratio of the pads over that of the file's
    change: Array  # of it since the ramp
    noise: Array  # variance of the level by noise
    accelerometer: Array  # and by a_x
    zeros: Array  # variance of the ratio by what is read
    slip: Array  # ln(slip/z)
    slip_sigma: Array
    innovation: Array  # of the wheels, in standard deviations; NaN where they do not count
    reason: Array  # a `Reason`

    def at(self, which: int | Index) -> "Answer":
        """The same at other places."""
        return Answer(*(x[..., which] for x in self))


def step(c: Constants, s: State, x: Sample) -> Answer:
    """Take in a block, and answer. Changes the state."""
    return _answers(c, s, [follow(c, s, x)]).at(0)


def run(c: Constants, samples: Iterable[Sample]) -> Answer:
    """The answers of `step`, block by block from the start."""
    s = started(c)
    return _answers(c, s, [follow(c, s, x) for x in samples])


def _answers(c: Constants, s: State, blocks: Sequence[Numbers]) -> Answer:
    """Answer each block."""
    seen = Seen(*np.array(blocks).T)
    z = np.where(seen.z > 0.0, seen.z, USUAL_Z)
    before, at = c.level(z), seen.shift / z
    log_slip, sigma = c.ratio(z, at, 0.0 * z)[len(PADS) :]
    # what the map says of the slip, and by it of the scale of a_x
    gain, rest = 1.0 / (seen.slip_variance + sigma**2), log_slip - seen.slip
    e = seen.scale + gain * seen.covariance * rest
    slip = seen.slip + gain * seen.slip_variance * rest
    slip_sigma = np.sqrt(gain * seen.slip_variance) * sigma
    accelerometer = seen.demand_variance / z**2
    accelerometer = accelerometer + np.maximum(seen.scale_variance - gain * seen.covariance**2, 0.0)
    known = before[: len(LEVEL)]
    noisy = Z95 * np.sqrt(seen.level_variance + accelerometer)
    level = widened(known, noisy) + np.log(seen.level * np.maximum(1.0 - e, LEAST))
    of_map = np.asarray((c.ratio.axes[1][0] <= at) & (at <= c.ratio.axes[1][-1]))
    axis, told = ((slip - log_slip) / sigma, slip_sigma / sigma), of_map & (seen.z >= c.least_z)
    prior = before[len(LEVEL) :].reshape(3, 2, -1)
    now, read = _look(c, seen._replace(z=z), axis, prior, told)
    pads, zeros = _keep(c, s, now, read, seen.level, seen.z == 0.0)
    possible = (np.exp(level[0]) > c.least_level) & (np.exp(level[0]) < c.most_level)
    reason = np.select(
        [seen.reason > Reason.VALID, ~possible, ~of_map],
        [seen.reason, Reason.NO_PAD, Reason.BEYOND_MAP],
        Reason.VALID,
    )
    return Answer(
        level, pads[:, 0], pads[:, 1], seen.level_variance, accelerometer, zeros,
        slip, slip_sigma, seen.innovation, reason,
    )  # fmt: skip


def widened(x: Array, more: Array) -> Array:
    """A median with its bounds (3, ...), these farther away by ``more``, added as squares.

    ``more`` may be of both (...), or of the median and each bound (3, ...).
    """
    away = np.hypot(x - x[0], more)
    return np.stack([x[0], x[0] - away[1], x[0] + away[2]])


def _look(
    c: Constants, seen: Seen, slip: tuple[Array, Array], prior: Array, told: Mask
) -> tuple[Array, Array]:
    """Medians and bounds of ln of the ratio and of its change (3, 2, n); variance by reading (n,).

    ``slip`` and its sigma, along the axis of the map; ``prior`` before eta is read, where it is not
    ``told`` or the map knows no more.
    """
    at, sigma, none = seen.shift / seen.z, np.sqrt(seen.shift_variance) / seen.z, 0.0 * seen.z
    h, k = np.minimum(sigma, c.ratio.width(1, at)), np.minimum(slip[1], 1.0)
    read = c.ratio(
        np.broadcast_to(seen.z, (5, at.size)),
        at + np.stack([none, -h, h, none, none]),
        slip[0] + np.stack([none, none, none, -k, k]),
    )[: len(PADS)].reshape(3, 2, 5, -1)
    now, zeros = read[:, :, 0], none
    for low, high, spread in ((1, 2, sigma / h), (3, 4, slip[1] / k)):
        more = 0.5 * Z95 * spread * (read[0, :, high] - read[0, :, low])
        now, zeros = widened(now, more), zeros + (more[0] / Z95) ** 2
    told = told & (now[2, 0] - now[1, 0] < prior[2, 0] - prior[1, 0])
    now, zeros = np.where(told, now, prior), np.where(told, zeros, 0.0)
    # the map has the ratio of the brake forces, about the pressures that the axles had on the ramp
    moved = seen.log_odds - (prior[0, 0] - c.ramp_ratio)
    open_ = ((now[2, 0] - now[1, 0]) / (prior[2, 0] - prior[1, 0])) ** 2
    now[:, 0] += open_ * moved - seen.log_odds
    return now, zeros


def _keep(
    c: Constants, s: State, now: Array, zeros: Array, level: Array, new: Mask
) -> tuple[Array, Array]:
    """The best informed ratio so far, as it is known at each block, of the shapes of `_look`.

    It ages as pads warm up, and those that changed did so unlike. Stops begin ``new``.
    """
    kept, aged = [], []
    rows = np.vstack([now.reshape(6, -1), zeros]).T.tolist()
    for row, a, first in zip(rows, level.tolist(), new.tolist(), strict=True):
        variance = c.ageing**2 * s.age + (c.unlike * math.log(a / s.level_then)) ** 2
        more, (middle, _, low, _, high, *_) = Z95 * math.sqrt(variance), s.kept
        known = math.hypot(middle - low, more) + math.hypot(high - middle, more)
        if first or row[4] - row[2] <= known:
            s.kept, s.age, s.level_then, variance = row, 0.0, a, 0.0
        s.age += c.block
        kept.append(s.kept)
        aged.append(variance)
    out, more_variance = np.array(kept).T, np.array(aged)
    return widened(out[:6].reshape(3, 2, -1), Z95 * np.sqrt(more_variance)), out[6] + more_variance
