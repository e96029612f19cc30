r"""What brakes that follow late leave open of the pads, in the intervals of an estimate.

    error of ln mu = delay (p^2/m - 1)/(2 tau)      m: mean of p^2 over the last tau

Pad friction is torque over pressure, and brakes, filters and clocks make the one late against the
other. While a pressure is held that is nothing. While a foot pumps at 1.5 Hz, brakes that follow
after 30 ms make the friction swing. The level is a fit over the last seconds with the weights
p^2 e^(-age/tau); of a torque that is late by a small delay it makes this error (integrate p p' by
parts). Its trend halves its memory: tau is half of ``level_memory``. The interval counts the error
as a standard deviation: as it is, and as it was within the memory, since a swing passes through
zero. Uses the whole run for the delay.
"""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calib.estimation.estimator import Estimate
from calib.estimation.gates import still_narrow
from calib.estimation.pads import grown, lowered, raised
from calib.run.brake_response import BrakeResponse
from calib.run.filters import low_pass, since

Array = NDArray[np.float64]


def with_delay(e: Estimate, response: BrakeResponse | None = None) -> Estimate:
    """The estimate, its intervals and ``valid`` with brakes that follow as late as the run shows.

    As it is where the run brakes too little to tell how late the brakes are. ``response`` of the
    brakes where it is known.
    """
    response = response or e.response
    if response is None:
        return e
    variance = math.hypot(response.delay, response.delay_sigma) ** 2 * _swing(e)
    front, rear = (raised(lowered(axle, variance), variance) for axle in (e.front, e.rear))
    judged = still_narrow(e.plan.gates, e.valid, e.refused, (front, rear))
    return replace(
        e,
        front=front,
        rear=rear,
        valid=judged.valid,
        refused=judged.refused,
        late=(grown(front, e.front), grown(rear, e.rear)),
    )


def _swing(e: Estimate) -> Array:
    """Mean square of the relative error per delay [1/s^2] (n,), from `Gates.settle` on."""
    memory, step, gates = e.plan.priors.level_memory, e.read.sample_time, e.plan.gates
    tau = 0.5 * memory
    square = np.maximum(np.maximum(e.pressure_f, e.pressure_r), gates.pressure) ** 2
    settled = since(e.time, ~e.braked) > gates.settle
    now = np.where(settled, (square / low_pass(square, step, tau) - 1.0) / (2.0 * tau), 0.0) ** 2
    return np.asarray(np.maximum(now, low_pass(now, step, memory)))
