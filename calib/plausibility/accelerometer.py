"""What a run says against its accelerometer."""

import math
from collections.abc import Iterator

from calib.base.intervals import Z95
from calib.base.names import G
from calib.base.warning import PlausibilityWarning, warning
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
        yield warning(
            V_SCALE, log, other / (1.0 - other), (-PLAUSIBLE.a_x_scale, PLAUSIBLE.a_x_scale)
        )
    elif abs(c) > PLAUSIBLE.a_x_scale and abs(c) > Z95 * sigma:
        yield warning("a_x_scale", log, c / (1.0 - c), (-PLAUSIBLE.a_x_scale, PLAUSIBLE.a_x_scale))
    apart = float(sensor.disagrees[-1])
    if float(sensor.wanders[-1]) > LIKELY and apart > SLOPE:
        yield warning("a_x_against_v", log, apart, (0.0, SLOPE))
    bias, sigma = G * float(sensor.bias[-1]), G * math.sqrt(float(sensor.variance_bias[-1]))
    if abs(bias) > PLAUSIBLE.a_x_offset and abs(bias) > sigma:
        yield warning("a_x_offset", log, -bias, (-PLAUSIBLE.a_x_offset, PLAUSIBLE.a_x_offset))
    drag = G * float(sensor.drag[-1])
    if abs(drag) > PLAUSIBLE.a_x_offset:
        yield warning("unexplained_drag", log, drag, (-PLAUSIBLE.a_x_offset, PLAUSIBLE.a_x_offset))
    late, sigma = float(sensor.lag[-1]), math.sqrt(float(sensor.variance_lag[-1]))
    if abs(late) > PLAUSIBLE.a_x_late and abs(late) > 3.0 * sigma:
        yield warning("a_x_late", log, late, (-PLAUSIBLE.a_x_late, PLAUSIBLE.a_x_late))
