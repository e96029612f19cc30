r"""The estimator of the table: one step for each block of 50 ms, causal, with fixed memory.

    sample --follow--> what is seen: level, slip, means of z and eta - 1
           --answer--> level; the map: ln of the pads' ratio, given the slip; with 95 % bounds
            --keep---> the best informed ratio, which ages as pads that warm up do

What is recursive stands in `calib.estimation.state`; the rest is a function of the state, written
once for any number of blocks: those of a whole log, or one. `valid` says that the model holds, not
that the interval is narrow.
"""

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from calib.base.arrays import Array, Mask
from calib.base.intervals import Z95
from calib.estimation.constants import LEVEL, PADS, Constants
from calib.estimation.reasons import Reason
from calib.estimation.state import LEAST_Z, Numbers, Sample, Seen, State, follow, started


class Answer(NamedTuple):
    """Level and ratio, each ln with 95 % bounds; ``change`` of the ratio since the ramp.

    ``noise``, ``accelerometer`` variance of the level by sensors, ``zeros`` of the ratio by what is
    read. ``slip`` ln(slip/z) with its ``slip_sigma``; ``innovation`` how far the wheels were from
    the speed that was carried on, in standard deviations, NaN where they do not count. ``reason``
    a `Reason`.
    """

    level: float
    level_lower: float
    level_upper: float
    ratio: float
    ratio_lower: float
    ratio_upper: float
    change: float
    change_lower: float
    change_upper: float
    noise: float
    accelerometer: float
    zeros: float
    lag: float
    slip: float
    slip_sigma: float
    innovation: float
    reason: float


def step(c: Constants, s: State, x: Sample) -> Answer:
    """Take in a block, and answer. Changes the state."""
    return Answer(*_answers(c, s, [follow(c, s, x)])[0].tolist())


def run(c: Constants, samples: Iterable[Sample]) -> Array:
    """The answers (k, 17) of `step`, block by block from the start."""
    s = started(c)
    return _answers(c, s, [follow(c, s, x) for x in samples])


def _answers(c: Constants, s: State, blocks: Sequence[Numbers]) -> Array:
    """Answer each block (k, 17); where nothing new is told the last answer is held."""
    seen = Seen(*np.array(blocks).T)
    told = seen.told > 0.0
    rows = _told(c, s, Seen(*(x[told] for x in seen)))
    if s.held:
        rows = np.vstack([s.held, rows])
    out = rows[np.cumsum(told) - (0 if s.held else 1)]
    s.held = out[-1].tolist()
    reason, level = seen.reason, np.exp(out[:, 0])
    for why, holds in (
        (Reason.NO_PAD, (level > c.least_level) & (level < c.most_level)),
        (Reason.BEYOND_MAP, _on_map(c, *_means(seen))),
    ):
        reason = np.where((reason == Reason.VALID) & ~holds, why, reason)
    return np.column_stack([out, seen.innovation, reason])


def _means(seen: Seen) -> tuple[Array, Array]:
    """Demanded brake force over the weight and eta - 1, from the zeros, (n,)."""
    weight = np.maximum(seen.weight, 1.0)
    z = np.where(seen.weight > 0.0, np.maximum(seen.sum_z / weight, LEAST_Z), _USUAL_Z)
    return z, seen.sum_shift / weight


_LEAST = 0.02
"""Level, or share of the pressure that acts, below which there is none [1]."""


_USUAL_Z = 0.1
"""Deceleration at which the maps are read before any braking [1]."""


def _told(c: Constants, s: State, seen: Seen) -> Array:
    """Level, ratio and the rest of an `Answer` but the last two (n, 15)."""
    steady = np.maximum(seen.level, _LEAST)
    # friction as it is now, of the pressure as it is now
    a = steady * np.clip(seen.acts, _LEAST, 1.0 / _LEAST)
    z, shift = _means(seen)
    before = c.level(z)
    known, bounds = before[: len(LEVEL)], before[len(LEVEL) :]
    log_slip, sigma = c.ratio(z, shift / z, np.zeros_like(a))[len(PADS) :]
    # what the map says of the slip, and by it of the scale of a_x
    gain, rest = 1.0 / (seen.slip_variance + sigma**2), log_slip - seen.slip
    e = seen.scale + gain * seen.covariance * rest
    slip = seen.slip + gain * seen.slip_variance * rest
    slip_sigma = np.sqrt(gain * seen.slip_variance) * sigma
    noise = np.minimum(np.maximum(seen.level_variance, 0.0) / steady**2, 1.0)
    accelerometer = seen.demand_variance / z**2
    accelerometer = accelerometer + np.maximum(seen.scale_variance - gain * seen.covariance**2, 0.0)
    noisy = Z95 * np.sqrt(noise + accelerometer)
    level = np.log(a * np.maximum(1.0 - e, _LEAST)) + known[0]
    down, up = (np.hypot(known[0] - known[1], noisy), np.hypot(known[2] - known[0], noisy))
    now = _look(c, seen, ((slip - log_slip) / sigma, slip_sigma / sigma), bounds)
    ratio, below, above, change, change_below, change_above, zeros = _keep(c, s, now, a, seen.fresh)
    return np.column_stack([
        level, level - down, level + up,
        ratio, ratio - below, ratio + above,
        change, change - change_below, change + change_above,
        noise, accelerometer, zeros, seen.lag, slip, slip_sigma,
    ])  # fmt: skip


