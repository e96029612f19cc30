"""The level of the pads: the same on all ramps of a fit, up to how well pads repeat.

A normal ramp shows the level of both axles' pads together, one with the front axle only that of the
front pads. So a ramp with one axle tells the pads' ratio; normal ramps among themselves tell
nothing of it, for their levels move with it alike.

The force counts from the lead-in: neither the zero of a_x nor a resistance that stays moves it.
"""

import numpy as np
from numpy.typing import NDArray

from calib.car.vehicle import Vehicle
from calib.fitting.ensemble import PRIORS
from calib.model.ramp import RampRun, nominal_forces, pad_scale
from calib.model.resistance import Resistance
from calib.model.settings import SETTINGS
from calib.table.table import Value

Array = NDArray[np.float64]

LEAST = 1e-3
"""Level [1] that no pads have; what comes out below it counts as this."""

_STEP = 1e-3  # of ln of the pads' ratio, for its derivative [1]


def level_sigmas(vehicle: Vehicle, run: RampRun, known: Resistance) -> tuple[float, float, float]:
    """Relative sigma [1] of the pad scale of a run from noise, resistance and accelerometer.

    The scale is sum(z y)/sum(z^2) of what the brakes demand y: an error e(z) moves it by
    sum(z e)/sum(z^2). From the lead-in on, the accelerometer errs by its scale; without one by its
    zero, too. The noise of the lead-in is in a resistance that was found there, and counts beside
    one that is given.
    """
    b, lead = run.blocks, run.rolling
    braked = run.use & ~b.lead_in
    z = b.z[braked]
    square = float(z @ z)
    # sum(z e)/sum(z^2) of an e that is 1
    lever = float(z.sum()) / square
    noise = run.noise.z / np.sqrt(b.length * square)
    if lead.size and known.known:
        noise = np.hypot(noise, lever * run.noise.z / np.sqrt(b.length * lead.size))
    resist = float(known.sigma_z(vehicle, b.speed[braked]) @ z) / square
    if run.accelerometer is None or lead.size:
        return float(noise), resist, _scale(run)[1]
    return float(noise), resist, lever * float(run.accelerometer.sigma(np.asarray(1.0 / lever)))


def _scale(run: RampRun) -> tuple[float, float]:
    """By what a_x still reads too much under braking, and its sigma [1].

    Only v tells it; without v it is that of usual sensors, on bodies that pitch.
    """
    if run.accelerometer is None:
        return 0.0, 0.0
    if run.slip is None:
        return PRIORS["a_x_scale"]
    return 0.0, float(np.sqrt(run.accelerometer.variance_scale))


def pad_levels_of(vehicle: Vehicle, runs: list[RampRun], log_ratio: float) -> Array:
    """Level of the pads of each run over those of the file [1], at a ratio of the pads, (runs,)."""
    scales = [
        (1.0 - _scale(run)[0]) * pad_scale(run, *nominal_forces(vehicle, run, log_ratio))
        for run in runs
    ]
    return np.maximum(scales, LEAST)


def ratio_by_levels(
    vehicle: Vehicle, runs: list[RampRun], known: Resistance, before: Value
) -> Value:
    """ln of the pads' ratio [1] from what was known ``before`` and the levels of the runs.

    Most probable value and its sigma where levels differ by how pads repeat and by how well a run
    knows its own; ``before`` itself without a ramp of one axle. Errors that the runs share
    (resistance, accelerometer) count as if they were independent: rather too wide.
    """
    if all(run.only is None for run in runs):
        return before
    own = [np.linalg.norm(level_sigmas(vehicle, run, known)) for run in runs]
    spread = np.hypot(SETTINGS.pads_repeat, own)

    def rest(ratio: float) -> Array:
        level = np.log(pad_levels_of(vehicle, runs, ratio))
        # the common level is not known beforehand: their weighted mean
        return np.asarray((level - np.average(level, weights=spread**-2.0)) / spread)

    x, information = before.value, before.sigma**-2.0
    for _ in range(4):
        e = rest(x)
        slope = (rest(x + _STEP) - rest(x - _STEP)) / (2.0 * _STEP)
        information = before.sigma**-2.0 + float(slope @ slope)
        x -= float(slope @ e + (x - before.value) * before.sigma**-2.0) / information
    return Value(x, information**-0.5)
