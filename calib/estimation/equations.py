"""The equations of a block, in Python; `calib.ecu.translation` writes the same in C.

    while braking   level of the pads a, its rate, lag     a Kalman filter of d - d_0 = a u
                    means of z and eta - 1                 both forget
    always          speed, slip, offset and scale of a_x   a Kalman filter: a_x predicts the speed,
                                                           wheels and v measure it

d is the brake force that the deceleration demands, u that of the nominal pads behind a lag of first
order, both over the weight. d_0, the zero of d, is d while nothing brakes: rolling resistance, bias
of a_x, pitch at rest. y = d - d_0 is the brake force of a block. Without v only the wheels measure
the speed: a difference from a_x that remains at low speed is then an error of a_x, not slip.

In this order: zeros, resets, brakes, speed, checks; `step_filters` runs them on a block. At the end
is what reads the state for the maps. (S1) to (S16) are on `calib/manual/step.md`.
"""

import math
from typing import Generic, NamedTuple

import numpy as np

from calib.base.arrays import Array, Mask
from calib.estimation.constants import Constants
from calib.estimation.reasons import Reason
from calib.estimation.state import (
    Check,
    LevelFilter,
    Means,
    Number,
    Sample,
    SpeedFilter,
    State,
    Zero,
)


class BlockState(NamedTuple, Generic[Number]):
    """Estimate of brakes and tyres after a block."""

    level: Number  # level of the pads [1]
    level_variance: Number
    blocks: Number  # effective number of blocks in the means
    z: Number  # mean of y, the brake force over the weight [1]
    eta_rise: Number  # mean of eta over its zero, less 1 [1]
    z_squared: Number  # mean of y squared [1]
    speed: Number  # speed of the car [m/s]
    log_slip: Number  # ln(slip/z) [1]
    scale: Number  # relative excess of a_x while braking [1]
    slip_variance: Number  # variance of log_slip
    slip_scale: Number  # covariance of log_slip and scale
    scale_variance: Number  # variance of scale
    demand_variance: Number  # variance of the zero of the demand
    eta_variance: Number  # variance of the zero of eta
    eta_by_drive: Number  # mean of `Sample.eta_by_drive` [1]
    effective_pressure_share: Number  # share of the pressure that acts, the rest lags [1]
    innovation: Number  # innovation of the wheel speeds, in standard deviations
    braked: Number  # time of this stop [s]
    zero_eta: Number  # eta while nothing brakes [1]
    zero_slip: Number  # slip while nothing brakes [1]
    counts: Number  # 1 where the wheels measure the speed, else 0
    checks: Number  # `CHECKS` that fail or just did, one bit each


class SlipEvidence(NamedTuple):
    """Slip, by measurement and map together, and level of the pads, of blocks (k,)."""

    slip: Array  # ln(slip/z) less that of the map, over the sigma of the map
    slip_sigma: Array  # standard deviation of `slip`
    scaled: Array  # share of a_x that is deceleration [1]
    pads: Array  # level at the present pressure, with the lag [1]
    noise: Array  # variance of ln of the level by noise
    accelerometer: Array  # variance of ln of the level by a_x


def update_zero(zero: Zero, x: float, variance: float) -> None:
    """Update the zero of a signal by a reading ``x`` with its variance, (S3)."""
    gain = zero.variance / (zero.variance + variance)
    zero.value += gain * (x - zero.value)
    zero.variance *= 1.0 - gain


def widen_zeros(c: Constants, s: State) -> None:
    """Add the process noise of a block to the variances of the zeros of demand and eta."""
    s.demand.variance = min(s.demand.variance + c.walk_bias, c.var_zero)
    s.eta_less_1.variance = min(s.eta_less_1.variance + c.walk_radius, c.var_zero)


def take_zeros(c: Constants, s: State, demand: float, eta_less_1: float, rim: float) -> None:
    """Update the zeros of demand and eta by a rolling block; count refused blocks in a row."""
    of_demand: Zero = s.demand
    of_eta: Zero = s.eta_less_1
    s.check.refused += 1.0
    if abs(demand) < c.most_zero and abs(eta_less_1 - c.radii) < c.most_radii:
        update_zero(of_demand, demand, c.var_zero_z)
        update_zero(of_eta, eta_less_1, 2.0 * c.var_rim / rim**2)
        s.check.refused = 0.0


