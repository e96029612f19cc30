"""The level of the pads: the same on all ramps of a fit, up to how well pads repeat.

A normal ramp shows the level of both axles' pads together, one with the front axle only that of the
front pads. So a ramp with one axle tells the pads' ratio; normal ramps among themselves tell
nothing of it, for their levels move with it alike.
"""

import numpy as np
from numpy.typing import NDArray

from calib.car.vehicle import Vehicle
from calib.model.ramp import RampRun, nominal_forces, pad_scale
from calib.model.resistance import Resistance
from calib.model.settings import SETTINGS

Array = NDArray[np.float64]

LEAST = 1e-3
"""Level [1] that no pads have; what comes out below it counts as this."""


def level_sigmas(vehicle: Vehicle, run: RampRun, known: Resistance) -> tuple[float, float, float]:
    """Relative sigma [1] of the pad scale of a run from noise, resistance and accelerometer.

    The scale is sum(z y)/sum(z^2) of what the brakes demand y: an error e(z) moves it by
    sum(z e)/sum(z^2). The accelerometer errs by c z + bias, the same all along the run.
    """
    braked = run.use & ~run.blocks.lead_in
    z = run.blocks.z[braked]
    square = float(z @ z)
    noise = run.noise.z / np.sqrt(run.blocks.length * square)
    resist = float(known.sigma_z(vehicle, run.blocks.speed[braked]) @ z) / square
    if run.accelerometer is None:
        return float(noise), resist, 0.0
    # c + bias sum(z)/sum(z^2): as of the one deceleration sum(z^2)/sum(z)
    typical = np.asarray(square / float(z.sum()))
    return float(noise), resist, float(run.accelerometer.sigma(typical) / typical)


def level_spread(vehicle: Vehicle, runs: list[RampRun], known: Resistance | None) -> Array:
    """Sigma [1] of the logarithm of each run's level about the common one, (runs,).

    How pads repeat, and how well the run knows its level; ``known`` the resistance, None for runs
    that know their levels exactly. Errors that the runs share (resistance, accelerometer) count as
    if they were independent: the spread is too wide rather than too narrow.
    """
    own = [level_sigmas(vehicle, run, known) if known else (0.0,) for run in runs]
    return np.asarray([np.hypot(SETTINGS.pads_repeat, np.linalg.norm(one)) for one in own])


def level_residuals(
    vehicle: Vehicle, runs: list[RampRun], log_ratio: float, spread: Array
) -> Array:
    """Logarithm of each run's level less the common one, over ``spread``, (runs,); none for one.

    The common level is their weighted mean: it is not known beforehand.
    """
    if len(runs) < 2:
        return np.empty(0)
    scales = [pad_scale(run, *nominal_forces(vehicle, run, log_ratio)) for run in runs]
    level = np.log(np.maximum(scales, LEAST))
    return np.asarray((level - np.average(level, weights=spread**-2.0)) / spread)
