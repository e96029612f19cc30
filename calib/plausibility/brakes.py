"""What a run says against its pressure, or for a braking force that the pressure does not make."""

import math
from collections.abc import Iterator

import numpy as np

from calib.signals.axle_signals import Signals
from calib.signals.brake_response import USUAL, BrakeResponse
from calib.warning import PlausibilityWarning

FORCE = 0.045
"""Force without pressure over the usual brake force [1] from which it is named: it moves the pads
of one axle by twice as much."""

USUAL_FORCE = 0.015
"""Spread of that force where nothing but the pads brakes [1]: the pressure at which pads bite and
the zero of p_mc within 0.5 bar, over 30 bar."""

MOTOR = 0.1
"""Spread of it where a motor brakes along [1]: 0.01 to 0.1 g beside 0.3 g by the pads."""

MOTORS = 0.1
"""Odds of such a motor, not logged, before the run."""

MISSING = -0.05
"""The same where force is missing: pads take 0.5 to 2 bar to bite, which is 3 % of a usual stop."""

SURE = 3.6
"""Standard deviations from zero from which missing force and a delay are named: one false alarm in
3000 runs of white noise; the noise of roads makes more."""

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
    if response.share > FORCE and motor_chance(response.share, response.share_sigma) > 0.5:
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


def motor_chance(share: float, sigma: float) -> float:
    """Chance [1] that something brakes beside the pressure.

    ``share`` its force over the usual brake force [1], as measured with ``sigma``. Weighed: a force
    that is usual, to either side, against that of a motor, which brakes.

    >>> [round(motor_chance(0.08, sigma), 2) for sigma in (0.01, 0.04)]
    [1.0, 0.26]
    """
    if share <= 0.0:
        return 0.0
    usual, motor = (math.hypot(sigma, spread) for spread in (USUAL_FORCE, MOTOR))
    log_odds = math.log(2.0 * MOTORS * usual / motor)
    log_odds += 0.5 * share**2 * (usual**-2.0 - motor**-2.0)
    return 1.0 / (1.0 + math.exp(-min(log_odds, 700.0)))


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