def rolls(c: Constants, s: State, x: Sample[float], *, counts: bool) -> bool:
    """Return whether the car rolls without brake, so that a block may show the zeros."""
    unbraked = counts and x.pressure < c.untouched
    steady = abs(x.z) < c.steady
    # a deceleration that neither brake nor known motor explains is a refused zero
    if unbraked and not steady and x.demand > c.most_zero:
        s.check.refused += 1.0
    return unbraked and steady


def eta_rise(s: State, x: Sample[float]) -> float:
    """Return eta over its zero, less 1 [1], (S4)."""
    return (x.eta_less_1 - s.eta_less_1.value) / (1.0 + s.eta_less_1.value)


def rim_speed(s: State, x: Sample[float]) -> float:
    """Return the speed of all rims [m/s], weighted by load, as if all radii were equal."""
    return x.rim + x.rim * x.rear_share * eta_rise(s, x)


def reset_stop(c: Constants, s: State) -> None:
    """Reset the states of a stop, but keep the lag of the brakes, which belongs to the car."""
    f: LevelFilter = s.level
    f.level, f.rate, f.var_level, f.var_rate = 1.0, 0.0, c.var_level, c.var_rate
    f.cov_level_lag, f.cov_level_rate, f.cov_lag_rate = 0.0, 0.0, 0.0
    s.means.blocks, s.means.z, s.means.eta_rise, s.means.z_squared = 0.0, 0.0, 0.0, 0.0
    s.means.eta_by_drive = 0.0
    s.braked, s.mean_z = 0.0, 0.0
    e: Check = s.check
    departure = s.speed.scale - c.scale
    if abs(departure) > c.far * c.scale_sigma:  # only a fault moves it so far: learn it again
        s.speed.var_scale = max(s.speed.var_scale, departure**2)
    e.level, e.chatter, e.ratio = 1.0, 0.0, 0.0


def start(c: Constants, s: State) -> None:
    """Set the state before any block: radii of the file within 1 %, any level of the pads."""
    s.eta_less_1.value, s.lag.value, s.level_then = c.radii, c.lag, 1.0
    s.demand.variance, s.eta_less_1.variance, s.lag.variance = c.var_zero, c.var_zero, c.var_lag
    reset_stop(c, s)


def brake_line_lag(c: Constants, s: State, nominal: float) -> None:
    """Update the force behind the lag and its derivative by the lag, (S5) for a linear rise."""
    dt, lag = c.block, max(s.lag.value, c.least_lag)
    # the solution of (S5) is u_a = u - lag rate + transient exp(-t/lag), for a constant rate of u
    decay = math.exp(-dt / lag)
    rate = (nominal - s.nominal) / dt
    transient = s.acting - s.nominal + lag * rate
    s.by_lag = -rate + (s.by_lag + rate) * decay + transient * decay * dt / lag**2
    s.acting = nominal - lag * rate + transient * decay
    s.nominal = nominal


def force_variance(c: Constants, s: State, x: Sample[float], y: float) -> float:
    """Return the innovation variance of brake force ``y``: by states, noise, road and lag, (S6)."""
    f: LevelFilter = s.level
    h, k = s.acting, f.level * s.by_lag  # derivatives of the force by level and lag
    rough, to_come = c.r_level * y, c.r_lag * f.level * (x.nominal - h)
    of_states = h * (h * f.var_level + 2.0 * k * f.cov_level_lag) + k * k * s.lag.variance
    return of_states + c.var_z + rough**2 + to_come**2


