r"""The estimator of the table: one step for each block of 50 ms, causal, with fixed memory.

    sample --follow--> what is seen: level, slip, means of z and eta - 1
           --answer--> level; the map: ln of the pads' ratio, given the slip; with 95 % bounds
            --keep---> the best informed ratio, which ages as pads that warm up do

What is recursive stands in `calib.estimation.state`; the rest is a function of the state, written
once for any number of blocks: those of a whole log, or one.
"""

import math
from typing import NamedTuple

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.base.intervals import Z95
from calib.estimation.constants import Constants
from calib.estimation.reasons import Reason
from calib.estimation.state import Sample, Seen, State, follow, started


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
    zero_eta: Array  # what eta reads while nothing brakes, and the slip of all wheels
    zero_slip: Array
    innovation: Array  # of the wheels, in standard deviations; NaN where they do not count
    reason: Array  # a `Reason`

    def at(self, which: int | Index) -> "Answer":
        """The same at other places."""
        return Answer(*(np.take(x, which, axis=-1) for x in self))


def step(c: Constants, s: State, x: Sample[float]) -> Answer:
    """Take in a block, and answer. Changes the state."""
    seen = Seen(*np.array([follow(c, s, x)]).T)
    return _answers(c, s, Sample(*np.array([x]).T), seen).at(0)


def run(c: Constants, x: Sample[Array]) -> Answer:
    """The answers of `step` to each block of a run (k,), from the start."""
    s = started(c)
    rows = zip(*(column.tolist() for column in x), strict=True)
    return _answers(c, s, x, Seen(*np.array([follow(c, s, Sample(*row)) for row in rows]).T))


def _answers(c: Constants, s: State, x: Sample[Array], seen: Seen[Array]) -> Answer:
    """Answer each block (k,), as `follow` left it."""
    new = seen.blocks == 0.0
    z = np.where(new, c.usual_z, seen.z)
    shift = seen.shift / z
    # slip: one of what was measured and what the map has; what it was off, the scale of a_x was
    usual, sigma = c.slip(z, shift, 0.0 * z)
    gain, rest = 1.0 / (seen.slip_variance + sigma**2), usual - seen.log_slip
    slip = seen.log_slip + gain * seen.slip_variance * rest
    slip_sigma = np.sqrt(gain * seen.slip_variance) * sigma
    scaled = np.maximum(1.0 - seen.scale - gain * seen.slip_scale * rest, c.least_share)
    scale_variance = np.maximum(seen.scale_variance - gain * seen.slip_scale**2, 0.0)
    # level: friction as it is now, of the pressure as it is now
    steady = np.maximum(seen.level, c.least_share)
    pads = steady * np.clip(seen.acts, c.least_share, 1.0 / c.least_share)
    noise = np.minimum(np.maximum(seen.level_variance, 0.0) / steady**2, 1.0)
    accelerometer = seen.demand_variance / z**2 + scale_variance
    level = widened(c.level(z), Z95 * np.sqrt(noise + accelerometer)) + np.log(pads * scaled)

    of_map = np.clip(shift, *c.pads.axes[1][[0, -1]]) == shift
    told = of_map & ~new & (z >= c.least_z)
    at = z, shift, (slip - usual) / sigma
    now, zeros = _ratio(c, at, (_eta_error(c, seen, z) / z, slip_sigma / sigma), x.log_odds, told)
    best, zeros = _keep(c, s, now, zeros, pads, (new, seen.adds > 0.0))
    return Answer(
        level, best[:, 0], best[:, 1], noise, accelerometer, zeros,
        slip, slip_sigma, seen.zero_eta, seen.zero_slip, seen.innovation,
        _reasons(c, x, seen.braked, np.exp(level[0]), of_map),
    )  # fmt: skip


def _eta_error(c: Constants, seen: Seen[Array], z: Array) -> Array:
    """Standard deviation of the mean of eta - 1 (k,) by wheels, zero and a changing z."""
    wheels = c.noise_rim / np.maximum(seen.speed, 1.0)
    wheels = wheels / np.sqrt(c.block * np.maximum(seen.blocks, 1.0))
    # a mean over decelerations that differ is not the curve at their mean
    bent = seen.shift * np.maximum(seen.z_squared / z**2 - 1.0, 0.0)
    return np.sqrt(wheels**2 + seen.eta_variance + bent**2)


