"""What a run says against its accelerometer."""

import math
from collections.abc import Iterator

from calib.base.intervals import Z95
from calib.base.names import G
from calib.base.warning import PlausibilityWarning
from calib.plausibility.limits import PLAUSIBLE
from calib.run.accelerometer import Accelerometer

SLOPE, LIKELY = 0.01, 0.5
"""Disagreement by turns of a_x and v [g] from which a slope that changes is named: on level roads
they disagree by 0.007 g with usual sensors; and chance [1] from which it is."""

V_SCALE = "v_scale"


def accelerometer_warnings(log: str, sensor: Accelerometer) -> Iterator[PlausibilityWarning]:
    """Scale, slope, offset, drag and delay as known at the end of the run."""
    c, sigma = float(sensor.scale[-1]), math.sqrt(float(sensor.variance_scale[-1]))
    other = float(sensor.other_scale[-1])
    if other != 0.0:
        yield PlausibilityWarning(
            V_SCALE,
            log,
            other / (1.0 - other),
            (-PLAUSIBLE.a_x_scale, PLAUSIBLE.a_x_scale),
            (
                "the unit of v or of a_x",
                "v or a_x with a clock of its own, or a filter",
                "a scale of a_x that no sound sensor has",
            ),
            "compare v and a_x with another source, or leave v out of the log",
        )
    elif abs(c) > PLAUSIBLE.a_x_scale and abs(c) > Z95 * sigma:
        yield PlausibilityWarning(
            "a_x_scale",
            log,
            c / (1.0 - c),
            (-PLAUSIBLE.a_x_scale, PLAUSIBLE.a_x_scale),
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
    if abs(bias) > PLAUSIBLE.a_x_offset and abs(bias) > sigma:
        yield PlausibilityWarning(
            "a_x_offset",
            log,
            -bias,
            (-PLAUSIBLE.a_x_offset, PLAUSIBLE.a_x_offset),
            ("the zero or the mounting of a_x", "a car that drags or is driven while it rolls"),
            "fit and validate take out what is known of it; zero a_x on level ground",
        )
    drag = G * float(sensor.drag[-1])
    if abs(drag) > PLAUSIBLE.a_x_offset:
        yield PlausibilityWarning(
            "unexplained_drag",
            log,
            drag,
            (-PLAUSIBLE.a_x_offset, PLAUSIBLE.a_x_offset),
            (
                "an engine in gear, a motor that brakes or a brake that drags",
                "the zero or the mounting of a_x",
                "wind",
            ),
            "roll in neutral before the stop, or log T_drive_f and T_drive_r, negative where they "
            "slow the car",
        )
    late, sigma = float(sensor.lag[-1]), math.sqrt(float(sensor.variance_lag[-1]))
    if abs(late) > PLAUSIBLE.a_x_late and abs(late) > 3.0 * sigma:
        yield PlausibilityWarning(
            "a_x_late",
            log,
            late,
            (-PLAUSIBLE.a_x_late, PLAUSIBLE.a_x_late),
            ("the clock or the filter of a_x", "the clock of v"),
            "record a_x, v and the wheel speeds on one clock",
        )