def update_level(c: Constants, s: State, x: Sample[float], y: float) -> None:
    """Update level and lag by the brake force ``y`` of a block, then the means for the map."""
    f: LevelFilter = s.level
    m: Means = s.means
    dt = c.block
    # predict: the level moves by its rate
    f.level += f.rate * dt
    f.var_level += dt * (2.0 * f.cov_level_rate + dt * f.var_rate)
    f.var_level += c.walk_level * f.level**2
    f.cov_level_lag += dt * f.cov_lag_rate
    f.cov_level_rate += dt * f.var_rate
    f.var_rate += c.walk_rate * f.level**2
    # covariances of the states with the force, which is h level + k lag
    h, k = s.acting, f.level * s.by_lag
    p_level = h * f.var_level + k * f.cov_level_lag
    p_lag = h * f.cov_level_lag + k * s.lag.variance
    p_rate = h * f.cov_level_rate + k * f.cov_lag_rate
    spread = force_variance(c, s, x, y)
    residual = y - f.level * h
    nis = min(residual**2 / spread, c.most_chatter)  # normalised innovation squared
    s.check.chatter += c.share_chatter * (nis - s.check.chatter)
    jump = min(residual**2 - c.jump**2 * spread, c.var_level * h**2)
    keep = c.keep
    if jump > 0.0:  # a step of the level: the means forget older blocks
        f.var_level += jump / h**2
        p_level += jump / h
        keep *= spread / (spread + jump)
        spread += jump
    # update: a state moves by its covariance with the force, over the variance of the residual
    gain = 1.0 / spread
    step, g_level, g_lag = gain * residual, gain * p_level, gain * p_lag
    f.level += step * p_level
    if s.checks == 0.0:  # the lag outlasts the stop: learn it from plausible blocks only
        s.lag.value = max(s.lag.value + step * p_lag, 0.0)
        s.lag.variance -= g_lag * p_lag
    f.rate += step * p_rate
    f.var_level -= g_level * p_level
    f.cov_level_lag -= g_level * p_lag
    f.cov_level_rate -= g_level * p_rate
    f.cov_lag_rate -= g_lag * p_rate
    f.var_rate -= gain * p_rate * p_rate
    m.blocks = keep * m.blocks + 1.0
    share = 1.0 / m.blocks
    m.z += share * (y - m.z)
    m.eta_rise += share * (eta_rise(s, x) - m.eta_rise)
    m.z_squared += share * (y * y - m.z_squared)
    m.eta_by_drive += share * (x.eta_by_drive - m.eta_by_drive)
    s.mean_z = max(m.z, c.least_mean_z)


def update(
    c: Constants, s: State, h: float, k: float, residual: float, variance: float, mean: float
) -> float:
    """Update the filter of the speed by a reading of ``h`` v + ``k`` ln(slip/z).

    Return the ``residual`` of the reading in standard deviations. ``mean`` is the residual to
    expect if the unexplained brake force is an error of a_x. The slip stays between z/3000 and z.
    """
    f: SpeedFilter = s.speed
    e: Check = s.check
    p_v = h * f.var_v + k * f.cov_v_slip
    p_slip = h * f.cov_v_slip + k * f.var_slip
    p_offset = h * f.cov_v_offset + k * f.cov_slip_offset
    p_scale = h * f.cov_v_scale + k * f.cov_slip_scale
    gain = 1.0 / (h * p_v + k * p_slip + variance)
    step, g_v, g_slip, g_offset = gain * residual, gain * p_v, gain * p_slip, gain * p_offset
    e.ratio += min(gain * mean * (residual - 0.5 * mean), c.most_evidence)
    e.v += g_v * mean
    e.slip += g_slip * mean
    e.offset += g_offset * mean
    e.scale += gain * p_scale * mean
    f.v += step * p_v
    f.slip = min(max(f.slip + step * p_slip, -8.0), 0.0)
    f.offset += step * p_offset
    f.scale += step * p_scale
    f.var_v -= g_v * p_v
    f.cov_v_slip -= g_v * p_slip
    f.cov_v_offset -= g_v * p_offset
    f.cov_v_scale -= g_v * p_scale
    f.var_slip -= g_slip * p_slip
    f.cov_slip_offset -= g_slip * p_offset
    f.cov_slip_scale -= g_slip * p_scale
    f.var_offset -= g_offset * p_offset
    f.cov_offset_scale -= g_offset * p_scale
    f.var_scale -= gain * p_scale * p_scale
    return residual * math.sqrt(gain)


