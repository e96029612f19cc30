"""Whether what is left swings with a frequency of its own, as a mass on a spring does.

Liquid in a tank, a load that is not lashed or a body on its springs swings after every application,
whatever pressure and speed are: no empirical term can follow that. Its power is in one narrow band.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array
from calib.diagnosis.explanation.channels import CHANNELS, STEP

WINDOW = round(4.0 / STEP)
"""Innovations in a window: 4 s, so two lines of a spectrum are 0.25 Hz apart."""

SLOWEST = 2
"""First line, 0.5 Hz: an error that lasts for a whole stop is slower."""

FASTEST = 20
"""Last line, 5 Hz: a body on its springs swings at 1 to 2 Hz, a load or a liquid hardly faster.
What is faster is a wheel, or a channel that is sent seldom."""

_OVER = 3.0
"""Least power of a peak over that of the slower lines. What every application leaves, as a lag
does, is in all of them; a swing of 0.5 Hz or more has at most a fifth at 0.25 Hz."""

_OF_BODY = ("a_x", "v")
"""Channels in which the motion of the car as a whole shows."""


@dataclass(frozen=True)
class Oscillation:
    """The strongest line of what is left.

    ``share`` of the excess [1] that swings at ``frequency`` [Hz], 0 where no line stands out;
    ``body`` whether most of it is in a_x and v, so that the car as a whole swings.
    """

    frequency: float
    share: float
    body: bool


def oscillation_of(whitened: Sequence[Mapping[str, Array]], excess: float) -> Oscillation:
    """The strongest line of ``whitened`` innovations, with its two neighbours.

    They are given by run, then by the name of the channel, each (n,), one every `STEP`; ``excess``
    is what their sum of squares has beyond noise.
    """
    frequencies = np.arange(FASTEST + 2) / (WINDOW * STEP)
    phase = 2.0 * np.pi * np.outer(frequencies, STEP * np.arange(WINDOW))
    power = np.zeros((len(CHANNELS), frequencies.size))
    for run in whitened:
        for i, channel in enumerate(CHANNELS):
            x = run[channel]
            windows = x[: x.size // WINDOW * WINDOW].reshape(-1, WINDOW)
            power[i] += np.sum(power_of(windows, phase), axis=0)
    lines = np.sum(power, axis=0)
    peak = SLOWEST + int(np.argmax(lines[SLOWEST:-1]))
    if lines[peak] <= _OVER * np.max(lines[: max(peak - 1, SLOWEST)]):
        return Oscillation(0.0, 0.0, body=False)
    near = slice(peak - 1, peak + 2)
    band = np.maximum(power[:, near], 0.0)
    whole = float(np.sum(band))
    by_body = float(np.sum(band[[CHANNELS.index(name) for name in _OF_BODY]]))
    return Oscillation(
        frequency=float(np.sum(band @ frequencies[near])) / whole,
        share=min(whole / excess, 1.0),
        body=by_body > 0.5 * whole,
    )


def power_of(x: Array, phase: Array) -> Array:
    """Squares (..., k) that waves of a ``phase`` (k, n) [rad] take of innovations (..., n).

    Less those of noise alone, two a wave: cosine and sine.
    """
    return np.asarray(2.0 * np.abs(x @ np.exp(1j * phase).T) ** 2 / x.shape[-1] - 2.0)
