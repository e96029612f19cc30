"""Compare the pressure with the deceleration: a pressure of another run does not go with it.

    z(t) = a + (b + c t) p(t - delay) + rest        over the lead-in and all that is braked

Everything that brakes do is in it but for a small part: pads that fade or dry are in c, lines that
lag in the delay, resistance and a bias of a_x in a. Wrong where a wheel is at its limit.
"""

import numpy as np
from numpy.typing import NDArray

from calib.base.names import AXLES, G
from calib.base.noise import explained_square
from calib.car.braking import MOVING
from calib.logs.log import Log
from calib.run.axle_signals import axle_pressure
from calib.run.driving_record import BITE_Z, STEADY, DrivingRecord
from calib.run.filters import centred_mean, since
from calib.run.limits import LIMITS

Array = NDArray[np.float64]

SLOWS = 1.5 * BITE_Z
"""Deceleration [g] that counts as braking whatever the pressure is: an engine in a low gear stays
below it."""

GREATEST = 1.5 * G
"""Deceleration [m/s^2] that no road car reaches: a sample past it is a glitch of a_x."""


DELAYS = np.arange(-0.2, 0.51, 0.05)
"""Delays of the deceleration against the pressure that are tried [s]: clocks may be early."""


def explained(log: Log, driving: DrivingRecord) -> float | None:
    """Share of the variance of the deceleration that the pressure explains [1].

    None where too little is braked to tell, or a motor's torque is logged, which brakes as well.
    The log must have ``p_mc``, ``a_x`` and the wheel speeds.
    """
    if any(f"T_drive_{axle}" in log for axle in AXLES):
        return None
    step = driving.step
    width = max(1, round(LIMITS.pressure_width / step)) | 1
    z = centred_mean(driving.z, width)
    active = driving.braked | (z > SLOWS)
    if not active.any():
        return None
    before = np.arange(z.size) < int(np.argmax(active))
    rolling = before & (np.abs(driving.z) < STEADY)
    glitch = (np.abs(log["a_x"]) > GREATEST).astype(float)
    use = (driving.speed > MOVING) & (centred_mean(glitch, width) == 0.0)
    enough = (use & active).sum() * step >= LIMITS.pressure_braked and (
        use & rolling
    ).sum() * step >= LIMITS.pressure_lead_in
    if not enough:
        return None
    at = np.flatnonzero(use & (rolling | (since(log.time, active) < LIMITS.pressure_after)))
    at = at[:: max(1, round(LIMITS.pressure_every / step))]
    time, y = log.time[at], z[at] - float(np.mean(z[at]))
    front, rear = (axle_pressure(log, axle) for axle in AXLES)
    unlike = (front,) if np.array_equal(front, rear) else (front, rear)
    pressures = [centred_mean(p, width) for p in unlike]
    if not np.ptp(y) > 0.0:  # an a_x that hangs has no course to explain
        return None
    return float(np.max(_fitted(log.time, pressures, time, y))) / float(y @ y)


def _fitted(clock: Array, pressures: list[Array], time: Array, y: Array) -> Array:
    """Sum of squares of ``y`` at ``time`` that the pressures explain, for each of `DELAYS`."""
    earlier = time - DELAYS[:, None]
    age = time - float(time.mean())
    columns = [np.ones_like(earlier)]
    for pressure in pressures:
        p = np.interp(earlier, clock, pressure)
        columns += [p, p * age]
    return explained_square(np.stack(columns, axis=1), y)