def reset_speed(c: Constants, s: State) -> None:
    """Reset the speed to that of the rims, and slip, offset and scale to their priors."""
    f: SpeedFilter = s.speed
    f.v, f.slip, f.offset, f.scale = 0.0, c.log_slip, 0.0, c.scale
    f.var_v, f.var_slip, f.var_offset, f.var_scale = 1.0, c.var_log_slip, c.var_offset, c.var_scale
    f.cov_v_slip, f.cov_v_offset, f.cov_v_scale = 0.0, 0.0, 0.0
    f.cov_slip_offset, f.cov_slip_scale, f.cov_offset_scale = 0.0, 0.0, 0.0
    e: Check = s.check
    e.v, e.slip, e.offset, e.scale, e.error = 0.0, 0.0, 0.0, 0.0, 0.0


def motor_fits(c: Constants, s: State, x: Sample[float], *, counts: bool) -> bool:
    """Return whether a change of a motor's torque shows in the deceleration."""
    e: Check = s.check
    step, y = x.drive - e.drive, x.demand - s.demand.value
    # ln of the likelihood that y contains the step over that it does not, times the variance of y
    evidence = step * (y - s.level.level * s.acting - 0.5 * step)
    spread = force_variance(c, s, x, y) + s.demand.variance
    fits = not counts or abs(step) < c.unexplained or evidence < c.errs * spread
    e.failing = 2.0  # the bit of "motor_changed", the first check of a block
    if fits:
        e.failing = 0.0
        e.drive += step * c.share_drive
    return fits


def check_a_x(c: Constants, s: State) -> None:
    """Decide by the wheels whether an unexplained brake force is an error of a_x."""
    e: Check = s.check
    if e.error == 0.0:
        e.ratio -= c.share_level * e.ratio
    if e.ratio > c.errs:
        s.errs = True
    elif e.error == 0.0:  # the brakes explain the force again
        s.errs = False
    e.ratio = min(e.ratio, c.errs)
    if e.ratio <= 0.0:  # start anew
        e.ratio, e.v, e.slip, e.offset, e.scale = 0.0, 0.0, 0.0, 0.0, 0.0
    if s.errs:
        e.failing += 1.0  # the bit of "a_x_changed"
    if e.failing > 0.0:  # a_x or a motor: neither zero nor speed is known any longer
        s.demand.variance = c.var_zero
        s.anchored = False


def check_states(c: Constants, s: State, y: float, *, braking: bool, counts: bool) -> None:
    """Check innovations and states for plausibility; also average the level of the pads."""
    e: Check = s.check
    check_a_x(c, s)
    if braking and counts and not s.errs:  # the mean since the bite, later over `usual_level`
        e.level += (s.level.level - e.level) * c.block / min(s.braked + c.block, c.usual_level)
    if braking and e.chatter > c.chatter:
        e.failing += 4.0  # the bit of "modulated"
    if counts and (
        y < c.least_demand
        or y > c.most_demand
        or abs(s.speed.offset) > c.most_offset
        or abs(s.speed.scale - c.scale) > c.most_scale
        or s.speed.slip > c.most_log_slip
    ):
        e.failing += 8.0  # the bit of "far"
    e.since += c.block
    if e.failing > 0.0:
        e.failed, e.since = e.failing, 0.0
    s.checks = e.failed if e.since < c.recover else 0.0
    if e.refused >= c.refusals:
        s.checks += 16.0  # the bit of "no_zero"