def _on_map(c: Constants, z: Array, shift: Array) -> Mask:
    """Whether a stop of the list shows such an eta (n,)."""
    at, axis = shift / z, c.ratio.axes[1]
    return np.asarray((axis[0] <= at) & (at <= axis[-1]))


def _around(read: Array) -> Array:
    """Medians of ratio and change, each with the distances to its bounds; no part by reading."""
    (ratio, lower, upper, change, low, high) = read
    none = np.zeros_like(ratio)
    return np.stack(
        [ratio, ratio - lower, upper - ratio, change, change - low, high - change, none]
    )


def _look(c: Constants, seen: Seen, slip: tuple[Array, Array], bounds: Array) -> Array:
    """ln of the ratio with the distances of its bounds, the same of its change, variance by zeros.

    Shape (7, n). ``slip`` and its sigma, along the axis of the map; ``bounds`` before eta is read.
    """
    (z, shift), weight, prior = _means(seen), np.maximum(seen.weight, 1.0), _around(bounds)
    at = shift / z
    noise = c.noise_omega * c.radius / np.maximum(seen.speed, 1.0) / np.sqrt(c.block * weight)
    # a mean over decelerations that differ is not the curve at their mean
    bent = shift * np.maximum(seen.sum_zz / weight / z**2 - 1.0, 0.0)
    sigma = np.sqrt(noise**2 + seen.eta_variance + bent**2) / z
    h, k, none = np.minimum(sigma, c.ratio.width(1, at)), np.minimum(slip[1], 1.0), 0.0 * at
    read = c.ratio(
        np.broadcast_to(z, (5, z.size)),
        at + np.stack([none, -h, h, none, none]),
        slip[0] + np.stack([none, none, none, -k, k]),
    )[: len(PADS)]
    out = _around(read[:, 0])
    for low, high, spread in ((1, 2, sigma / h), (3, 4, slip[1] / k)):
        for column in (0, 3):
            more = 0.5 * Z95 * spread * (read[column, high] - read[column, low])
            out[column + 1] = np.hypot(out[column + 1], more)
            out[column + 2] = np.hypot(out[column + 2], more)
            out[6] += (more / Z95) ** 2 * (column == 0)
    told = (seen.weight > 0.0) & (z >= c.least_z) & _on_map(c, z, shift)
    now = np.where(told & (out[1] + out[2] < prior[1] + prior[2]), out, prior)
    # the map has the ratio of the brake forces, about the pressures that the axles had on the ramp
    moved = seen.log_odds - (bounds[0] - c.ramp_ratio)
    now[0] += ((now[1] + now[2]) / (bounds[2] - bounds[1])) ** 2 * moved - seen.log_odds
    return now


def _keep(c: Constants, s: State, now: Array, level: Array, fresh: Array) -> Array:
    """The best informed ratio so far, as it is known at each block, (7, n) as ``now``.

    It ages as pads warm up, and those that changed did so unlike.
    """
    kept, variances = [], []
    for row, a, first in zip(now.T.tolist(), level.tolist(), fresh.tolist(), strict=True):
        a, better, variance = max(a, _LEAST), bool(first), 0.0
        if not first:
            variance = c.ageing**2 * s.age + (c.unlike * math.log(a / s.level_then)) ** 2
            more = Z95 * math.sqrt(variance)
            better = row[1] + row[2] <= math.hypot(s.kept[1], more) + math.hypot(s.kept[2], more)
        if better:
            s.kept, s.age, s.level_then, variance = row, 0.0, a, 0.0
        s.age += c.block
        kept.append(s.kept)
        variances.append(variance)
    out, aged = np.array(kept).reshape(-1, len(now)).T.copy(), np.array(variances)
    for column in (1, 2, 4, 5):
        out[column] = np.hypot(out[column], Z95 * np.sqrt(aged))
    out[6] += aged
    return out
