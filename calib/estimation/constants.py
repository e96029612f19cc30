"""Constants of the step, which is the estimator on one block of samples.

`constants` returns them for a table and its sensors. First letters of names: ``q_`` for the random
walk of a state, ``r_`` for a measurement noise, ``var_`` for a variance, ``walk_`` for the variance
that a block adds to a state.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, fields
from functools import lru_cache
from typing import Any

import numpy as np

from calib.base.names import G
from calib.car.beliefs import CAR, LOG, SENSOR, STOP
from calib.car.braking import BITE, MOVING
from calib.run.driving_record import NOMINAL_RADIUS, ROLLING_Z
from calib.run.filters import samples_in
from calib.run.noise import WALK, SensorNoise
from calib.table.maps import Reader
from calib.table.table import Table

LEVEL = ("level", "level_lower", "level_upper")
PADS = ("ratio", "change"), ("ratio_lower", "change_lower"), ("ratio_upper", "change_upper")
SLIP = ("log_slip", "log_slip_sigma")
"""Columns of the maps. A `Reader` returns their values as an array of the same shape."""

_ROADS = STOP.log_stiffness
# root mean square of ln of the tyres' stiffness over the kinds of road
_ROAD_SIGMA = math.sqrt(np.average(np.hypot(_ROADS.mean, _ROADS.sigma) ** 2, weights=_ROADS.share))


def _follows(formula: Callable[["Constants"], float]) -> Any:
    """Return a field whose value follows from the other fields by a formula."""
    return field(init=False, metadata={"formula": formula})


@dataclass(frozen=True)
class Constants:
    """Values of table and sensors, then tuned numbers, then values that follow from both."""

    pads: Reader  # `PADS` over z, (eta - 1)/z and slip
    slip: Reader  # `SLIP` over the same
    level: Reader  # `LEVEL` over z
    prior: Reader  # `PADS` over z alone, for blocks in which eta is not read
    noise_rim: float  # noise density of the speed of the front wheels' rims [m/s s^0.5]
    noise_z: float  # noise density of the deceleration [s^0.5]
    noise_v: float  # noise density of the measured speed [m/s s^0.5]
    radii: float  # rolling radius of the front wheels over that of the rear ones, less 1 [1]
    late: float  # delay of v behind the wheel speeds [s]
    late_sigma: float  # sigma of this delay [s]
    ramp_ratio: float  # ln of the pads' ratio on the ramp [1]
    block: float  # length of a block [s]
    bite: float = BITE  # pressure of a brake that is applied [Pa]
    moving: float = MOVING  # least speed of a car that moves [m/s]
    steady: float = ROLLING_Z  # deceleration of a car that rolls, at most [1]
    q_radius: float = WALK  # random walk of the zeros of eta and slip [1/sqrt(s)]
    memory: float = 0.3  # time over which the means for the map forget [s]
    before_bite: float = 0.1  # time before a bite [s] in which pads may touch: no zero is read
    untouched: float = 7e4  # pressure up to which pads do not touch [Pa]
    settle: float = 0.3  # time of braking before an answer is valid [s]
    over: float = 1.0  # time after a release at which a stop is over [s]
    least_pressure: float = 2e5  # pressure of a valid answer [Pa]
    least_z: float = 0.05  # mean of z from which on eta is read [1]
    unsteady: float = 0.36  # factor of the variance of eta by pitching while z changes [1]
    usual_z: float = 0.1  # z at which the maps are read before any braking [1]
    least_mean_z: float = 0.01  # a smaller mean of z counts as this [1]
    least_share: float = 0.02  # a smaller level, or share of the pressure, counts as this [1]
    least_level: float = 0.05  # level of soaked pads, the weakest [1]
    most_level: float = 3.0  # level of the best racing pads, with a tenth of error [1]
    level_sigma: float = CAR.pad_level.sigma  # sigma of the level before any braking [1]
    q_level: float = 0.01  # random walk of the level, relative [1/sqrt(s)]
    fade: float = 0.06  # sigma of the rate at which the level changes [1/s]
    q_rate: float = 0.02  # random walk of this rate, relative to the level [1/s^1.5]
    jump: float = 3.0  # innovation from which on the level has made a step [sigma]
    r_level: float = 0.007  # relative noise of the force of a block, by road and body
    lag: float = CAR.brake_lag.mean  # time constant of the brakes [s]
    lag_sigma: float = CAR.brake_lag.sigma  # sigma of that time constant [s]
    r_lag: float = 0.2  # error of the force by a lag that is not of first order, over what lags
    least_lag: float = 0.004  # least time constant of the brakes [s]
    apart: float = 0.02  # difference of the clocks of a_x and speeds [s]
    zero: float = CAR.zero.sigma  # sigma of a zero before any rolling [1]
    offset: float = SENSOR.a_x_offset.sigma  # sigma of bias and slope before any rolling [1]
    q_bias: float = 1e-4  # random walk of the bias of a_x as it warms up [1/sqrt(s)]
    q_grade: float = 0.001  # random walk of bias and slope [1/sqrt(s)]
    scale: float = LOG.a_x_scale_step.mean  # relative excess of a_x while braking [1]
    scale_sigma: float = LOG.a_x_scale_step.sigma  # sigma of this excess [1]
    ageing: float = 0.01  # random walk of a held ratio [1/sqrt(s)]
    unlike: float = 0.5  # sigma of the change of ln of the ratio over that of ln of the level [1]
    narrower: float = 0.2  # a reading narrower by this replaces the held ratio [1]
    r_slip: float = 0.04  # relative noise of the slip of a block
    log_slip: float = CAR.log_slip.mean  # ln(slip/z) before any braking: slip/z is 0.04 [1]
    log_slip_sigma: float = CAR.log_slip.sigma  # sigma of this logarithm [1]
    q_slip: float = 0.03  # random walk of ln(slip/z) [1/sqrt(s)]
    q_bends: float = 0.1  # variance of ln(slip/z) per change of z [1], since tyre curves bend
    other_road: float = _ROAD_SIGMA  # sigma of ln of the tyres' stiffness over the ramp's [1]
    slowest: float = 0.3  # a slower speed of the rims counts as this [m/s]
    steering: float = math.radians(5.0)  # angle [rad] that changes eta as much as braking does
    lateral: float = 3.0  # acceleration by the wheels, above which a bend changes eta [m/s^2]
    # (left and right radii that differ by 0.5 % look like it at 30 m/s)
    lock: float = 0.15  # a wheel that is slower than the fastest by this share locks [1]
    slows: float = 15.0 / NOMINAL_RADIUS  # wheels that slow by more [rad/s^2] lock on any road
    turning: float = MOVING / NOMINAL_RADIUS  # wheel speed from which on a lock is seen [rad/s]
    recover: float = 1.0  # time after a lock, ABS or a failed check without a valid answer [s]
    unexplained: float = 0.02  # brake force over the weight that is more than noise of a_x [1]
    errs: float = 10.0  # log likelihood ratio from which on a_x errs, or a motor is wrong
    most_evidence: float = 2.5  # most that a block adds to it, so that a bump is no error of a_x
    drive_memory: float = 0.5  # time over which the mean force of motors forgets [s]
    usual_level: float = 1.0  # time over which the level before a step is followed [s]
    chatter: float = 8.0  # mean of squared innovations from which on ABS works
    most_chatter: float = 36.0  # a larger squared innovation counts as this
    chatter_memory: float = 0.7  # time over which that mean forgets [s]
    trusted: float = 2.0  # departure of the scale from its prior without doubt [sigma]
    far: float = 7.0  # largest plausible departure of the offset from its prior [sigma]
    far_scale: float = 10.0  # the same for the scale: a slope that begins in a stop makes 9
    far_slip: float = 2.8  # the same for ln(slip/z), upwards
    least_demand: float = -0.15  # least plausible brake force over the weight [1]
    most_demand: float = 1.3  # largest plausible brake force over the weight [1]
    most_zero: float = 0.1  # largest plausible zero of the demand [1]
    most_radii: float = 0.05  # largest plausible departure of eta - 1 from the file's radii [1]
    refusals: float = 10.0  # implausible zeros in a row, after which no zero is known

    keep: float = _follows(lambda c: math.exp(-c.block / c.memory))  # share of old means [1]

    # variances before any braking
    var_level: float = _follows(lambda c: c.level_sigma**2)
    var_rate: float = _follows(lambda c: c.fade**2)
    var_lag: float = _follows(lambda c: c.lag_sigma**2)
    var_log_slip: float = _follows(lambda c: c.log_slip_sigma**2)
    var_zero: float = _follows(lambda c: c.zero**2)
    var_offset: float = _follows(lambda c: c.offset**2)
    var_scale: float = _follows(lambda c: c.scale_sigma**2)
    # variances of the mean of a block by noise, and that of the speed in a block
    var_z: float = _follows(lambda c: c.noise_z**2 / c.block)
    var_rim: float = _follows(lambda c: c.noise_rim**2 / c.block)
    var_zero_z: float = _follows(lambda c: (c.noise_z**2 + 1e-8) / c.block)  # more than 0
    var_v: float = _follows(lambda c: (G * c.noise_z) ** 2 * c.block)  # by the noise of a_x
    var_apart: float = _follows(lambda c: (G * c.apart) ** 2)  # of the speed, per (change of z)^2
    walk_level: float = _follows(lambda c: c.q_level**2 * c.block)
    walk_rate: float = _follows(lambda c: c.q_rate**2 * c.block)
    walk_slip: float = _follows(lambda c: c.q_slip**2 * c.block)
    walk_grade: float = _follows(lambda c: c.q_grade**2 * c.block)
    walk_bias: float = _follows(lambda c: c.q_bias**2 * c.block)
    walk_radius: float = _follows(lambda c: c.q_radius**2 * c.block)
    # shares of a block in means that forget [1]
    share_chatter: float = _follows(lambda c: c.block / c.chatter_memory)
    share_level: float = _follows(lambda c: c.block / c.usual_level)
    share_drive: float = _follows(lambda c: min(c.block / c.drive_memory, 1.0))
    walk_held: float = _follows(lambda c: c.ageing**2)  # of a held ratio, in a second [1/s]

    # times are sums of blocks: with half a block off, no rounding decides a comparison [s]
    applied: float = _follows(lambda c: c.settle - 0.5 * c.block)
    released: float = _follows(lambda c: c.over + 0.5 * c.block)
    most_share: float = _follows(lambda c: 1.0 / c.least_share)  # of the pressure that acts [1]

    # square of a departure of the scale without doubt, and the largest plausible departures
    trusted_scale: float = _follows(lambda c: (c.trusted * c.scale_sigma) ** 2)
    most_offset: float = _follows(lambda c: c.far * c.offset)
    most_scale: float = _follows(lambda c: c.far_scale * c.scale_sigma)
    most_log_slip: float = _follows(lambda c: c.log_slip + c.far_slip * c.log_slip_sigma)
    speed: float = _follows(lambda c: G * c.block)  # that a car loses in a block at 1 g [m/s]

    def __post_init__(self) -> None:
        for x in fields(self):
            if not x.init:
                object.__setattr__(self, x.name, x.metadata["formula"](self))


def constants(table: Table, noise: SensorNoise, block: float) -> Constants:
    """Return the constants of a ``table``, sensor ``noise``, and length of a ``block`` [s]."""
    return Constants(
        **_of_table(table),
        noise_rim=float(table.vehicle.front.rolling_radius * noise.omega),
        noise_z=float(noise.z),  # Python's numbers are three times as fast as numpy's
        noise_v=float(noise.v),
        block=block,
        settle=block * samples_in(Constants.settle, block),  # a whole number of blocks
    )


@lru_cache(maxsize=4)
def _of_table(table: Table) -> dict[str, Any]:
    """Return the constants that depend on no log."""
    car, draws = table.vehicle, table.draws
    return {
        "pads": Reader(table.map, PADS),
        "slip": Reader(table.map, SLIP),
        "level": Reader(table.level_map, LEVEL),
        "prior": Reader(table.level_map, PADS),
        "radii": car.front.rolling_radius / car.rear.rolling_radius - 1.0,
        "late": float(np.mean(draws.v_late)),
        "late_sigma": float(np.std(draws.v_late)),
        "ramp_ratio": float(np.mean(draws.log_pad_ratio)),
    }
