"""What a run says against its wheel speeds and its v: one made of the other, or lost pulses.

A tyre that brakes slips. Where v shows none of it, v was computed from the wheel speeds.
"""

from collections.abc import Iterator

import numpy as np

from calib.base.intervals import QUARTILE
from calib.base.names import WHEELS
from calib.base.warning import Measured
from calib.car.braking import BITE, MOVING
from calib.car.forces import axle_loads
from calib.car.vehicle import Vehicle
from calib.logs.log import Log
from calib.run.axle_signals import Signals, rolling_radii
from calib.run.blocks import BLOCK
from calib.run.filters import block_mean

STIFFEST = 60.0
"""Slip stiffness over load [1] that no tyre has."""
BRAKED = 0.05
"""Nominal brake force of an axle over its load [1] from which the slip of its tyres is seen."""
TIME = 1.0
"""Time of such braking, or of rolling, that is needed [s]."""
SPAN, SIGMA = 11, 5.0
"""Samples of the median from which a lost pulse stands out; the distance below it, in its usual
scatter, or in 0.1 % of the speed, that noise does not have."""


def slip_of_v(vehicle: Vehicle, s: Signals) -> Iterator[Measured]:
    """Slip of an axle while it brakes, by v, over the least that any tyre has [1] (rms).

    Of v from one axle that slip is zero, of v from all wheels the mean of both: the least of the
    three. Uses the nominal pads; an axle that is not braked for long says nothing.
    """
    radii = rolling_radii(s)
    if s.v is None or radii is None:
        return
    n = max(1, round(BLOCK / s.sample_time))
    v, loads = block_mean(s.v, n), axle_loads(vehicle, block_mean(s.z, n))
    carried, slips = [], []
    axles = ((vehicle.front, s.omega_f, s.p_f), (vehicle.rear, s.omega_r, s.p_r))
    for (axle, omega, p), radius, load in zip(axles, radii, loads, strict=True):
        pressure = block_mean(p, n)
        force = 2.0 * axle.pad_friction * axle.torque_gain * pressure / axle.rolling_radius
        carried.append(np.where(pressure > BITE, force / np.maximum(load, 1.0), 0.0))
        slips.append(1.0 - block_mean(omega, n) * radius / np.maximum(v, MOVING))
    driven = block_mean(np.abs(s.drive_f) + np.abs(s.drive_r), n) > 0.0
    glitch = np.minimum(*loads) <= 0.0  # of a_x
    shows = (v > MOVING) & ~driven & ~glitch
    found = []
    for source, weight in (("front", (1.0, 0.0)), ("rear", (0.0, 1.0)), ("four", (0.5, 0.5))):
        slip, force = (weight[0] * of[0] + weight[1] * of[1] for of in (slips, carried))
        use = shows & (force > BRAKED)
        if np.count_nonzero(use) * n * s.sample_time >= TIME:
            share = STIFFEST * np.sqrt(np.mean(slip[use] ** 2)) / np.mean(force[use])
            found.append((float(share), f"the {source} wheels"))
    if found:
        share, source = min(found)
        yield Measured("v_of_wheels", share, words={"source": source})


def lost_pulses(log: Log, s: Signals) -> Iterator[Measured]:
    """Share of the samples in which one wheel alone is far below its usual course [1].

    A pulse that is lost lowers one reading by a tooth of 48 or so. Bumps lift and lower a wheel
    alike, so twice the share above is taken off; a wheel that slips is below for longer than the
    median spans.
    """
    from scipy.ndimage import median_filter

    unbraked = s.lead_in | (np.maximum(s.p_f, s.p_r) < BITE)
    rolling = np.asarray(unbraked & (s.speed > MOVING))
    if np.count_nonzero(rolling) * s.sample_time < TIME:
        return
    for wheel in WHEELS:
        omega = log[f"omega_{wheel}"]
        away = (omega - median_filter(omega, SPAN))[rolling]
        usual = float(np.median(np.abs(away))) / QUARTILE
        far = SIGMA * max(usual, 1e-3 * float(np.mean(omega[rolling])))
        lost = float(np.mean(away < -far) - 2.0 * np.mean(away > far))
        yield Measured("lost_pulses", max(lost, 0.0), words={"wheel": f"omega_{wheel}"})
