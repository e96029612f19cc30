"""A motor that brakes beside the pressure, against what is usual."""

import math

from calib.base.mixtures import likelihood_ratio
from calib.car.vehicle import Vehicle
from calib.run.brake_response import BrakeResponse

FORCE = 0.1
"""Spread of a motor's force over the usual brake force [1]: 0.01 to 0.1 g beside 0.3 g."""
USUAL, FADING = 0.015, 0.02
"""Spread of a force without pressure, and of one that goes with the speed, where nothing but the
pads brakes [1]: the pressure at which pads bite and the zero of p_mc within 0.5 bar, over 30 bar;
slow noise in the half second below 3 m/s. Pads that grip more as they get slow are below zero."""
STATED = 0.01
"""Least odds of a motor: files that say that there is none are wrong, too."""


def motor_of(response: BrakeResponse, odds: float = Vehicle.motor_odds) -> tuple[float, float]:
    """Chance of a motor, and its force over the usual brake force, the surer of two [1].

    ``odds`` of one before the run [1] are those of the vehicle file; `STATED` at least. A motor
    shows as force without pressure where it brakes from the first pressure on, as a force that goes
    with the speed where it hands over to the brakes before the car stands; each of them, and both,
    are as likely. A run that is not braked down to 3 m/s says nothing of the second.

    >>> at_first, late = (BrakeResponse(1.0, 0.0, 0.01, 400.0, 0.0, 0.06, s) for s in (0.01, 0.03))
    >>> [round(motor_of(response)[0], 2) for response in (at_first, late)]
    [0.84, 0.17]
    """
    seen = (
        (response.share, math.hypot(response.share_sigma, USUAL)),
        (response.fading, math.hypot(response.fading_sigma, FADING)),
    )
    first, second = (likelihood_ratio(share, sigma, FORCE) for share, sigma in seen)
    now = max(odds, STATED) * ((1.0 + first) * (1.0 + second) - 1.0) / 3.0
    return now / (1.0 + now), response.share if first > second else response.fading
