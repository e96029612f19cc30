"""What a motor that is not logged leaves open of the pads, in the intervals of an estimate.

    lower end of ln mu of an axle:   variance + 2 s (E[m^2] + m_0^2/2) (F_usual/F_axle)^2
                                              + 2 (D^2 + D_0^2)/F^2

m is the share of the usual brake force F_usual that a motor may have, zero where there is none
(`calib.plausibility.brakes.motor_of`, with `Vehicle.motor_odds`); it acts on one axle, with the
chance s on this one. F_axle and F are the brake forces of the axle and of both, D the drag that
slowed the car before it braked and may go on: its slip is zeroed there, so it moves both axles. m_0
and D_0 are those that a fit has named on its ramps: they stand in the table, and the car has them,
or one of two of m_0.

A motor makes pads seem stronger, so the upper end stays. It is rare and large: the end with 2.5 %
beyond it is 2.2 (a motor for sure, half of a normal distribution) to 3.6 (one of ten) times the
root of E[m^2] away, and not 1.96 times; hence the 2. Uses the whole run.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calib.base.names import G
from calib.base.warning import PlausibilityWarning
from calib.estimation.estimator import Estimate
from calib.estimation.gates import still_narrow
from calib.estimation.pads import grown, lowered
from calib.estimation.settings import SETTINGS
from calib.logs.log import Log
from calib.plausibility.brakes import motor_of

Array = NDArray[np.float64]


_LOGGED = ("T_drive_f", "T_drive_r")


def with_motor(log: Log, e: Estimate, of_ramps: Sequence[PlausibilityWarning] = ()) -> Estimate:
    """The estimate, its intervals and ``valid`` with a motor that ``log`` may not show.

    ``of_ramps`` what the fit of the table said of its ramps. As it is where the torques of both
    axles are logged, or the run brakes too little to tell, and where it does not brake.
    """
    if e.response is None or not e.braked.any() or all(name in log for name in _LOGGED):
        return e
    on_ramp = _largest(of_ramps, "unexplained_braking_force")
    drags = float(e.accelerometer.drag[-1]), _largest(of_ramps, "unexplained_drag") / G
    car = e.plan.nominal
    forces = [
        np.where(
            e.braked,
            np.maximum(2.0 * of.torque / axle.rolling_radius, SETTINGS.motor_least),
            np.inf,
        )
        for axle, of in ((car.front, e.front), (car.rear, e.rear))
    ]
    both = forces[0] + forces[1]
    usual = float(np.median(both[e.braked]))
    drag = car.weight * math.hypot(*drags) / both
    square = motor_of(e.response, car.motor_odds).square + SETTINGS.motor_on_ramp * on_ramp**2
    front, rear = (
        lowered(axle, 2.0 * (share * square * (usual / force) ** 2 + drag**2))
        for axle, share, force in zip(
            (e.front, e.rear),
            (SETTINGS.motor_front, 1.0 - SETTINGS.motor_front),
            forces,
            strict=True,
        )
    )
    judged = still_narrow(e.plan.gates, e.valid, e.refused, (front, rear))
    return replace(
        e,
        front=front,
        rear=rear,
        valid=judged.valid,
        refused=judged.refused,
        motor=(grown(front, e.front), grown(rear, e.rear)),
    )


def _largest(warnings: Sequence[PlausibilityWarning], code: str) -> float:
    """The largest that was measured by the warnings of a code, 0 without any."""
    return max((warning.measured for warning in warnings if warning.code == code), default=0.0)
