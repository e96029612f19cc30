"""Level and ratio of the pads on the ramps, with their uncertainty by part.

A ramp with both axles gives the common level of their pads, one with the front axle only that of
the front pads; the difference gives the pads' ratio. Without ramps of one axle, levels say nothing
about the ratio.

The force counts from the lead-in, so neither the zero of a_x nor a constant resistance moves it.
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

DEFAULT_PRIOR = Value(CAR.log_pad_ratio.mean, CAR.log_pad_ratio.sigma)
"""ln of the pads' ratio over that of the file, where the user says nothing of it."""

_LEAST = 1e-3  # lower limit of a level, below that of any pads [1]


def pad_ratio_prior(vehicle: Vehicle, bench: RollerBench | None) -> Value:
    """Prior of ln of (mu_f/mu_r) over its value in the vehicle file [1].

    By the roller bench, which measured these very pads; else by the tolerances of the file, which
    are of the grade; else `DEFAULT_PRIOR`. Raises BenchError and ModelError as
    `RollerBench.log_pad_ratio`.
    """
    if bench is not None:
        return bench.log_pad_ratio(vehicle)
    tolerances = [axle.pad_friction_tolerance for axle in (vehicle.front, vehicle.rear)]
    if tolerances == [None, None]:
        return DEFAULT_PRIOR
    default = DEFAULT_PRIOR.sigma / math.sqrt(2.0)  # for an axle without a tolerance
    return Value(0.0, math.hypot(*(default if x is None else x for x in tolerances)))


def _levels_of(
    vehicle: Vehicle, runs: list[RampRun], resistance: Resistance, log_ratio: float
) -> tuple[Array, Array]:
    """Level of the pads of each run over the file's, (runs,) [1], at a pads' ratio; its errors.

    These are relative standard deviations by noise, resistance and accelerometer, (runs, 3). The
    level is sum(z y)/sum(z^2) with the demanded force y: an error e(z) moves it by
    sum(z e)/sum(z^2). The scale of a_x has its prior, with pitch, where there is no v. The noise of
    the lead-in counts only with a resistance by the file: else it is in the identified one.
    """
    levels, sigmas = [], []
    for run in runs:
        b, sensor, z = run.blocks, run.accelerometer, run.blocks.z[run.braked]
        square = z @ z
        noise = run.noise.z / np.sqrt(b.length * square)
        if resistance.specified:
            rolled = b.length * max(run.rolling.size, 1)
            noise = np.hypot(noise, z.sum() / square * run.noise.z / np.sqrt(rolled))
        resistance_sigma = resistance.sigma_z(vehicle, b.speed[run.braked]) @ z / square
        too_much, scale, *_ = LOG.a_x_scale
        if run.slip is not None:
            too_much, scale = 0.0, 0.0 if sensor is None else float(np.sqrt(sensor.variance_scale))
        level = (1.0 - too_much) * pad_scale(run, *nominal_forces(vehicle, run, log_ratio))
        levels.append(max(level, _LEAST))
        sigmas.append([noise, resistance_sigma, scale])
    return np.array(levels), np.array(sigmas)


def ratio_by_levels(
    vehicle: Vehicle, runs: list[RampRun], resistance: Resistance, prior: Value
) -> Value:
    """ln of the pads' ratio [1] from its ``prior`` and the levels of the runs.

    ln of a level moves with the ratio by a lever, the front axle's share of the force. Its variance
    is that of the repeatability of pads and that of the run. Common errors of the runs (resistance,
    accelerometer) count as independent, which is rather too wide. Without a ramp of one axle it is
    the ``prior``.
    """
    if all(run.only is None for run in runs):
        return prior
    share = {"f": 1.0, "r": 0.0, None: front_share(vehicle, prior.value)}
    levels, sigmas = _levels_of(vehicle, runs, resistance, prior.value)
    weight = 1.0 / (LOG.pads_repeat.sigma**2 + np.sum(sigmas**2, axis=1))
    shares = np.array([share[run.only] for run in runs])
    # less the common level, which has no prior
    log_level, lever = (x - np.average(x, weights=weight) for x in (np.log(levels), shares))
    precision = prior.sigma**-2.0 + weight @ lever**2
    moved = float(weight * lever @ log_level / precision)
    return Value(prior.value + moved, float(precision**-0.5))


def level_of(
    vehicle: Vehicle, runs: list[RampRun], resistance: Resistance, log_ratio: float
) -> tuple[float, dict[str, float]]:
    """Common factor on the pads of ramps with both axles [1], and the variance of its ln by part.

    More ``runs`` reduce only the noise, of which their scatter is a part.
    """
    levels, sigmas = _levels_of(vehicle, runs, resistance, log_ratio)
    noise, by_resistance, accelerometer = np.mean(sigmas, axis=0) ** 2
    return float(np.mean(levels)), {
        "mass": vehicle.mass_tolerance**2,
        "resistance": float(by_resistance),
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
    """Pads and tyres with their standard deviations, and their budget, see `calib.table.budget`.

    ``scale`` common factor of both axles' pads [1]; ``ratio`` ln of the pads' ratio; ``stiffness``
    ln of the slip stiffness; ``parts`` variances of level, ratio and stiffness as of `TableBudget`.

    The sum of forces fixes the mean of the axles, weighed by their share of the force. The scale is
    their geometric mean, so the ratio moves it by half the difference of the shares.
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
