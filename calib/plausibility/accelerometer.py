"""What a run says against its accelerometer."""

import math
from collections.abc import Iterator

from calib.messages.warning import PlausibilityWarning
from calib.names import G
from calib.signals.accelerometer import Accelerometer
from calib.statistics.intervals import Z95

SCALE = 0.025
"""Scale error of a_x [1] from which it is named: data sheets allow 1 to 3 %."""

OFFSET = 0.05
"""Offset of a_x, or deceleration of the rolling car [m/s^2], that is not explained: 0.005 g."""

SLOPE, LIKELY = 0.01, 0.5
"""Disagreement by turns of a_x and v [g], and chance of a slope that changes [1], from which that
is named: on level roads they disagree by 0.007 g with usual sensors."""

LATE = 0.10
"""Delay of a_x against v [s] from which it is named: filters of sensors take 0.02 s."""


def accelerometer_warnings(log: str, sensor: Accelerometer) -> Iterator[PlausibilityWarning]:
    """Scale, slope, offset, drag and delay as known at the end of the run."""
    c, sigma = float(sensor.scale[-1]), math.sqrt(float(sensor.variance_scale[-1]))
    if abs(c) > SCALE and abs(c) > Z95 * sigma:
        yield PlausibilityWarning(
            "a_x_scale",
            log,
            c / (1.0 - c),
            (-SCALE, SCALE),
            (
                "the scale of a_x",
                "the unit or the clock of v",
                "body pitch that a_x feels",
            ),
            "fit and validate take it out; calibrate a_x against v",
        )
    apart = float(sensor.disagrees[-1])
    if float(sensor.wanders[-1]) > LIKELY and apart > SLOPE:
        yield PlausibilityWarning(
            "a_x_against_v",
            log,
            apart,
            (0.0, SLOPE),
            (
                "a slope that changes",
                "v that drifts, is smoothed or is computed from other channels",
                "a_x that drifts",
            ),
            "a_x is believed, which is right on a slope; brake on a road of one slope, and compare "
            "v with another source",
        )
    bias, sigma = G * float(sensor.bias[-1]), G * math.sqrt(float(sensor.variance_bias[-1]))
    if abs(bias) > OFFSET and abs(bias) > sigma:
        yield PlausibilityWarning(
            "a_x_offset",
            log,
            -bias,
            (-OFFSET, OFFSET),
            ("the zero or the mounting of a_x", "a car that drags or is driven while it rolls"),
            "fit and validate take out what is known of it; zero a_x on level ground",
        )
    drag = G * float(sensor.drag[-1])
    if abs(drag) > OFFSET:
        yield PlausibilityWarning(
            "unexplained_drag",
            log,
            drag,
            (-OFFSET, OFFSET),
            (
                "an engine in gear, a motor that brakes or a brake that drags",
                "the zero or the mounting of a_x",
                "wind",
            ),
            "roll in neutral before the stop, or log T_drive_f and T_drive_r, negative where they "
            "slow the car",
        )
    late, sigma = float(sensor.lag[-1]), math.sqrt(float(sensor.variance_lag[-1]))
    if abs(late) > LATE and abs(late) > 3.0 * sigma:
        yield PlausibilityWarning(
            "a_x_late",
            log,
            late,
            (-LATE, LATE),
            ("the clock or the filter of a_x", "the clock of v"),
            "record a_x, v and the wheel speeds on one clock",
        )
