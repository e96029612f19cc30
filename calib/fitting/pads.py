"""The pads of the ramps: what is known of their ratio, their level, and what both rest on.

A normal ramp shows the level of both axles' pads together, one with the front axle only that of the
front pads. So a ramp with one axle tells the pads' ratio; normal ramps among themselves tell
nothing of it, for their levels move with it alike.

The force counts from the lead-in: neither the zero of a_x nor a resistance that stays moves it.
"""

import math
from collections.abc import Mapping

import numpy as np

from calib.base.arrays import Array
from calib.car.balance import front_share
from calib.car.beliefs import CAR, LOG
from calib.car.vehicle import Vehicle
from calib.model.ramp import RampRun, nominal_forces, pad_scale
from calib.model.roller_bench import RollerBench
from calib.run.resistance import Resistance
from calib.table.budget import axle_parts
from calib.table.table import Calibration, TableBudget, Value

UNSAID = Value(CAR.log_pad_ratio.mean, CAR.log_pad_ratio.sigma)
"""ln of the pads' ratio over that of the file where the user said nothing."""

_LEAST = 1e-3  # level that no pads have; what comes out below it counts as this [1]


def stated_pad_ratio(vehicle: Vehicle, bench: RollerBench | None) -> Value:
    """ln of (mu_f/mu_r) over its value in the vehicle file [1], by rollers or tolerances.

    Rollers measured the very pads: where they are given, the tolerances of the file, which speak of
    the grade, say no more. `UNSAID` without either. Raises BenchError and ModelError as
    `RollerBench.log_pad_ratio`.
    """
    if bench is not None:
        return bench.log_pad_ratio(vehicle)
    said = [axle.pad_friction_tolerance for axle in (vehicle.front, vehicle.rear)]
    if said == [None, None]:
        return UNSAID
    unsaid = UNSAID.sigma / math.sqrt(2.0)  # of one axle, where he speaks of the other only
    return Value(0.0, math.hypot(*(unsaid if one is None else one for one in said)))


def levels_of(
    vehicle: Vehicle, runs: list[RampRun], known: Resistance, log_ratio: float
) -> tuple[Array, Array]:
    """Level of the pads of each run over those of the file [1], at a ratio of the pads, (runs,).

    And its relative sigmas from noise, resistance and accelerometer [1], (runs, 3). The level is
    sum(z y)/sum(z^2) of what the brakes demand y: an error e(z) moves it by sum(z e)/sum(z^2). The
    accelerometer errs by its scale, which only v tells; usual ones read too much on bodies that
    pitch. The noise of the lead-in is in a resistance that was found there, and counts beside one
    that is given.
    """
    levels, sigmas = [], []
    for run in runs:
        b, sensor, z = run.blocks, run.accelerometer, run.blocks.z[run.braked]
        square = z @ z
        noise = run.noise.z / np.sqrt(b.length * square)
        if known.known:
            rolled = b.length * max(run.rolling.size, 1)
            noise = np.hypot(noise, z.sum() / square * run.noise.z / np.sqrt(rolled))
        resistance = known.sigma_z(vehicle, b.speed[run.braked]) @ z / square
        too_much, scale, *_ = LOG.a_x_scale
        if run.slip is not None:
            too_much, scale = 0.0, 0.0 if sensor is None else float(np.sqrt(sensor.variance_scale))
        level = (1.0 - too_much) * pad_scale(run, *nominal_forces(vehicle, run, log_ratio))
        levels.append(max(level, _LEAST))
        sigmas.append([noise, resistance, scale])
    return np.array(levels), np.array(sigmas)


def ratio_by_levels(
    vehicle: Vehicle, runs: list[RampRun], known: Resistance, before: Value
) -> Value:
    """ln of the pads' ratio [1] from what was known ``before`` and the levels of the runs.

    ln of a level falls with the ratio by the front axle's share of the force, less a half. Levels
    differ by how pads repeat and by how well a run knows its own; ``before`` itself without a ramp
    of one axle. Errors that the runs share (resistance, accelerometer) count as if they were
    independent: rather too wide.
    """
    if all(run.only is None for run in runs):
        return before
    share = {"f": 1.0, "r": 0.0, None: front_share(vehicle, before.value)}
    levels, sigmas = levels_of(vehicle, runs, known, before.value)
    weight = 1.0 / (LOG.pads_repeat.sigma**2 + np.sum(sigmas**2, axis=1))
    shares = np.array([share[run.only] for run in runs])
    # the common level is not known beforehand: their weighted mean
    off, apart = (x - np.average(x, weights=weight) for x in (np.log(levels), shares))
    precision = before.sigma**-2.0 + weight @ apart**2
    return Value(before.value + float(weight * apart @ off / precision), float(precision**-0.5))


def level_of(
    vehicle: Vehicle, runs: list[RampRun], known: Resistance, log_ratio: float
) -> tuple[float, dict[str, float]]:
    """Common factor on the pads of ramps with both axles [1], and the variance of its ln by part.

    Mass, accelerometer and resistance are common to all ``runs``, so more runs do not shrink them;
    what the runs differ by counts as noise.
    """
    levels, sigmas = levels_of(vehicle, runs, known, log_ratio)
    noise, resistance, accelerometer = np.mean(sigmas, axis=0) ** 2
    return float(np.mean(levels)), {
        "mass": vehicle.mass_tolerance**2,
        "resistance": float(resistance),
        "accelerometer": float(accelerometer),
        "noise": float(noise + np.var(np.log(levels)) / len(runs)),
    }


def calibration_of(
    vehicle: Vehicle,
    scale: float,
    ratio: Value,
    stiffness: Value,
    parts: Mapping[str, dict[str, float]],
) -> tuple[Calibration, TableBudget]:
    """The pads and tyres, each with its sigma, and what they rest on, see `calib.table.budget`.

    ``scale`` common factor of both axles' pads [1]; ``ratio`` ln of theirs; ``stiffness`` ln of
    the slip stiffness; ``parts`` variances of level, ratio and stiffness as of `TableBudget`.

    The sum of forces fixes the mean of both axles weighed by their share. The scale, which is
    their geometric mean, moves against it with the ratio by half the difference of the shares.
    """
    relative, share = np.sqrt(sum(parts["level"].values())), front_share(vehicle, ratio.value)
    half, stiff = np.exp(0.5 * ratio.value), math.exp(stiffness.value)

    def known_to(value: float, lever: float) -> Value:
        return Value(float(value), float(value * np.hypot(relative, lever * ratio.sigma)))

    pads = Calibration(
        pad_scale=known_to(scale, share - 0.5),
        pad_log_ratio=ratio,
        pad_friction_f=known_to(scale * vehicle.front.pad_friction * half, 1.0 - share),
        pad_friction_r=known_to(scale * vehicle.rear.pad_friction / half, share),
        slip_stiffness=Value(stiff, stiff * stiffness.sigma),
    )
    axles = axle_parts(vehicle, ratio.value, parts["level"], parts["ratio"])
    return pads, TableBudget(*axles, **parts)
