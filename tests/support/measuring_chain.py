"""What a bus makes of the signals of a car: messages that are seldom, late and coarse.

    chained(log, Message(rate=20.0, late=0.03, step=0.01) by channel, rng)

A message is sent at its own rate, from a random time on, with the value of some time ago; a logger
repeats it until the next one comes.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.signal import butter, sosfilt, sosfilt_zi

from calib.logs.log import Log


@dataclass(frozen=True)
class Message:
    """``rate`` [Hz] of a message, ``late`` by [s], ``step`` of its values [unit of the channel].

    ``corner`` frequency [Hz] of a Butterworth filter of second order before it; 0 without one.
    """

    rate: float
    late: float = 0.0
    step: float = 0.0
    corner: float = 0.0


def chained(log: Log, messages: Mapping[str, Message], rng: np.random.Generator) -> Log:
    """The log as it is recorded from a bus; wheel speeds are in one frame, given as ``omega``."""
    channels = dict(log.channels)
    for name, message in messages.items():
        begin = rng.uniform(0.0, 1.0 / message.rate)
        for channel in [c for c in log.channels if c == name or c.startswith(f"{name}_")]:
            channels[channel] = _sent(log.time, log[channel], message, begin)
    return replace(log, channels=channels)


def _sent(time: np.ndarray, x: np.ndarray, message: Message, begin: float) -> np.ndarray:
    if message.corner:
        low = butter(2, message.corner, fs=1.0 / (time[1] - time[0]), output="sos")
        x = sosfilt(low, x, zi=sosfilt_zi(low) * x[0])[0]
    sent = np.floor((time - time[0] - begin) * message.rate) / message.rate + begin + time[0]
    values = np.interp(sent - message.late, time, x)
    return np.round(values / message.step) * message.step if message.step else values
