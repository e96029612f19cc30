"""What a run says against its wheel speeds and its v: one made of the other, or lost pulses.

A tyre that brakes slips. Where v shows none of it, v was computed from the wheel speeds.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from calib.base.intervals import QUARTILE
from calib.base.names import WHEELS
from calib.base.warning import PlausibilityWarning
from calib.car.braking import BITE, MOVING
from calib.car.forces import axle_loads
from calib.car.vehicle import Vehicle
from calib.logs.log import Log
from calib.plausibility.limits import PLAUSIBLE
from calib.run.axle_signals import Signals, rolling_radii
from calib.run.blocks import BLOCK
from calib.run.filters import block_mean

Array = NDArray[np.float64]

V_OF_WHEELS, LOST_PULSES = "v_of_wheels", "lost_pulses"


def wheel_signal_warnings(log: Log, vehicle: Vehicle, s: Signals) -> Iterator[PlausibilityWarning]:
    """A v that was made of wheel speeds, and wheels that lose pulses."""
    yield from _made_of_wheels(log.name, vehicle, s)
    yield from _lost_pulses(log, s)


def _made_of_wheels(log: str, vehicle: Vehicle, s: Signals) -> Iterator[PlausibilityWarning]:
    """Slip that an axle lacks while it brakes, over the least that any tyre has.

    Tyres of a stiffness of 60 slip by a sixtieth of the force over the load. Of v from one axle the
    slip is zero, of v from all wheels the mean of both. Uses the nominal pads; an axle that is not
    braked for a second with 0.05 of its load says nothing.
    """
    radii = rolling_radii(s)
    if s.v is None or radii is None:
        return
    n = max(1, round(BLOCK / s.sample_time))
    v, loads = block_mean(s.v, n), axle_loads(vehicle, block_mean(s.z, n))
    least, slips = [], []
    axles = ((vehicle.front, s.omega_f, s.p_f), (vehicle.rear, s.omega_r, s.p_r))
    for (axle, omega, p), radius, load in zip(axles, radii, loads, strict=True):
        torque = 2.0 * axle.pad_friction * axle.torque_gain * block_mean(p, n)
        carried = torque / axle.rolling_radius / np.maximum(load, 1.0)
        least.append(np.where(block_mean(p, n) > BITE, carried, 0.0) / PLAUSIBLE.stiffness[1])
        slips.append(1.0 - block_mean(omega, n) * radius / np.maximum(v, MOVING))
    driven = block_mean(np.abs(s.drive_f) + np.abs(s.drive_r), n) > 0.0
    glitch = np.minimum(*loads) <= 0.0  # of a_x
    shows = (v > MOVING) & ~driven & ~glitch
    sources = (
        ("the front wheels", slips[0], least[0]),
        ("the rear wheels", slips[1], least[1]),
        ("all wheels", 0.5 * (slips[0] + slips[1]), 0.5 * (least[0] + least[1])),
    )
    for source, slip, expected in sources:
        use = shows & (expected * PLAUSIBLE.stiffness[1] > PLAUSIBLE.v_force)
        if np.count_nonzero(use) * n * s.sample_time < PLAUSIBLE.v_time:
            continue
        share = float(np.sqrt(np.mean(slip[use] ** 2)) / np.mean(expected[use]))
        if share < PLAUSIBLE.v_slip:
            yield PlausibilityWarning(
                V_OF_WHEELS,
                log,
                share,
                (1.0, None),
                (f"v is computed from {source}", "a channel map that takes a wheel speed as v"),
                "log a v that no wheel speed has a part in, or leave v out of the log",
            )
            return


def _lost_pulses(log: Log, s: Signals) -> Iterator[PlausibilityWarning]:
    """Samples in which one wheel alone is far below its usual course.

    A pulse that is lost lowers one reading by a tooth of 48 or so. Bumps lift and lower a wheel
    alike, and a wheel that slips is below for longer than the median over 11 samples spans.
    """
    from scipy.ndimage import median_filter

    unbraked = s.lead_in | (np.maximum(s.p_f, s.p_r) < BITE)
    rolling = np.asarray(unbraked & (s.speed > MOVING))
    if np.count_nonzero(rolling) * s.sample_time < PLAUSIBLE.v_time:
        return
    for wheel in WHEELS:
        omega = log[f"omega_{wheel}"]
        away = (omega - median_filter(omega, PLAUSIBLE.pulse_span))[rolling]
        usual = float(np.median(np.abs(away))) / QUARTILE
        far = PLAUSIBLE.pulse_sigma * max(usual, 1e-3 * float(np.mean(omega[rolling])))
        below, above = float(np.mean(away < -far)), float(np.mean(away > far))
        if below - 2.0 * above > PLAUSIBLE.pulses:
            yield PlausibilityWarning(
                LOST_PULSES,
                log.name,
                below,
                (0.0, PLAUSIBLE.pulses),
                (f"the sensor of omega_{wheel} loses pulses", "a damaged tooth of its ring"),
                "look at the sensor, its gap and its ring; the speed of that wheel reads too low",
            )
