"""An offset that each log has of its own: the slope of its road, or the zero of its accelerometer.

    road_grade           v falls by g s t more than the forces say, s sine of the slope, uphill
                         positive; a_x is specific force and does not move
    accelerometer_bias   a_x reads b more; v does not move

Each moves one channel along a course that is known beforehand, so no fit has to search for it: the
innovations are taken without what lies along the course, which is what the best offset of that log
leaves. What such an effect would do in all logs alike is left out with it.

Source: a_x = dv/dt + g s for a sensor on the car (Gillespie, Fundamentals of Vehicle Dynamics,
ch. 1). The slope is constant over a log.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.base.names import G
from calib.car.effects.effects import Effects
from calib.diagnosis.explanation.channels import (
    CHANNELS,
    DRIFT,
    ChannelNoise,
    thinned,
    whitened_channel,
)
from calib.diagnosis.explanation.predict import ObservedRun
from calib.logs.log import Log

Array = NDArray[np.float64]

GRADE, ZERO = "road_grade", "accelerometer_bias"
"""Effects that each log may have of its own."""

PARAMETERS = {GRADE: ("grade", "1"), ZERO: ("bias", "m/s^2")}
"""Name and unit of the offset."""


@dataclass(frozen=True)
class Course:
    """What a unit of the offset adds to the residuals of a run.

    ``channel`` its place in `CHANNELS`; ``raw`` (m,) in its unit, less the mean where the channel
    has an unknown start; ``white`` (k,) as an innovation.
    """

    channel: int
    raw: Array
    white: Array

    def removed(self, innovations: list[Array]) -> list[Array]:
        """The innovations of the run by channel without what lies along the course."""
        own = innovations[self.channel]
        rest = own - self.white * _along(self.white, own)
        return [rest if c == self.channel else x for c, x in enumerate(innovations)]

    def offset(self, residuals: Array) -> float:
        """The offset that leaves least of the residuals (6, m) of the run, none of them lasting."""
        return _along(self.raw, residuals[self.channel])


def _along(course: Array, x: Array) -> float:
    """The multiple of a course that is nearest to ``x``; zero where a run is too short to move."""
    square = float(course @ course)
    return float(course @ x) / square if square > 0.0 else 0.0


def course_of(effect: str, run: ObservedRun, noise: ChannelNoise) -> Course:
    """The course of an effect in a run."""
    time = thinned(run, run.time)
    if effect == GRADE:
        fallen = -G * (time - time[0])
        return Course(DRIFT, fallen - np.mean(fallen), whitened_channel(fallen, DRIFT, noise))
    channel = CHANNELS.index("a_x")
    more = np.ones_like(time)
    return Course(channel, more, whitened_channel(more, channel, noise))


def offset_between(effect: str, simulated: Log, measured: Log) -> float:
    """The offset that a replay needs more of to be nearest to its log, over their common samples.

    The speed at which a replay starts has an error of its own, and counts as unknown.
    """
    n = min(simulated.time.size, measured.time.size)
    if effect == ZERO:
        return float(np.mean(measured["a_x"][:n] - simulated["a_x"][:n]))
    fallen = -G * (measured.time[:n] - np.mean(measured.time[:n]))
    return _along(fallen, measured["v"][:n] - simulated["v"][:n])


def as_effects(effect: str, offset: float) -> Effects:
    """The offset of a log as an effect of the car while it is driven."""
    own = {PARAMETERS[effect][0]: offset}
    return Effects({effect: own | {"felt": 1.0} if effect == GRADE else own})
