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
from calib.car.braking import MOVING
from calib.estimation.constants import LEVEL, PADS, Constants
from calib.estimation.reasons import Reason
from calib.estimation.state import LEAST_Z, Numbers, Sample, State, follow, started


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


_LEAST, _USUAL_Z = 0.02, 0.1
"""Level, or share of the pressure that acts, below which there is none [1]; deceleration at which
the maps are read before any braking [1]."""


def _answers(c: Constants, s: State, blocks: Sequence[Numbers]) -> Answer:
    """Answer each block, as `follow` left it."""
    rows = np.array(blocks).T
    # nine of the level, four sums, fourteen of the speed: `State`; then what follows them
    steady, aa = np.maximum(rows[0], _LEAST), rows[3]
    weight, sum_z, sum_shift, sum_zz = rows[9:13]
    v, log_slip, _, scale, *_, ss, _, se, _, _, ee = rows[13:27]
    demand_variance, eta_variance, acts, innovation, *asked, log_odds = rows[27:]
    new, count = weight == 0.0, np.maximum(weight, 1.0)
    z = np.where(new, _USUAL_Z, np.maximum(sum_z / count, LEAST_Z))
    shift, before = sum_shift / count, c.level(z)
    # what the map says of the slip, and by it of the scale of a_x
    usual, sigma = c.ratio(z, shift / z, 0.0 * z)[len(PADS) :]
    gain, rest = 1.0 / (ss + sigma**2), usual - log_slip
    slip, slip_sigma = log_slip + gain * ss * rest, np.sqrt(gain * ss) * sigma
    scaled = np.maximum(1.0 - scale - gain * se * rest, _LEAST)
    # friction as it is now, of the pressure as it is now
    pads = steady * np.clip(acts, _LEAST, 1.0 / _LEAST)
    noise = np.minimum(np.maximum(aa, 0.0) / steady**2, 1.0)
    accelerometer = demand_variance / z**2 + np.maximum(ee - gain * se**2, 0.0)
    level = widened(before[: len(LEVEL)], Z95 * np.sqrt(noise + accelerometer))
    level = level + np.log(pads * scaled)
    # a mean over decelerations that differ is not the curve at their mean
    bent = shift * np.maximum(sum_zz / count / z**2 - 1.0, 0.0)
    wheels = c.noise_omega * c.radius / np.maximum(v, 1.0) / np.sqrt(c.block * count)
    at = z, shift / z, (slip - usual) / sigma
    errors = np.sqrt(wheels**2 + eta_variance + bent**2) / z, slip_sigma / sigma
    of_map = np.asarray((c.ratio.axes[1][0] <= at[1]) & (at[1] <= c.ratio.axes[1][-1]))
    prior = before[len(LEVEL) :].reshape(3, 2, -1)
    now, zeros = _look(c, at, errors, prior, of_map & ~new & (z >= c.least_z))
    # the map has the ratio of the brake forces, about the pressures that the axles had on the ramp
    unread = ((now[2, 0] - now[1, 0]) / (prior[2, 0] - prior[1, 0])) ** 2
    now[:, 0] += unread * (log_odds - prior[0, 0] + c.ramp_ratio) - log_odds
    best, zeros = _keep(c, s, now, zeros, pads, new)
    reason = _reasons(c, asked, np.exp(level[0]), of_map)
    return Answer(
        level, best[:, 0], best[:, 1], noise, accelerometer, zeros,
        slip, slip_sigma, innovation, reason,
    )  # fmt: skip


def _reasons(c: Constants, asked: Sequence[Array], level: Array, of_map: Mask) -> Array:
    """The first `Reason` that applies, by time braked, pressure, rim and disturbance ``asked``."""
    braked, pressure, rim, disturbed = asked
    holds = [
        pressure <= c.least_pressure,
        disturbed > 0.0,  # before the rims: those of locked wheels are slow
        rim <= MOVING,
        braked < c.settle - 0.5 * c.block,
        (level <= c.least_level) | (level >= c.most_level),
        ~of_map,
    ]
    pads = Reason.JUST_APPLIED, Reason.NO_PAD, Reason.BEYOND_MAP
    return np.select(holds, [Reason.NOT_BRAKED, disturbed, Reason.SLOW, *pads], Reason.VALID)


def widened(x: Array, more: Array) -> Array:
    """A median with its bounds (3, ...), these farther away by ``more``, added as squares.

    ``more`` may be of both (...), or of the median and each bound (3, ...).
    """
    away = np.hypot(x - x[0], more)
    return np.stack([x[0], x[0] - away[1], x[0] + away[2]])


def _look(
    c: Constants, at: Sequence[Array], errors: tuple[Array, Array], prior: Array, told: Mask
) -> tuple[Array, Array]:
    """Medians and bounds of ln of the ratio and of its change (3, 2, n); variance by reading (n,).

    ``at`` the three axes of the map, the last two with ``errors``; ``prior`` before eta is read,
    where it is not ``told`` or the map knows no more.
    """
    steps = np.minimum(errors[0], c.ratio.width(1, at[1])), np.minimum(errors[1], 1.0)
    places = np.repeat(np.stack(at)[:, None], 5, axis=1)
    places[1, 1:3] += np.multiply.outer((-1.0, 1.0), steps[0])
    places[2, 3:5] += np.multiply.outer((-1.0, 1.0), steps[1])
    read = c.ratio(*places)[: len(PADS)].reshape(3, 2, 5, -1)
    now, zeros = read[:, :, 0], 0.0 * at[0]
    for low, high, spread in ((1, 2, errors[0] / steps[0]), (3, 4, errors[1] / steps[1])):
        more = 0.5 * Z95 * spread * (read[0, :, high] - read[0, :, low])
        now, zeros = widened(now, more), zeros + (more[0] / Z95) ** 2
    told = told & (now[2, 0] - now[1, 0] < prior[2, 0] - prior[1, 0])
    return np.where(told, now, prior), np.where(told, zeros, 0.0)


def _keep(
    c: Constants, s: State, now: Array, zeros: Array, level: Array, new: Mask
) -> tuple[Array, Array]:
    """The best informed ratio so far, as it is known at each block, of the shapes of `_look`.

    It ages as pads warm up, and those that changed did so unlike. Stops begin ``new``.
    """
    kept, aged = [], []
    rows = np.vstack([now.reshape(6, -1), zeros]).T.tolist()
    for row, a, first in zip(rows, level.tolist(), new.tolist(), strict=True):
        better, variance = first, 0.0
        if not first:
            variance = c.ageing**2 * s.age + (c.unlike * math.log(a / s.level_then)) ** 2
            more, (middle, _, low, _, high, *_) = Z95 * math.sqrt(variance), s.kept
            known = math.hypot(middle - low, more) + math.hypot(high - middle, more)
            better = row[4] - row[2] <= known
        if better:
            s.kept, s.age, s.level_then, variance = row, 0.0, a, 0.0
        s.age += c.block
        kept.append(s.kept)
        aged.append(variance)
    out, more_variance = np.array(kept).T, np.array(aged)
    return widened(out[:6].reshape(3, 2, -1), Z95 * np.sqrt(more_variance)), out[6] + more_variance
