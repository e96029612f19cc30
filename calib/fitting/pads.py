"""Estimate level and ratio of the pads on the ramps, with their uncertainty by part.

The level of a ramp is the brake force that the deceleration demands, over that of the vehicle
file's pads at the same pressure. The force on the lead-in is subtracted, so neither the zero of a_x
nor a constant resistance changes the level.

A ramp on which both axles brake gives the common level of their pads, a ramp on which the front
axle brakes alone that of the front pads. The difference of the levels gives the ratio of front to
rear pads. Without a ramp of one axle the ratio is not seen.
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
"""Prior of ln of the pads' ratio over that of the file [1], where the user gives no other."""

_LEAST_LEVEL = 1e-3  # lower limit of a level, so that its logarithm exists [1]


def pad_ratio_prior(vehicle: Vehicle, bench: RollerBench | None) -> Value:
    """Return the prior of ln of the pads' ratio mu_f/mu_r, over that of the vehicle file [1].

    It comes from the roller ``bench``, else from the pads' tolerances in the file, else it is
    `DEFAULT_PRIOR`. Raises BenchError and ModelError as `RollerBench.log_pad_ratio`.
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
    """Return the level of the pads of each run, (runs,) [1], and its errors, (runs, 3).

    ``log_ratio`` is ln of the pads' ratio over the file's [1]. The errors are relative standard
    deviations by noise, resistance and accelerometer. By least squares, with a force that rises as
    z, an error e of the demanded force over the weight changes the level by sum(z e)/sum(z^2).
    """
    levels, sigmas = [], []
    for run in runs:
        b, sensor, z = run.blocks, run.accelerometer, run.blocks.z[run.braked]
        square = z @ z
        noise = run.noise.z / np.sqrt(b.length * square)
        if resistance.specified:  # an identified resistance includes the noise of the lead-in
            rolled = b.length * max(run.rolling.size, 1)
            noise = np.hypot(noise, z.sum() / square * run.noise.z / np.sqrt(rolled))
        resistance_sigma = resistance.sigma_z(vehicle, b.speed[run.braked]) @ z / square
        # prior of the scale error of a_x, by the sensor and by gravity while the body pitches
        scale_error, scale_sigma = LOG.a_x_scale.mean, LOG.a_x_scale.sigma
        if run.slip is not None:  # v has corrected a_x, if there was anything to correct
            scale_error = 0.0
            scale_sigma = 0.0 if sensor is None else float(np.sqrt(sensor.variance_scale))
        level = (1.0 - scale_error) * pad_scale(run, *nominal_forces(vehicle, run, log_ratio))
        levels.append(max(level, _LEAST_LEVEL))
        sigmas.append([noise, resistance_sigma, scale_sigma])
    return np.array(levels), np.array(sigmas)


def ratio_by_levels(
    vehicle: Vehicle, runs: list[RampRun], resistance: Resistance, prior: Value
) -> Value:
    """Return ln of the pads' ratio [1] by its ``prior`` and the levels of the ``runs``.

    d(ln level) = lever d(ln ratio), where the lever is the front axle's share of the brake force.
    The variance of ln of a level is that of the repeatability of pads plus that of the run. Errors
    that the runs share (resistance, accelerometer) count as independent, which makes the result
    rather too wide. Without a ramp of one axle the result is the ``prior``.
    """
    if all(run.only is None for run in runs):
        return prior
    levels, sigmas = _levels_of(vehicle, runs, resistance, prior.value)
    weight = 1.0 / (LOG.pads_repeat.sigma**2 + np.sum(sigmas**2, axis=1))
    lever_of = {"f": 1.0, "r": 0.0, None: front_share(vehicle, prior.value)}
    levers, log_levels = np.array([lever_of[run.only] for run in runs]), np.log(levels)
    # subtract the means, since the common level has no prior
    log_levels, levers = (x - np.average(x, weights=weight) for x in (log_levels, levers))
    precision = prior.sigma**-2.0 + weight @ levers**2
    change = float(weight * levers @ log_levels / precision)
    return Value(prior.value + change, float(precision**-0.5))


def level_of(
    vehicle: Vehicle, runs: list[RampRun], resistance: Resistance, log_ratio: float
) -> tuple[float, dict[str, float]]:
    """Return the common factor on the pads of both axles [1], and the variance of its ln by part.

    ``runs`` are ramps on which both axles brake. More ramps reduce only the noise, which includes
    the scatter of the levels.
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
    """Return pads and tyres with their standard deviations, and their budget, a `TableBudget`.

    ``scale`` is the common factor of both axles' pads [1], ``ratio`` ln of the pads' ratio,
    ``stiffness`` ln of the slip stiffness; ``parts`` are the variances by quantity and cause.
    The sum of forces determines the mean of the axles' pads, weighed by share of the force. The
    scale is the geometric mean of the pads, so a change of the ratio changes the scale by half the
    difference of the shares.
    """
    level_sigma = np.sqrt(sum(parts["level"].values()))
    share = front_share(vehicle, ratio.value)
    root_ratio, slip_stiffness = np.exp(0.5 * ratio.value), math.exp(stiffness.value)

    def with_sigma(value: float, lever: float) -> Value:
        """Return a value with its sigma: d(ln value) = d(ln level) + lever d(ln ratio)."""
        return Value(float(value), float(value * np.hypot(level_sigma, lever * ratio.sigma)))

    pads = Calibration(
        pad_scale=with_sigma(scale, share - 0.5),
        pad_log_ratio=ratio,
        pad_friction_f=with_sigma(scale * vehicle.front.pad_friction * root_ratio, 1.0 - share),
        pad_friction_r=with_sigma(scale * vehicle.rear.pad_friction / root_ratio, share),
        slip_stiffness=Value(slip_stiffness, slip_stiffness * stiffness.sigma),
    )
    axles = axle_parts(vehicle, ratio.value, parts["level"], parts["ratio"])
    return pads, TableBudget(*axles, **parts)