def _reasons(c: Constants, x: Sample[Array], braked: Array, level: Array, of_map: Mask) -> Array:
    """The first `Reason` that applies to each block (k,)."""
    reasons, hold = zip(
        (Reason.NOT_BRAKED, x.pressure <= c.least_pressure),
        (x.disturbed, x.disturbed > 0.0),  # before the rims: those of locked wheels are slow
        (Reason.SLOW, x.rim <= c.moving),
        (Reason.JUST_APPLIED, braked < c.settle - 0.5 * c.block),
        (Reason.NO_PAD, (level <= c.least_level) | (level >= c.most_level)),
        (Reason.BEYOND_MAP, ~of_map),
        strict=True,
    )
    return np.select(hold, reasons, Reason.VALID)


def widened(x: Array, more: Array) -> Array:
    """A median with its bounds (3, ...), these farther away by ``more``, added as squares.

    ``more`` may be of both (...), or of the median and each bound (3, ...).
    """
    away = np.hypot(x - x[0], more)
    return np.stack([x[0], x[0] - away[1], x[0] + away[2]])


def _ratio(
    c: Constants, at: tuple[Array, ...], errors: tuple[Array, Array], log_odds: Array, told: Mask
) -> tuple[Array, Array]:
    """Medians and bounds of ln of the ratio and of its change (3, 2, k); variance by reading (k,).

    ``at`` the three axes of the map, the last two with ``errors``. Where it is not ``told``, or the
    map knows no more, they are those before eta is read.
    """
    steps = np.minimum(errors[0], c.pads.width(1, at[1])), np.minimum(errors[1], 1.0)
    places = np.repeat(np.stack(at)[:, None], 5, axis=1)
    places[1, 1:3] += np.multiply.outer((-1.0, 1.0), steps[0])
    places[2, 3:5] += np.multiply.outer((-1.0, 1.0), steps[1])
    read, prior, zeros = c.pads(*places), c.before(at[0]), 0.0 * at[0]
    now = read[:, :, 0]
    for low, high, spread in ((1, 2, errors[0] / steps[0]), (3, 4, errors[1] / steps[1])):
        more = 0.5 * Z95 * spread * (read[0, :, high] - read[0, :, low])
        now, zeros = widened(now, more), zeros + (more[0] / Z95) ** 2
    unread = (now[2, 0] - now[1, 0]) / (prior[2, 0] - prior[1, 0])
    told = told & (unread < 1.0)
    now, zeros, unread = (np.where(told, *x) for x in ((now, prior), (zeros, 0.0), (unread, 1.0)))
    # the map has the ratio of the brake forces, about the pressures that the axles had on the ramp
    now[:, 0] += unread**2 * (log_odds - prior[0, 0] + c.ramp_ratio) - log_odds
    return now, zeros


def _keep(
    c: Constants, s: State, now: Array, zeros: Array, level: Array, which: tuple[Mask, Mask]
) -> tuple[Array, Array]:
    """The best informed ratio so far, as it is known at each block, of the shapes of `_ratio`.

    It ages as pads warm up, and those that changed did so unlike. Stops begin new, and a block is a
    reading where it adds to the means: ``which`` of the blocks are new, and add.
    """
    kept, aged = [], []
    rows = np.vstack([now.reshape(6, -1), zeros]).T.tolist()
    for row, a, new, adds in zip(rows, level.tolist(), *(x.tolist() for x in which), strict=True):
        variance = c.ageing**2 * s.age + (c.unlike * math.log(a / s.level_then)) ** 2
        more = Z95 * math.sqrt(variance)
        (middle, _, low, _, high, *_), (_, _, low_now, _, high_now, *_) = s.kept, row
        known = math.hypot(middle - low, more) + math.hypot(high - middle, more)
        if new or (adds and high_now - low_now <= known):
            s.kept, s.age, s.level_then, variance = row, 0.0, a, 0.0
        s.age += c.block
        kept.append(s.kept)
        aged.append(variance)
    out, more_variance = np.array(kept).T, np.array(aged)
    return widened(out[:6].reshape(3, 2, -1), Z95 * np.sqrt(more_variance)), out[6] + more_variance
