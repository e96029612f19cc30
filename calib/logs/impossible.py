"""Impossible samples: zeros, and the largest value of a type, which a decoder wrote.

omega  97.1 97.0 327.7 327.7 96.9 96.8    no tyre turns a wheel so much faster, and back
omega  97.1 97.0   0.0  96.9  96.8        no brake stops a wheel for one sample
          kept  |  marked  |  kept        cut where a step is impossible; the longest part is true

Marked samples count as samples without a value: `calib.logs.gaps` bridges a few where the channel
is smooth, and more are refused. This comes before anything is zeroed or fitted.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from calib.base.arrays import Array
from calib.base.errors import LogError
from calib.base.intervals import white_noise
from calib.base.names import CHANNELS, WHEEL_SPEEDS
from calib.base.units import from_si
from calib.logs.clock import LATEST, is_ascending
from calib.logs.gaps import BRIDGE, ENDS, ChannelHole, fill_rows

Mask = NDArray[np.bool_]


class _Possible(NamedTuple):
    """Bounds of a channel in SI.

    ``up`` fastest rise per second, ``long`` that in steps over `_QUICK`; ``zero`` fastest change
    per second from or to exactly 0, ``nonzero`` a change from or to it that is always possible;
    ``end`` largest value; ``steps``: only parts that a bridge can span are marked.
    """

    up: float
    zero: float
    nonzero: float
    long: float
    end: float
    steps: bool = False


_POSSIBLE = {
    # a tyre spins a wheel up with 1.2 6 kN 0.32 m/0.9 kg m^2; a wheel that locks falls to 0 by
    # steps, and from below the least speed of its sensor
    **dict.fromkeys(WHEEL_SPEEDS, _Possible(2500.0, 1500.0, 20.0, 40.0, 400.0)),
    # v of a receiver is held, or found again after a bridge: only its zeros are known as wrong
    "v": _Possible(np.inf, 100.0, 6.0, 15.0, 120.0),
    # 1000 bar/s are the fastest brakes; a pedal that is let go falls to 0 by steps
    "p_mc": _Possible(np.inf, 2e8, 1e6, np.inf, 4e7, steps=True),
    # bumps move a_x by any step, and 5 g is past the range of car sensors
    "a_x": _Possible(np.inf, np.inf, np.inf, np.inf, 50.0),
}

_QUICK = 0.05
"""Time [s] over which a wheel spins up or stops; over a longer one it goes with the car."""
_NOISE = 10.0  # standard deviations of its noise that a channel may jump in addition [1]
_LEAST = 2.0  # least jump [SI] that counts: a lost pulse of a ring of 48 teeth is 2 rad/s
_FEW = 0.02  # largest share of samples that are marked [1]; with more the log is refused


@dataclass(frozen=True)
class Marked:
    """Impossible samples of ``channel``: how many, time [s] and value [SI] of the first."""

    channel: str
    count: int
    start: float
    value: float

    def __str__(self) -> str:
        quantity = CHANNELS[self.channel]
        value = from_si(self.value, quantity.unit, quantity.si)
        return f"{self.channel} reads {value:.4g} {quantity.unit} at {self.start:.3f} s"


def without_impossible(
    channels: Mapping[str, Array], where: str
) -> tuple[dict[str, Array], tuple[Marked, ...], tuple[ChannelHole, ...]]:
    """The channels with NaN, or a bridge, in the place of impossible samples.

    ``channels`` [SI], (n,) each, by name; they stay as they are where the times do not ascend.
    Returns the channels, the marked samples and the bridged gaps. Raises LogError if more than
    `_FEW` of a required channel are marked.
    """
    time, values = channels["time"], dict(channels)
    if not is_ascending(time):
        return values, (), ()
    masks = {
        name: _impossible(time, values[name], possible)
        for name, possible in _POSSIBLE.items()
        if name in values
    }
    if set(WHEEL_SPEEDS) <= masks.keys():  # a row of zeros is one of all its channels
        all_wheels = np.logical_and.reduce([masks[name] for name in WHEEL_SPEEDS])
        for name, mask in masks.items():
            mask |= all_wheels & (values[name] == 0.0)
    marked = []
    for name, mask in masks.items():
        if mask.any():
            first, count = int(np.argmax(mask)), int(np.count_nonzero(mask))
            marked.append(Marked(name, count, float(time[first]), float(values[name][first])))
            values[name] = np.where(mask, np.nan, values[name])
    filled, _, bridged = fill_rows({group.channel: values[group.channel] for group in marked}, time)
    within = (time > time[0] + ENDS) & (time < time[-1] - ENDS)  # ends may lack some
    for group in marked:
        many = np.count_nonzero(masks[group.channel] & within) > max(_FEW * time.size, 1.0)
        if many and CHANNELS[group.channel].required:
            raise LogError(
                f"{group}, beside values that are far away: no car drives {group.count} of the "
                f"{time.size} samples",
                where=f"{where}: {group.channel}",
                expected="values that a car can have one after the other",
                do="decode the error value of the signal as no value, or cut the log there",
            )
    return values | filled, tuple(marked), tuple(bridged)


def _impossible(time: Array, x: Array, possible: _Possible) -> Mask:
    mask = np.isfinite(x) & (np.abs(x) > possible.end)
    if np.count_nonzero(mask) > _FEW * x.size:  # a wrong unit, which `calib.run` reports
        return np.zeros(x.size, np.bool_)
    present = np.flatnonzero(np.isfinite(x) & ~mask)
    steps = np.diff(time[present])
    if present.size > 2:
        least = min(possible.nonzero, possible.up * float(np.min(steps)) + _LEAST)
        if np.max(np.abs(np.diff(x[present]))) > least:
            mask[present] = _apart(time[present], x[present], possible)
    return mask


def _apart(time: Array, x: Array, possible: _Possible) -> Mask:
    """Mask (n,) of the parts that no possible step joins with the longest one.

    A part that begins higher than the level before it can rise is impossible, and one of exact
    zeros after what cannot stop so fast. One that begins lower is kept: a wheel that slips, which
    slow messages show in one step.
    """
    slack = max(_LEAST, _NOISE * white_noise(x, 2)) if np.isfinite(possible.up) else 0.0
    change, zero = np.abs(np.diff(x)), x == 0.0
    up, to_zero = _fastest(np.diff(time), slack, possible)
    cuts = np.flatnonzero((change > up) | ((zero[1:] | zero[:-1]) & (change > to_zero))) + 1
    mask = np.zeros(x.size, np.bool_)
    if not cuts.size:
        return mask
    edges = np.concatenate([[0], cuts, [x.size]])
    longest = int(np.argmax(np.diff(edges)))
    for parts, later in ((range(longest + 1, edges.size - 1), 1), (range(longest - 1, -1, -1), 0)):
        last = int(edges[longest + later]) - later
        level = x[last]
        for part in parts:
            begin, end = edges[part], edges[part + 1]
            first, far = (begin, end - 1) if later else (end - 1, begin)
            up, to_zero = _fastest(np.abs(time[first] - time[last]), slack, possible)
            if (x[first] == 0.0 and level > to_zero) or x[first] > level + up:
                mask[begin:end] = True
                continue
            slowed = possible.long * abs(float(time[far] - time[last]))
            last, level = int(far), max(x[far], level - slowed)
    if possible.steps:  # only parts between two others that are short enough for a bridge
        short = np.zeros(x.size, np.bool_)
        for begin, end in pairwise(edges[1:-1]):
            short[begin:end] = time[end] - time[begin - 1] <= BRIDGE
        mask &= short
    return mask


def _fastest(step: Array, slack: float, possible: _Possible) -> tuple[Array, Array]:
    """Largest possible rise in ``step`` [s], and largest change from or to exactly 0."""
    quick = np.minimum(step, _QUICK)
    long = np.where(step > _QUICK, possible.long, 0.0) * step
    to_zero = np.maximum(possible.nonzero, possible.zero * quick)
    return possible.up * quick + slack + long, to_zero + long


_ABSURD = {"Pa": 1e9, "m/s^2": 1e4, "rad/s": 1e5, "m/s": 1e4, "rad": 1e4, "N*m": 1e7, "degC": 1e5}
"""By SI unit: far above every value of a car, also one in a wrong unit."""


def refuse_absurd(channels: Mapping[str, Array], where: str) -> None:
    """Raise LogError for a value so large that the file must be damaged; channels in SI by name."""
    for name, values in channels.items():
        si = CHANNELS[name].si if name in CHANNELS else ""
        most = _ABSURD.get(si, LATEST)
        absurd = np.flatnonzero(np.isfinite(values) & (np.abs(values) > most))
        if absurd.size:
            row = int(absurd[0])
            raise LogError(
                f"row {row + 1} holds {values[row]:.3g} {si or 'in SI'}",
                where=f"{where}: {name}",
                expected="a value that can be measured",
                do="the file is damaged or the unit is wrong: export it again",
            )