def predict(
    c: Constants, s: State, x: Sample[float], y: float, bends: float, *, braking: bool
) -> None:
    """Predict the speed by a_x, (S7); ``bends`` is the change of the mean deceleration [1]."""
    f: SpeedFilter = s.speed
    rims = rim_speed(s, x)
    if not s.anchored:  # the speed of the rims jumps when the zero of eta is learned
        reset_speed(c, s)
        s.rim = rims
        if braking or s.eta_less_1.variance < 0.5 * c.var_zero:  # it is learned, or will not be
            s.anchored = True
    lost = c.speed * (0.5 * (x.z + s.z) - f.offset)  # by the block, but for the scale [m/s]
    by_offset, by_scale = c.speed, 0.0  # derivatives of the speed
    f.v += s.rim - rims - lost
    if braking:
        by_offset, by_scale = c.speed * (1.0 - f.scale), lost
        f.v += lost * f.scale
    e: Check = s.check
    error = y - e.level * s.acting  # of a_x, unless the pads changed
    error = error if abs(error) > c.unexplained else 0.0
    # predict the error of v, too: by those of offset and scale, and by the mean error of the block
    e.v += by_offset * e.offset + by_scale * e.scale - 0.5 * by_offset * (error + e.error)
    e.error = error
    s.rim = rims
    var_v = f.var_v + by_offset * f.cov_v_offset + by_scale * f.cov_v_scale
    f.cov_v_slip += by_offset * f.cov_slip_offset + by_scale * f.cov_slip_scale
    f.cov_v_offset += by_offset * f.var_offset + by_scale * f.cov_offset_scale
    f.cov_v_scale += by_offset * f.cov_offset_scale + by_scale * f.var_scale
    f.var_v = var_v + by_offset * f.cov_v_offset + by_scale * f.cov_v_scale
    f.var_v += c.var_v + c.var_apart * (x.z - s.z) ** 2
    f.var_offset += c.walk_grade
    if s.braked > c.block:
        f.var_slip += c.walk_slip + c.q_bends * bends
    else:  # the car rolls, or this is the first block of a stop: the slip is not known
        f.slip, f.var_slip = c.log_slip, c.var_log_slip
        f.cov_v_slip, f.cov_slip_offset, f.cov_slip_scale = 0.0, 0.0, 0.0
        e.slip = 0.0


def update_wheels(c: Constants, s: State, y: float, *, braking: bool) -> None:
    """Update speed, slip, offset and scale by the wheel speeds, (S8); ``y`` is the brake force."""
    e: Check = s.check
    v, per_force = s.rim + s.speed.v, 0.0
    if braking:
        per_force = math.exp(s.speed.slip)
    slip = per_force * max(y, 0.0)
    variance = c.var_rim + (c.r_slip * slip * v) ** 2
    slip_if_errs = per_force * max(y - e.error, 0.0)
    slip_if_errs /= 1.0 + e.slip + 0.5 * e.slip**2  # is exp(e.slip), nearly
    mean = (v - e.v) * (1.0 - slip_if_errs) - v * (1.0 - slip)
    s.innovation = update(c, s, 1.0 - slip, -v * slip, v * slip - s.speed.v, variance, mean)


def step_filters(c: Constants, s: State, x: Sample[float], *, counts: bool) -> None:
    """Update the filters of brakes and speed by a block."""
    dt, braking, last_mean = c.block, x.pressure > c.bite, s.mean_z
    y = x.demand - s.demand.value
    if braking:
        s.braked += dt
        s.released, s.share = 0.0, s.acting / x.nominal
        if counts:
            update_level(c, s, x, y)
    else:
        s.released += dt
        s.share = 1.0
        if s.braked > 0.0 and s.released > c.released:
            reset_stop(c, s)
            s.check.drive = x.drive  # after a stop the torque of the motor is believed again
    predict(c, s, x, y, abs(s.mean_z - last_mean), braking=braking)
    if counts:
        update_wheels(c, s, y, braking=braking)
    check_states(c, s, y, braking=braking, counts=counts)
    s.z = x.z


def block_state(s: State, *, counts: bool) -> BlockState[float]:
    """Return the estimate of brakes and tyres after a block."""
    return BlockState(
        s.level.level, s.level.var_level, s.means.blocks, s.mean_z, s.means.eta_rise,
        s.means.z_squared, s.rim + s.speed.v, s.speed.slip, s.speed.scale, s.speed.var_slip,
        s.speed.cov_slip_scale, s.speed.var_scale, s.demand.variance, s.eta_less_1.variance,
        s.means.eta_by_drive, s.share, s.innovation, s.braked, 1.0 + s.eta_less_1.value,
        s.zero_slip.value, 1.0 if counts else 0.0, s.checks,
    )  # fmt: skip


