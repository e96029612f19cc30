"""What a run says against its pressure, or for a braking force that the pressure does not make."""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from calib.base.mixtures import likelihood_ratio, mean_square
from calib.base.warning import PlausibilityWarning, warning
from calib.car.vehicle import Vehicle
from calib.plausibility.limits import PLAUSIBLE
from calib.run.axle_signals import Signals
from calib.run.brake_response import FORCE as FORCE_BEFORE
from calib.run.brake_response import USUAL, BrakeResponse

LASTING, FOLLOWING = 0.4, 0.2
"""Share of the motors that brake until the car stands, and of those that follow the pedal as far as
the stop goes [1]: most are at their limit, 0.1 g, before the pads do much (our estimate)."""


STEP, CLEAR = 0.03, 5.0
"""Step of the force beside the pressure, over the usual brake force [1], from which it is named,
and over its scatter in the run: pads do not change by as much within 0.1 s. Of 900 runs in which
nothing happened, five of them past one of the two bounds, none was past both."""

UNKNOWN = 1.0
"""Sigma of a share of which a run says nothing [1]."""

BAR = 1e5


def response_warnings(
    log: str, response: BrakeResponse | None, odds: float = Vehicle.motor_odds
) -> Iterator[PlausibilityWarning]:
    """Force without pressure, a step of it, and delay; ``odds`` of a motor as in `motor_of`."""
    if response is None:
        return
    sure = abs(response.share) > PLAUSIBLE.sure * response.share_sigma
    motor = motor_of(response, odds)
    if motor.share > PLAUSIBLE.force and motor.chance > PLAUSIBLE.motor_likely:
        yield warning(
            "unexplained_braking_force",
            log,
            motor.share,
            (PLAUSIBLE.force_missing, PLAUSIBLE.force),
        )
    if sure and response.share < PLAUSIBLE.force_missing:
        yield warning(
            "braking_force_missing", log, response.share, (PLAUSIBLE.force_missing, PLAUSIBLE.force)
        )
    at, step, scatter = response.step
    if abs(step) > max(STEP, CLEAR * scatter):
        yield PlausibilityWarning(
            "force_step",
            log,
            step,
            (-STEP, STEP),
            (
                f"a gear shift, a clutch or a motor: the force changes at {at:.2f} s, and the "
                "pressure does not",
                "a bump, a gust or another slope",
            ),
            "brake in neutral or in one gear; log T_drive_f and T_drive_r, negative where they "
            "slow the car",
        )
    late = response.delay
    if (
        abs(late) > PLAUSIBLE.pressure_lag
        and abs(late - USUAL) > PLAUSIBLE.sure * response.delay_sigma
    ):
        early = ("the clock of p_mc, late", "the clock of a_x, early")
        usual = ("hydraulic lag between p_mc and the wheels", "the clock or the filter of a_x")
        yield PlausibilityWarning(
            "pressure_lag",
            log,
            late,
            (-PLAUSIBLE.pressure_lag, PLAUSIBLE.pressure_lag),
            usual if late > 0.0 else early,
            "record all channels on one clock; log wheel pressures",
        )


class Motor(NamedTuple):
    """What may brake beside the pressure, over the usual brake force [1].

    ``chance`` that it is there [1]; its ``share`` as measured, if so; ``square`` the mean of the
    square of the share, where one that is not there counts as zero.
    """

    chance: float
    share: float
    square: float


def motor_of(response: BrakeResponse, odds: float = Vehicle.motor_odds) -> Motor:
    """Weigh what is usual against a motor, which brakes.

    ``odds`` of one before the run [1] are those of the vehicle file; `motor_stated` at least.

    A motor acts from the first pressure on and brakes until the car stands, or hands over to the
    brakes before; or it follows the pedal, which no first pressure shows, and hands over. A run
    that is not braked down to 3 m/s tells nothing of the handing over.

    >>> at_first, late = (BrakeResponse(1.0, 0.0, 0.01, 400.0, 0.0, 0.06, s) for s in (0.01, 0.03))
    >>> [round(motor_of(response).chance, 2) for response in (at_first, late)]
    [0.9, 0.38]
    >>> round(motor_of(late, odds=0.01).chance, 2)
    0.06
    """
    at_once = _as_measured(response.share, response.share_sigma)
    slow = _Seen(response.fading, math.hypot(response.fading_sigma, PLAUSIBLE.usual_fading))
    kinds = (
        (LASTING, at_once),
        (FOLLOWING, slow),
        (1.0 - LASTING - FOLLOWING, _together(at_once, slow)),
    )
    parts = [part * _odds(seen) for part, seen in kinds]
    total, odds = sum(parts), max(odds, PLAUSIBLE.motor_stated)
    chance = odds * total / (1.0 + odds * total)
    share, square = (
        sum(one * of(seen) for one, (_, seen) in zip(parts, kinds, strict=True)) / total
        for of in (_measured, _square)
    )
    return Motor(chance, share, chance * square)


class _Seen(NamedTuple):
    """A force over the usual brake force [1], and its ``sigma`` where no motor brakes [1]."""

    share: float
    sigma: float


def _as_measured(share: float, sigma: float) -> _Seen:
    """A force without pressure, less what its measurement takes as usual before, `FORCE_BEFORE`.

    One of which the run says nothing is measured as zero, as well as `UNKNOWN` says.
    """
    kept = min((sigma / FORCE_BEFORE) ** 2, 1.0 - (FORCE_BEFORE / UNKNOWN) ** 2)
    return _Seen(
        share / (1.0 - kept), math.hypot(sigma / math.sqrt(1.0 - kept), PLAUSIBLE.usual_force)
    )


def _together(one: _Seen, other: _Seen) -> _Seen:
    """One force that was measured twice."""
    of_one, of_other = one.sigma**2, other.sigma**2
    total = of_one + of_other
    share = (of_other * one.share + of_one * other.share) / total
    return _Seen(share, math.sqrt(of_one * of_other / total))


def _odds(seen: _Seen) -> float:
    """How much likelier a motor makes a force than what is usual does, which has both signs."""
    return likelihood_ratio(seen.share, seen.sigma, PLAUSIBLE.motor_force)


def _measured(seen: _Seen) -> float:
    return seen.share


def _square(seen: _Seen) -> float:
    """Mean of the square of a motor's share, as it was seen."""
    return mean_square(seen.share, seen.sigma, PLAUSIBLE.motor_force)


def pressure_warnings(log: str, s: Signals) -> Iterator[PlausibilityWarning]:
    """Pressure of the car that rolls without braking."""
    if not s.lead_in.any():
        return
    zero = max((float(np.mean(p[s.lead_in])) for p in (s.p_f, s.p_r)), key=abs)
    if abs(zero) > PLAUSIBLE.pressure_zero:
        yield warning(
            "pressure_zero",
            log,
            zero / BAR,
            (-PLAUSIBLE.pressure_zero / BAR, PLAUSIBLE.pressure_zero / BAR),
        )
