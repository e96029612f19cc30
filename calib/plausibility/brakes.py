"""What a run says against its pressure, or for a braking force that the pressure does not make."""

from collections.abc import Iterator

import numpy as np

from calib.signals.axle_signals import Signals
from calib.signals.brake_response import USUAL, BrakeResponse
from calib.warning import PlausibilityWarning

FORCE = 0.045
"""Force without pressure over the usual brake force [1] from which it is named: it moves the pads
of one axle by twice as much."""

MISSING = -0.05
"""The same where force is missing: pads take 0.5 to 2 bar to bite, which is 3 % of a usual stop."""

SURE = 3.6
"""Standard deviations from zero that are asked for: one false alarm in 3000 runs of white noise;
the noise of roads makes more."""

LAG = 0.11
"""Delay between pressure and deceleration [s] from which it is named."""

ZERO = 0.5e5
"""Pressure of the rolling car [Pa] from which it is named: the zero of sensors of 250 bar drifts by
0.2 % of their range."""

BAR = 1e5


def response_warnings(log: str, response: BrakeResponse | None) -> Iterator[PlausibilityWarning]:
    """Force without pressure, and delay."""
    if response is None:
        return
    sure = abs(response.share) > SURE * response.share_sigma
    if sure and response.share > FORCE:
        yield PlausibilityWarning(
            "unexplained_braking_force",
            log,
            response.share,
            (MISSING, FORCE),
            (
                "a motor or an engine that brakes along with the pedal",
                "the zero of p_mc, too low",
                "rear brakes that do not get all of the pressure",
            ),
            "log T_drive_f and T_drive_r, negative where they slow the car, or brake without the "
            "motor; check the zero of p_mc",
        )
    if sure and response.share < MISSING:
        yield PlausibilityWarning(
            "braking_force_missing",
            log,
            response.share,
            (MISSING, FORCE),
            (
                "the zero of p_mc, too high",
                "a clock of a_x or of the brakes that is late against p_mc",
                "a pressure below which the pads do not bite",
                "pads that are wet at first",
            ),
            "check the zero of p_mc; find the cause with `brake-cal diagnose`",
        )
    late = response.delay
    if abs(late) > LAG and abs(late - USUAL) > SURE * response.delay_sigma:
        early = ("the clock of p_mc, late", "the clock of a_x, early")
        usual = ("hydraulic lag between p_mc and the wheels", "the clock or the filter of a_x")
        yield PlausibilityWarning(
            "pressure_lag",
            log,
            late,
            (-LAG, LAG),
            usual if late > 0.0 else early,
            "record all channels on one clock; log wheel pressures",
        )


def pressure_warnings(log: str, s: Signals) -> Iterator[PlausibilityWarning]:
    """Pressure of the car that rolls without braking."""
    if not s.lead_in.any():
        return
    zero = max((float(np.mean(p[s.lead_in])) for p in (s.p_f, s.p_r)), key=abs)
    if abs(zero) > ZERO:
        yield PlausibilityWarning(
            "pressure_zero",
            log,
            zero / BAR,
            (-ZERO / BAR, ZERO / BAR),
            ("the zero of p_mc", "a brake that is not released"),
            "zero the pressure sensor with the pedal released, or give an offset in a channel map",
        )