def held_variance(c: Constants, s: State, level: float) -> float:
    """Return the variance of a held ratio by its age and by the change of the level since."""
    return c.walk_held * s.age + (c.unlike * math.log(level / s.level_then)) ** 2


def share_of(c: Constants, width: float, held_width: float) -> float:
    """Return the weight of a reading, (S11): 0 if it is as wide as the held one, 1 if narrower."""
    return min(max((held_width / width - 1.0) / c.narrower, 0.0), 1.0)


def reset_held(c: Constants, s: State, level: float, share: float) -> float:
    """Move the held ratio's age and level to a reading by ``share``; return `held_variance`."""
    s.age = (1.0 - share) * s.age
    s.level_then = (1.0 - share) * s.level_then + share * level
    return held_variance(c, s, level)


def slip_evidence(
    c: Constants, s: BlockState[Array], z: Array, by_map: Array, sigma: Array
) -> SlipEvidence:
    """Update slip and scale by the map, whose ln(slip/z) is ``by_map`` with its ``sigma``, (k,).

    Where the scale of a_x departs from its prior, or the slip from the map, by more than is
    trusted, another fault may be the cause: the excess of the square adds to the variances.
    The slip of the result is (S9); its level has the lag (S13).
    """
    residual = by_map - s.log_slip
    doubt = np.maximum((s.scale - c.scale) ** 2 - c.trusted_scale, 0.0)
    variance = s.slip_variance + doubt * (s.slip_scale / s.scale_variance) ** 2
    doubt = residual**2 - c.trusted**2 * (variance + sigma**2)
    variance = variance + np.maximum(doubt, 0.0)
    gain = 1.0 / (variance + sigma**2)
    scale = s.scale + gain * s.slip_scale * residual
    doubt = np.maximum((scale - c.scale) ** 2 - c.trusted_scale, 0.0)
    scale_variance = np.maximum(s.scale_variance - gain * s.slip_scale**2, 0.0)
    no_lag = np.maximum(s.level, c.least_share)  # level without the lag
    return SlipEvidence(
        -gain * sigma * residual,
        np.sqrt(gain * variance),
        np.maximum(1.0 - scale, c.least_share),
        no_lag * np.clip(s.effective_pressure_share, c.least_share, c.most_share),
        np.minimum(np.maximum(s.level_variance, 0.0) / no_lag**2, 1.0),
        s.demand_variance / z**2 + scale_variance + doubt,
    )


def eta_error(c: Constants, s: BlockState[Array], z: Array) -> Array:
    """Return the standard deviation of the mean of eta - 1 (k,), by wheels, zero, z and road."""
    speed = np.maximum(s.speed, 1.0)
    wheels = c.var_rim / (np.maximum(s.blocks, 1.0) * speed * speed)
    # While z changes, late axle loads change the slips, and the means leave the curve eta(z).
    # Both errors grow with the variance of z in the means.
    var_z = np.maximum(s.z_squared - z * z, 0.0)
    slip, curved = np.exp(s.log_slip) * z, s.eta_rise / (z * z)
    unsteady = c.unsteady * var_z * (slip * slip + curved * curved * var_z)
    of_road = c.other_road * s.eta_by_drive  # known slips are those on the road of the ramp
    return np.sqrt(wheels + s.eta_variance + unsteady + of_road * of_road)


def reason_of(
    c: Constants, x: Sample[Array], s: BlockState[Array], level: Array, of_map: Mask
) -> Array:
    """Return the `Reason` of blocks (k,) by the pads' ``level`` [1]: the last line that applies."""
    why = np.where(of_map, Reason.VALID, Reason.BEYOND_MAP)
    why = np.where((level <= c.least_level) | (level >= c.most_level), Reason.NO_PAD, why)
    why = np.where(s.checks > 0.0, Reason.IMPLAUSIBLE, why)
    why = np.where(s.braked < c.applied, Reason.JUST_APPLIED, why)
    why = np.where(x.rim <= c.moving, Reason.SLOW, why)
    why = np.where(x.disturbed > 0.0, x.disturbed, why)  # the rims of locked wheels are slow
    return np.where(x.pressure <= c.least_pressure, Reason.NOT_BRAKED, why)
