"""Whether what is left swings with a frequency of its own, as a mass on a spring does.

Liquid in a tank, a load that is not lashed or a body on its springs swings after every application,
whatever pressure and speed are: no empirical term can follow that. Its power is in one narrow band.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.explanation.channels import CHANNELS, STEP

Array = NDArray[np.float64]

WINDOW = round(4.0 / STEP)
"""Innovations in a window: 4 s, so two lines of a spectrum are 0.25 Hz apart."""

SLOWEST = 2
"""First line, 0.5 Hz: an error that lasts for a whole stop is slower."""

FASTEST = 20
"""Last line, 5 Hz: a body on its springs swings at 1 to 2 Hz, a load or a liquid hardly faster.
What is faster is a wheel, or a channel that is sent seldom."""

_OVER_SLOWER = 2.0
"""Least power of a peak over that of the slower lines beside which it stands."""

_OVER_SLOWEST = 3.0
"""Least power of a peak over that of the first line, at 0.25 Hz. What every application leaves, as
a lag does, is in both; a swing of 0.5 Hz or more has at most a fifth there."""

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


def oscillation_of(whitened: list[list[Array]], excess: float) -> Oscillation:
    """The strongest line of ``whitened`` innovations, with its two neighbours.

    They are given by run, then by channel in the order of `CHANNELS`, each (n,), one every `STEP`;
    ``excess`` is what their sum of squares has beyond noise.
    """
    power = _power(whitened)
    lines = np.sum(power, axis=0)
    peak = SLOWEST + int(np.argmax(lines[SLOWEST : FASTEST + 1]))
    slower = _OVER_SLOWER * np.max(lines[: peak - 1]), _OVER_SLOWEST * lines[SLOWEST - 1]
    if lines[peak] <= max(slower):
        return Oscillation(0.0, 0.0, body=False)
    near = slice(peak - 1, peak + 2)
    band = np.maximum(power[:, near], 0.0)
    whole = float(np.sum(band))
    frequencies = np.fft.rfftfreq(WINDOW, STEP)[near]
    by_body = float(np.sum(band[[CHANNELS.index(name) for name in _OF_BODY]]))
    return Oscillation(
        frequency=float(np.sum(band @ frequencies)) / whole,
        share=min(whole / excess, 1.0),
        body=by_body > 0.5 * whole,
    )


def _power(whitened: list[list[Array]]) -> Array:
    """Power of the innovations by channel and line (6, `WINDOW` / 2 + 1), less that of noise."""
    power = np.zeros((len(CHANNELS), WINDOW // 2 + 1))
    for run in whitened:
        for channel, x in enumerate(run):
            parts = x[: x.size // WINDOW * WINDOW].reshape(-1, WINDOW)
            # noise alone gives two per line: cosine and sine
            lines = 2.0 * np.abs(np.fft.rfft(parts, axis=1)) ** 2 / WINDOW - 2.0
            power[channel] += np.sum(lines, axis=0)
    return power
