"""What speaks against a result although it is valid: the likely sensor or part, by name.

A warning has one shape everywhere: ``code``, ``log``, ``measured``, ``expected`` (low, high), the
likely ``causes``, the most likely first, and what to ``do``.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.estimation.estimator import Estimate
from calib.names import G
from calib.statistics.intervals import Z95

Array = NDArray[np.float64]

SCALE = 0.02
"""Scale error of a_x [1] from which it is named: data sheets allow 1 to 3 %."""

OFFSET = 0.05
"""Offset of a_x, or deceleration of the rolling car [m/s^2], that is not explained: 0.005 g."""

APART = 0.05
"""Change of the front pads over that of the rear ones [1] from which it is named."""


@dataclass(frozen=True)
class PlausibilityWarning:
    """One warning; ``measured`` in the unit that ``expected`` has, as the code says."""

    code: str
    log: str
    measured: float
    expected: tuple[float, float]
    causes: tuple[str, ...]
    do: str

    def __str__(self) -> str:
        low, high = self.expected
        return (
            f"{self.log}: {self.code} is {self.measured:.3g}, expected {low:g} to {high:g}; "
            f"likely {', or '.join(self.causes)}; {self.do}"
        )


def warnings_of(log: str, estimate: Estimate) -> tuple[PlausibilityWarning, ...]:
    """Warnings on one log, from what its whole run says."""
    rules = (_accelerometer, _pads)
    return tuple(warning for rule in rules for warning in rule(log, estimate))


def _accelerometer(log: str, e: Estimate) -> Iterator[PlausibilityWarning]:
    sensor = e.accelerometer
    c, sigma = float(sensor.scale[-1]), math.sqrt(float(sensor.variance_scale[-1]))
    if abs(c) > SCALE and abs(c) > Z95 * sigma:
        yield PlausibilityWarning(
            "a_x_scale",
            log,
            c / (1.0 - c),
            (-SCALE, SCALE),
            ("the scale of a_x", "body pitch that a_x feels", "the unit or the clock of v"),
            "it is taken out; calibrate a_x against v",
        )
    bias, sigma = G * float(sensor.bias[-1]), G * math.sqrt(float(sensor.variance_bias[-1]))
    if abs(bias) > OFFSET and abs(bias) > sigma:
        yield PlausibilityWarning(
            "a_x_offset",
            log,
            -bias,
            (-OFFSET, OFFSET),
            ("the zero or the mounting of a_x", "a car that drags or is driven while it rolls"),
            "it is taken out as far as it is known; zero a_x on level ground",
        )
    drag = G * float(sensor.drag[-1])
    if abs(drag) > OFFSET:
        yield PlausibilityWarning(
            "unexplained_drag",
            log,
            drag,
            (-OFFSET, OFFSET),
            ("an engine in gear or a motor that brakes", "wind", "a brake that drags"),
            "roll in neutral before the stop, or log T_drive",
        )


def _pads(log: str, e: Estimate) -> Iterator[PlausibilityWarning]:
    """Pads that changed unlike: what eta and slip cannot tell from tyres or a motor."""
    if not e.valid.any():
        return
    last = int(np.flatnonzero(e.valid)[-1])
    apart = math.log(float(e.front.change[last] / e.rear.change[last]))
    block = min(int(np.searchsorted(e.blocks.end, e.time[last])), e.blocks.end.size - 1)
    if abs(apart) > APART and abs(apart) > Z95 * float(e.split.change_sigma[block]):
        yield PlausibilityWarning(
            "pads_changed_apart",
            log,
            math.expm1(apart),
            (-APART, APART),
            (
                "the pads of one axle (wet, hot or new)",
                "the tyres of one axle, changed since the ramp",
                "a motor that brakes one axle",
                "a pressure that the rear brakes do not get",
            ),
            "drive a new ramp if tyres or brakes were changed; log wheel pressures and T_drive",
        )
