r"""The estimator of the table: one step for each block of 50 ms, causal, with fixed memory.

    block --filters--> state: level, slip, means of z and eta - 1
          --maps-----> level, and ln of the pads' ratio by eta and slip, with 95 % bounds
          --hold-----> the ratio with the narrowest bounds so far, whose variance grows with age

`follow` runs the filters on one block; most of their equations are in `calib.estimation.equations`.
`_answers` reads the maps and holds the ratio, for one block or for all blocks of a log. `step` does
both for one block, `run` for a whole log. (S1) to (S16) are on `calib/manual/step.md`.
"""

import math
from itertools import chain
from typing import NamedTuple

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.base.intervals import Z95
from calib.base.names import G
from calib.estimation import equations as eq
from calib.estimation.constants import Constants
from calib.estimation.state import Sample, State


class Answer(NamedTuple):
    """Answer to each of k blocks: medians with their 95 % bounds (3, k), then numbers (k,)."""

    level: Array  # ln of the pads' level, (3, k)
    ratio: Array  # ln of the ratio of the pads over that of the file's pads, (3, k)
    change: Array  # change of `ratio` since the ramp, (3, k)
    noise: Array  # variance of `level` by noise
    accelerometer: Array  # variance of `level` by a_x
    zeros: Array  # variance of `ratio` by errors of eta and slip, and by age
    slip: Array  # ln(slip/z)
    slip_sigma: Array  # standard deviation of `slip`
    zero_eta: Array  # eta while nothing brakes [1]
    zero_slip: Array  # slip of all wheels while nothing brakes [1]
    diagnosis: Array  # bits of `calib.estimation.reasons.CHECKS` that fail
    innovation: Array  # of the wheels, in standard deviations; NaN where they do not count
    reason: Array  # a `Reason`

    def take(self, places: int | Index) -> "Answer":
        """Return the answers at the blocks ``places``."""
        return Answer(*(np.take(x, places, axis=-1) for x in self))


def started(c: Constants) -> State:
    """Return the state before the first block."""
    s = State()
    eq.start(c, s)
    s.zero_slip.variance = c.var_zero
    return s


def follow(c: Constants, s: State, x: Sample[float]) -> eq.BlockState[float]:
    """Update the state by a block, and return the estimate of brakes and tyres."""
    eq.brake_line_lag(c, s, x.nominal)
    counts = x.rim > c.moving and not x.disturbed
    counts = eq.motor_fits(c, s, x, counts=counts) and counts
    _learn_zeros(c, s, x, counts=counts)
    eq.step_filters(c, s, x, counts=counts)
    if counts and not math.isnan(x.v):
        _update_speed(c, s, x)
    return eq.block_state(s, counts=counts)


def _learn_zeros(c: Constants, s: State, x: Sample[float], *, counts: bool) -> None:
    """Update the zeros by a rolling block if no brake bites for `Constants.before_bite`, (S3)."""
    eq.widen_zeros(c, s)
    s.zero_slip.variance = min(s.zero_slip.variance + c.walk_radius, c.var_zero)
    if x.pressure <= c.bite and len(s.waiting) >= round(c.before_bite / c.block):
        old = s.waiting.popleft()
        eq.take_zeros(c, s, old.demand, old.eta_less_1, old.rim)
        if old.v > c.moving:
            slip = 1.0 - eq.rim_speed(s, old) / old.v
            variance = c.var_rim / old.rim**2 + (c.noise_v / old.v) ** 2 / c.block
            eq.update_zero(s.zero_slip, slip, variance)
    if eq.rolls(c, s, x, counts=counts) and not x.driven:
        s.waiting.append(x)
    else:
        s.waiting.clear()


def _update_speed(c: Constants, s: State, x: Sample[float]) -> None:
    """Update the speed by v of a block, corrected for the delay of v and the zero of the slip."""
    predicted = s.rim + s.speed.v
    variance = (c.noise_v**2 + 1e-8) / c.block + predicted**2 * s.zero_slip.variance
    variance += (G * x.z * c.late_sigma) ** 2
    v = (x.v - G * x.z * c.late) * (1.0 - s.zero_slip.value)
    eq.update(c, s, 1.0, 0.0, v - predicted, variance, -s.check.v)


def step(c: Constants, s: State, x: Sample[float]) -> Answer:
    """Update the state by a block, and return the answer."""
    state = eq.BlockState(*np.array([follow(c, s, x)]).T)  # each field an array (1,)
    return _answers(c, s, Sample(*np.array([x]).T), state).take(0)


def run(c: Constants, x: Sample[Array]) -> Answer:
    """Return the answers of `step` to all blocks of a log (k,)."""
    s = started(c)
    rows = zip(*(column.tolist() for column in x), strict=True)
    states = chain.from_iterable(follow(c, s, Sample(*row)) for row in rows)
    of_blocks = np.fromiter(states, np.float64).reshape(-1, len(eq.BlockState._fields))
    return _answers(c, s, x, eq.BlockState(*of_blocks.T))


