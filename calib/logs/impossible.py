"""Mark impossible samples: a decoder writes zeros or the largest value of a type for "no value".

omega  97.1 97.0 327.7 327.7 96.9 96.8    no tyre can make a wheel turn so much faster
omega  97.1 97.0   0.0   0.0 96.9 96.8    no brake can stop a wheel for two samples
          kept  |  marked  |  kept

A channel is cut into parts where the step between two samples is impossible. The longest part is
taken as true. From there each later part, then each earlier part, is kept or marked.

Marked samples become NaN. `calib.logs.gaps` bridges a few of them where the channel is smooth; a
log with more of them is refused.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.base.errors import LogError
from calib.base.intervals import white_noise
from calib.base.names import CHANNELS, WHEEL_SPEEDS
from calib.base.units import from_si
from calib.logs.clock import LATEST, is_ascending
from calib.logs.gaps import BRIDGE, ENDS, ChannelHole, fill_rows


class _Possible(NamedTuple):
    """Possible values and changes of a channel, used by `_largest_changes`; the unit is SI."""

    rise: float  # fastest rise [unit/s], in up to `_QUICK`
    to_zero: float  # fastest change from or to exactly 0 [unit/s], in up to `_QUICK`
    zero_jump: float  # change from or to 0 [unit] that is possible in any step
    slow_rate: float  # fastest change of the car [unit/s], added in steps longer than `_QUICK`
    largest: float  # largest value [unit]
    may_stay: bool = False  # whether a part too long for a bridge of `calib.logs.gaps` is kept


_POSSIBLE = {
    # columns: rise, to_zero, zero_jump, slow_rate, largest
    # A tyre turns a wheel faster with at most mu F_z r/J = 1.2 * 6 kN * 0.32 m/0.9 kg m^2. A wheel
    # that locks falls to 0 in steps; its sensor shows 0 below a least speed, up to 20 rad/s.
    **dict.fromkeys(WHEEL_SPEEDS, _Possible(2500.0, 1500.0, 20.0, 40.0, 400.0)),
    # a satellite speed stands still in a tunnel, then jumps: only its zeros can be judged
    "v": _Possible(np.inf, 100.0, 6.0, 15.0, 120.0),
    # Only the zeros of a pressure are judged: it may change from or to 0 by 10 bar in any step, and
    # by twice the 1000 bar/s of the fastest brakes. After the pedal is let go it stays at 0.
    "p_mc": _Possible(np.inf, 2e8, 1e6, np.inf, 4e7, may_stay=True),
    # a bump changes a_x by any step; sensors of cars end below 5 g
    "a_x": _Possible(np.inf, np.inf, np.inf, np.inf, 50.0),
}

_QUICK = 0.05  # longest step [s] in which a wheel changes its speed, and the car does not
_NOISE_SIGMAS = 10.0  # a rise by this many standard deviations of the noise is possible [1]
_JUMP = 2.0  # a rise by this [rad/s] is possible: at 97 rad/s, one lost pulse of 48 in a turn
FEW = 0.02  # largest share of impossible samples [1]; a log with more of them is refused


@dataclass(frozen=True)
class Marked:
    """The impossible samples of a channel."""

    channel: str
    count: int
    start: float  # time of the first sample [s]
    value: float  # value of the first sample [SI]

    def __str__(self) -> str:
        quantity = CHANNELS[self.channel]
        value = from_si(self.value, quantity.unit, quantity.si)
        return f"{self.channel} reads {value:.4g} {quantity.unit} at {self.start:.3f} s"


def without_impossible(
    channels: Mapping[str, Array], where: str
) -> tuple[dict[str, Array], tuple[Marked, ...], tuple[ChannelHole, ...]]:
    """Replace impossible samples by NaN, or by a bridge where `calib.logs.gaps` allows one.

    Return the channels, the marked samples and the bridged gaps. ``channels`` [SI] (n,) stay as
    they are if the times do not ascend. Raises LogError if of a required channel more than one
    sample, and more than `FEW` of all, are marked, apart from those in the first and last `ENDS`.
    """
    time, values = channels["time"], dict(channels)
    if not is_ascending(time):
        return values, (), ()
    masks = {
        name: _impossible(time, values[name], possible)
        for name, possible in _POSSIBLE.items()
        if name in values
    }
    if all(name in masks for name in WHEEL_SPEEDS):
        # rows without any true wheel speed hold no message: the zeros of other channels go, too
        is_lost = np.logical_and.reduce([masks[name] for name in WHEEL_SPEEDS])
        masks = {name: mask | (is_lost & (values[name] == 0.0)) for name, mask in masks.items()}
    marked = []
    for name, mask in masks.items():
        if mask.any():
            first, count = int(np.argmax(mask)), int(np.count_nonzero(mask))
            marked.append(Marked(name, count, float(time[first]), float(values[name][first])))
            values[name] = np.where(mask, np.nan, values[name])
    filled, _, bridged = fill_rows({m.channel: values[m.channel] for m in marked}, time)
    inner = (time > time[0] + ENDS) & (time < time[-1] - ENDS)  # the ends may lack values
    for m in marked:
        are_many = np.count_nonzero(masks[m.channel] & inner) > max(FEW * time.size, 1.0)
        if are_many and CHANNELS[m.channel].required:
            samples = f"{m.count} of the {time.size} samples"
            flaw = f"{m}: {samples} are too large, or too far from their neighbours for any car"
            expected = "values that a car can have one after the other"
            do = "decode the error value of the signal as no value, or cut the log there"
            raise LogError(flaw, where=f"{where}: {m.channel}", expected=expected, do=do)
    return values | filled, tuple(marked), tuple(bridged)


def _impossible(time: Array, x: Array, possible: _Possible) -> Mask:
    """Mask (n,) of the values that are too large or `_unreachable`."""
    mask = np.isfinite(x) & (np.abs(x) > possible.largest)
    if np.count_nonzero(mask) > FEW * x.size:  # a wrong unit, which `calib.run` reports
        return np.zeros(x.size, np.bool_)
    present = np.flatnonzero(np.isfinite(x) & ~mask)
    if present.size > 2:
        mask[present] = _unreachable(time[present], x[present], possible)
    return mask


def _unreachable(time: Array, x: Array, possible: _Possible) -> Mask:
    """Mask (n,) of the parts of ``x`` (n,) that cannot be reached from the longest part."""
    tolerance = 0.0
    if np.isfinite(possible.rise):
        tolerance = max(_JUMP, _NOISE_SIGMAS * white_noise(x, 2))
    change, is_zero = np.abs(np.diff(x)), x == 0.0
    rise, to_zero = _largest_changes(np.diff(time), tolerance, possible)
    touches_zero = is_zero[1:] | is_zero[:-1]
    cuts = np.flatnonzero((change > rise) | (touches_zero & (change > to_zero))) + 1
    mask = np.zeros(x.size, np.bool_)
    if not cuts.size:
        return mask
    edges = np.concatenate([[0], cuts, [x.size]])  # part i holds the samples edges[i]:edges[i + 1]
    longest = int(np.argmax(np.diff(edges)))
    _mark_later(mask, time, x, edges[longest + 1 :], tolerance, possible)
    # earlier parts are judged in the same way, backwards in time: sample i becomes x.size - 1 - i
    backward_edges = x.size - edges[: longest + 1][::-1]
    _mark_later(mask[::-1], -time[::-1], x[::-1], backward_edges, tolerance, possible)
    if possible.may_stay:
        is_short = np.zeros(x.size, np.bool_)
        for begin, end in pairwise(edges[1:-1]):
            is_short[begin:end] = time[end] - time[begin - 1] <= BRIDGE
        mask &= is_short
    return mask


def _mark_later(
    mask: Mask, time: Array, x: Array, edges: Index, tolerance: float, possible: _Possible
) -> None:
    """Set ``mask`` (n,) in the impossible parts after the longest part, which ends at ``edges[0]``.

    A part is impossible if it begins at or below zero and the channel cannot fall so fast, or if it
    begins higher than the channel can rise. A part that is merely lower is kept: if messages are
    rare, a wheel begins to slip between two of them.
    """
    last = int(edges[0]) - 1  # last sample of the parts that were kept
    level = x[last]  # value to which a wheel that slips may return: the speed of the car
    for begin, end in pairwise(edges.tolist()):
        rise, to_zero = _largest_changes(time[begin] - time[last], tolerance, possible)
        if (x[begin] <= 0.0 and level > to_zero) or x[begin] > level + rise:
            mask[begin:end] = True
        else:  # a slipping wheel reads low, so the level falls no faster than the car can slow
            slowed = possible.slow_rate * float(time[end - 1] - time[last])
            last, level = end - 1, max(x[end - 1], level - slowed)


def _largest_changes(step: Array, tolerance: float, possible: _Possible) -> tuple[Array, Array]:
    """Largest possible rise in each ``step`` [s] (n,), and largest change from or to exactly 0."""
    quick = np.minimum(step, _QUICK)
    slow_change = np.where(step > _QUICK, possible.slow_rate, 0.0) * step
    to_zero = np.maximum(possible.zero_jump, possible.to_zero * quick)
    return possible.rise * quick + tolerance + slow_change, to_zero + slow_change


_ABSURD = {"Pa": 1e9, "m/s^2": 1e4, "rad/s": 1e5, "m/s": 1e4, "rad": 1e4, "N*m": 1e7, "degC": 1e5}
"""Values far above every value of a car, even in a wrong unit, by SI unit; or else `LATEST`."""


def refuse_absurd(channels: Mapping[str, Array], where: str) -> None:
    """Raise LogError for a value of ``channels`` [SI] so large that the file must be damaged."""
    for name, values in channels.items():
        si = CHANNELS[name].si if name in CHANNELS else ""
        largest = _ABSURD.get(si, LATEST)
        absurd = np.flatnonzero(np.isfinite(values) & (np.abs(values) > largest))
        if absurd.size:
            row = int(absurd[0])
            flaw = f"row {row + 1} holds {values[row]:.3g} {si or 'in SI'}"
            expected = "a value that can be measured"
            do = "the file is damaged or the unit is wrong: export it again"
            raise LogError(flaw, where=f"{where}: {name}", expected=expected, do=do)