def _answers(c: Constants, s: State, x: Sample[Array], state: eq.BlockState[Array]) -> Answer:
    """Answer each block (k,) by its ``state`` after `follow`."""
    no_means = state.blocks == 0.0  # no brake has bitten since the last stop
    z = np.where(no_means, c.usual_z, state.z)
    shift = state.eta_rise / z  # (eta - 1)/z, the second axis of the maps
    log_slip, sigma = c.slip(z, shift, 0.0 * z)
    w = eq.slip_evidence(c, state, z, log_slip, sigma)
    more = Z95 * np.sqrt(w.noise + w.accelerometer)  # half width by filter and a_x
    level = widened(c.level(z), more) + np.log(w.pads * w.scaled)  # (S13)

    shifts = c.pads.axes[1]
    of_map = (shift >= shifts[0]) & (shift <= shifts[-1])
    readable = of_map & ~no_means & (z >= c.least_z)
    errors = eq.eta_error(c, state, z) / z, w.slip_sigma
    read, variance = _ratio(c, (z, shift, w.slip), errors, x.log_odds, readable)
    counts = state.counts > 0.0
    flags = no_means, counts & (x.pressure > c.bite)
    ratios, variance = _hold(c, s, read, variance, w.pads, flags)
    return Answer(
        level, ratios[:, 0], ratios[:, 1], w.noise, w.accelerometer, variance,
        log_slip + sigma * w.slip, sigma * w.slip_sigma, state.zero_eta, state.zero_slip,
        state.checks, np.where(counts, state.innovation, np.nan),
        eq.reason_of(c, x, state, np.exp(level[0]), of_map),
    )  # fmt: skip


def widened(x: Array, more: Array) -> Array:
    """Return a median and its bounds (3, ...), with distances d widened to hypot(d, more).

    ``more`` is one distance for both bounds (...), or (3, ...) of which the first is not used.
    """
    away = np.hypot(x - x[0], more)
    return np.stack([x[0], x[0] - away[1], x[0] + away[2]])


def _ratio(
    c: Constants,
    point: tuple[Array, ...],
    errors: tuple[Array, Array],
    log_odds: Array,
    readable: Mask,
) -> tuple[Array, Array]:
    """Return ln of ratio and change with bounds (3, 2, k), and the variance by ``errors`` (k,).

    ``point`` is the place on the axes z, (eta - 1)/z and slip of the map, (k,) each; ``errors`` are
    those of the last two. The more the map narrows the prior, the more the map counts, (S11). Where
    eta is not ``readable``, the prior counts alone.
    """
    # read the map at the point, and a step to either side on the axes of (eta - 1)/z and slip
    steps = np.minimum(errors[0], c.pads.width(1, point[1])), np.minimum(errors[1], 1.0)
    places = np.repeat(np.stack(point)[:, None], 5, axis=1)  # (axis, place, block)
    places[1, 1:3] += np.stack([-steps[0], steps[0]])
    places[2, 3:5] += np.stack([-steps[1], steps[1]])
    read = c.pads(*places)  # (3, 2, place, block)
    prior, variance = c.prior(point[0]), 0.0 * point[0]
    ratios = read[:, :, 0]
    # an error widens the bounds by the slope of the map along its axis
    for axis, (low, high) in enumerate(((1, 2), (3, 4))):  # places below and above the point
        steps_of_error = errors[axis] / steps[axis]
        more = 0.5 * Z95 * steps_of_error * (read[0, :, high] - read[0, :, low])
        ratios, variance = widened(ratios, more), variance + (more[0] / Z95) ** 2
    narrowed = (ratios[2, 0] - ratios[1, 0]) / (prior[2, 0] - prior[1, 0])  # width over the prior's
    widths = zip(narrowed.tolist(), readable.tolist(), strict=True)
    share = np.array([eq.share_of(c, width, 1.0) if reads else 0.0 for width, reads in widths])
    ratios, variance = prior + share * (ratios - prior), share * variance
    width_left = 1.0 + share * (narrowed - 1.0)  # over the prior's
    # The map has the ratio of the brake forces; less log_odds it is that of the pads. As far as its
    # variance is still that of the prior, it is drawn to the pads of the ramp.
    ratios[:, 0] += width_left**2 * (log_odds - prior[0, 0] + c.ramp_ratio) - log_odds
    return ratios, variance


_MEDIAN, _LOWER, _UPPER = 0, 2, 4  # places of the ratio in `State.held_ratio`


def _hold(
    c: Constants, s: State, read: Array, variance: Array, levels: Array, flags: tuple[Mask, Mask]
) -> tuple[Array, Array]:
    """Return the held ratio and its variance at each block, shaped as ``read`` and ``variance``.

    These are results of `_ratio`, and ``levels`` are those of the pads (k,). ``flags`` are two
    masks (k,): blocks between stops, which reset the held ratio to the reading, and blocks whose
    reading counts. A reading narrower than the held ratio moves the held ratio, (S12).
    """
    held_ratios, added_variances = [], []
    readings = np.vstack([read.reshape(6, -1), variance]).T.tolist()  # as `State.held_ratio`
    resets, counts = (x.tolist() for x in flags)
    for reading, level, reset, count in zip(readings, levels.tolist(), resets, counts, strict=True):
        s.age += c.block
        if reset:
            s.held_ratio, added_variance = reading, eq.reset_held(c, s, level, 1.0)
        else:
            added_variance = eq.held_variance(c, s, level)
        if count and not reset:
            ratio, more = s.held_ratio[_MEDIAN], Z95 * math.sqrt(added_variance)
            below = math.hypot(ratio - s.held_ratio[_LOWER], more)
            above = math.hypot(s.held_ratio[_UPPER] - ratio, more)
            share = eq.share_of(c, reading[_UPPER] - reading[_LOWER], below + above)
            if share > 0.0:
                pairs = zip(s.held_ratio, reading, strict=True)
                s.held_ratio = [(1.0 - share) * x + share * y for x, y in pairs]
                added_variance = eq.reset_held(c, s, level, share)
        held_ratios.append(s.held_ratio)
        added_variances.append(added_variance)
    ratios, added = np.array(held_ratios).T, np.array(added_variances)
    return widened(ratios[:6].reshape(3, 2, -1), Z95 * np.sqrt(added)), ratios[6] + added
