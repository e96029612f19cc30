"""The equations of a block, for Python and for C: `calib.ecu.translation` writes the latter.

    braking   d - d_0 = a u, u behind a lag of first order   level, its rate, lag: a Kalman filter
              means of z and eta - 1 that forget
    always    speed, offset and scale of a_x, slip           a Kalman filter: a_x carries the speed
                                                             on, the wheels and v measure it

d is the brake force that the deceleration demands, u that of the nominal pads, both over the
weight. Rolling resistance, bias of the accelerometer and pitch at rest need not be known: d_0 holds
them all. Without v the wheels alone measure the speed: what they lose against a_x is slip, and as
the car gets slow it is an error of a_x.
"""

import math
from typing import Generic, NamedTuple

import numpy as np

from calib.base.arrays import Array, Mask
from calib.base.names import G
from calib.estimation.reasons import Reason
from calib.estimation.state import (
    Check,
    Constants,
    LevelFilter,
    Number,
    Sample,
    SpeedFilter,
    State,
    Sums,
    Zero,
)


class BlockState(NamedTuple, Generic[Number]):
    """Estimate of brakes and tyres after a block."""

    level: Number  # of the pads [1], its variance
    level_variance: Number
    blocks: Number  # number in the means that forget; 0 before any braking
    z: Number  # means of z, eta - 1 from their zeros and of z squared [1]
    shift: Number
    z_squared: Number
    speed: Number  # [m/s]
    log_slip: Number  # ln(slip/z), scale of a_x [1], their covariance
    scale: Number
    slip_variance: Number
    slip_scale: Number
    scale_variance: Number
    demand_variance: Number  # of the zeros
    eta_variance: Number
    effective_pressure_share: Number  # share of the pressure that acts [1]
    innovation: Number  # of the wheels where they count, in standard deviations
    braked: Number  # time of this stop [s]
    zero_eta: Number  # as they stand [1]
    zero_slip: Number
    counts: Number  # 1 where the wheels tell the speed, else 0
    checks: Number  # `CHECKS` that fail or just did, one bit each


class SlipEvidence(NamedTuple):
    """Slip, one of what was measured and what the map has, and level, of blocks (k,)."""

    slip: Array  # how far ln(slip/z) is from that of the map, in its sigma
    slip_sigma: Array
    scaled: Array  # share of a_x that is deceleration [1], with the slip of the map
    pads: Array  # level at the pressure of now, with the lag [1]
    noise: Array  # variance of the level by noise
    accelerometer: Array  # and by a_x


def update_zero(zero: Zero, x: float, variance: float) -> None:
    """Update what a signal reads while nothing brakes by a reading with its variance."""
    gain = zero.variance / (zero.variance + variance)
    zero.value += gain * (x - zero.value)
    zero.variance *= 1.0 - gain


def zero_fits(c: Constants, s: State, demand: float, eta_less_1: float) -> bool:
    """Whether readings of a car that rolls are zeros that a car can have."""
    fits = abs(demand) < c.most_zero and abs(eta_less_1 - c.radii + 1.0) < c.most_radii
    s.check.refused = 0.0 if fits else s.check.refused + 1.0
    return fits


def shift(s: State, x: Sample[float]) -> float:
    """Eta over its zero, less 1."""
    return (x.eta_less_1 - s.eta_less_1.value) / (1.0 + s.eta_less_1.value)


def rim_speed(s: State, x: Sample[float]) -> float:
    """Speed of all wheels' rims [m/s], weighted by load, radii made equal."""
    return x.rim + x.rim * x.rear_share * shift(s, x)


def reset_stop(c: Constants, s: State) -> None:
    """Forget what is only of the last stop; the lag is the car's."""
    f: LevelFilter = s.level
    f.level, f.rate, f.var_level, f.var_rate = 1.0, 0.0, c.level_sigma**2, c.fade**2
    f.cov_level_lag, f.cov_level_rate, f.cov_lag_rate = 0.0, 0.0, 0.0
    s.sums.blocks, s.sums.z, s.sums.shift, s.sums.z_squared = 0.0, 0.0, 0.0, 0.0
    s.braked, s.mean_z = 0.0, 0.0
    e: Check = s.check
    off = s.speed.scale - c.scale
    if abs(off) > c.far * c.scale_sigma:  # what a fault that is gone has left, is learned again
        s.speed.var_scale = max(s.speed.var_scale, off**2)
    e.level, e.chatter, e.ratio, e.modulated, e.far = 1.0, 0.0, 0.0, 1e3, 1e3


def start(c: Constants, s: State) -> None:
    """Begin with radii of the car within 1 %, and with pads of any level."""
    s.demand.value, s.eta_less_1.value, s.slip.value = 0.0, c.radii - 1.0, 0.0
    s.demand.variance, s.eta_less_1.variance, s.slip.variance = c.zero**2, c.zero**2, c.zero**2
    s.level.lag, s.level.var_lag = c.lag, c.lag_sigma**2
    reset_stop(c, s)


def brake_line_lag(c: Constants, s: State, nominal: float) -> None:
    """Nominal brake force behind its lag, and its slope by the lag, exact for a straight rise."""
    dt, lag = c.block, max(s.level.lag, c.least_lag)
    decay = math.exp(-dt / lag)
    rate = (nominal - s.nominal) / dt
    behind = s.acting - s.nominal + lag * rate
    s.by_lag = -rate + (s.by_lag + rate) * decay + behind * decay * dt / lag**2
    s.acting = nominal - lag * rate + behind * decay
    s.nominal = nominal


def rough_force(c: Constants, s: State, x: Sample[float]) -> float:
    """Variance of a block's brake force by road, body and what the lag still holds back."""
    to_come = c.r_lag * s.level.level * (x.nominal - s.acting)
    return (c.r_level * (x.demand - s.demand.value)) ** 2 + to_come**2


def update_level(c: Constants, s: State, x: Sample[float]) -> None:
    """Level and lag by the brake force of a block; sums of what goes into the map."""
    f: LevelFilter = s.level
    sums: Sums = s.sums
    y, dt = x.demand - s.demand.value, c.block
    f.level += f.rate * dt
    f.var_level += dt * (2.0 * f.cov_level_rate + dt * f.var_rate) + (c.q_level * f.level) ** 2 * dt
    f.cov_level_lag += dt * f.cov_lag_rate
    f.cov_level_rate += dt * f.var_rate
    f.var_rate += (c.q_rate * f.level) ** 2 * dt
    h, k = s.acting, f.level * s.by_lag  # of the reading h level + k lag
    p_level = h * f.var_level + k * f.cov_level_lag
    p_lag = h * f.cov_level_lag + k * f.var_lag
    p_rate = h * f.cov_level_rate + k * f.cov_lag_rate
    spread = h * p_level + k * p_lag + c.noise_z**2 / dt + rough_force(c, s, x)
    residual = y - f.level * h
    nis = min(residual**2 / spread, c.most_chatter)
    s.check.chatter += (nis - s.check.chatter) * dt / c.chatter_memory
    jump = min(residual**2 - c.jump**2 * spread, (c.level_sigma * h) ** 2)
    keep = math.exp(-dt / c.memory)
    if jump > 0.0:  # pads that change at once: what no noise explains, and the means are of others
        f.var_level += jump / h**2
        p_level += jump / h
        keep *= spread / (spread + jump)
        spread += jump
    gain = 1.0 / spread
    step, g_level, g_lag = gain * residual, gain * p_level, gain * p_lag
    f.level += step * p_level
    f.lag = max(f.lag + step * p_lag, 0.0)
    f.rate += step * p_rate
    f.var_level -= g_level * p_level
    f.cov_level_lag -= g_level * p_lag
    f.cov_level_rate -= g_level * p_rate
    f.var_lag -= g_lag * p_lag
    f.cov_lag_rate -= g_lag * p_rate
    f.var_rate -= gain * p_rate * p_rate
    sums.blocks = keep * sums.blocks + 1.0
    sums.z = keep * sums.z + y
    sums.shift = keep * sums.shift + shift(s, x)
    sums.z_squared = keep * sums.z_squared + y * y
    s.mean_z = max(sums.z / sums.blocks, c.least_mean_z)


def update(
    c: Constants, s: State, h: float, k: float, residual: float, variance: float, mean: float
) -> float:
    """Update the speed's filter by a reading of ``h`` v + ``k`` ln(slip/z) with its variance.

    Return the ``residual`` in standard deviations. No tyre slips by more than z, or by less than
    1/3000 of it. ``mean`` of the residual if a_x errs by what the brakes do not explain.
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
    """Take the speed of the rims, with a_x as it usually is."""
    f: SpeedFilter = s.speed
    f.v, f.slip, f.offset, f.scale = 0.0, c.log_slip, 0.0, c.scale
    f.var_v, f.var_slip = 1.0, c.log_slip_sigma**2
    f.var_offset, f.var_scale = c.offset**2, c.scale_sigma**2
    f.cov_v_slip, f.cov_v_offset, f.cov_v_scale = 0.0, 0.0, 0.0
    f.cov_slip_offset, f.cov_slip_scale, f.cov_offset_scale = 0.0, 0.0, 0.0
    e: Check = s.check
    e.v, e.slip, e.offset, e.scale, e.error = 0.0, 0.0, 0.0, 0.0, 0.0


def unexplained(c: Constants, s: State, x: Sample[float]) -> float:
    """Brake force that pads as they were do not explain: theirs, or an error of a_x."""
    force = x.demand - s.demand.value - s.check.level * s.acting
    return force if abs(force) > c.unexplained else 0.0


def motor_fits(c: Constants, s: State, x: Sample[float], *, counts: bool) -> bool:
    """Whether a change of a motor's torque shows in the deceleration.

    If the torque is wrong, the demand, of which it is a part, changes by as much, and the brakes
    do not explain it.
    """
    f: LevelFilter = s.level
    e: Check = s.check
    y, h, k = x.demand - s.demand.value, s.acting, f.level * s.by_lag
    spread = h * (h * f.var_level + 2.0 * k * f.cov_level_lag) + k * k * f.var_lag
    spread += rough_force(c, s, x)
    spread += c.noise_z**2 / c.block + s.demand.variance
    step = x.drive - e.drive
    likely = step * (y - f.level * h - 0.5 * step)
    fits = not counts or abs(step) < c.unexplained or likely < c.errs * spread
    e.motor = e.motor + c.block if fits else 0.0
    e.drive += step * min(c.block / c.drive_memory, 1.0) if fits else 0.0
    return fits


def check_a_x(c: Constants, s: State) -> None:
    """Ask whether the brake force that is unexplained is an error of a_x, as the wheels tell.

    Once it is, it stays one until the force is explained again.
    """
    e: Check = s.check
    e.ratio -= e.ratio * c.block / c.usual_level if e.error == 0.0 else 0.0
    errs = e.ratio > c.errs or (e.a_x == 0.0 and e.error != 0.0)
    e.a_x = 0.0 if errs else e.a_x + c.block
    e.ratio = min(e.ratio, c.errs)
    if e.ratio <= 0.0:  # it begins again
        e.ratio, e.v, e.slip, e.offset, e.scale = 0.0, 0.0, 0.0, 0.0, 0.0
    if errs:  # what was learned of it is of no use
        s.demand.variance = c.zero**2
    s.anchored = s.anchored and not errs and e.motor > 0.0


def check_states(c: Constants, s: State, x: Sample[float], *, braking: bool, counts: bool) -> None:
    """Check innovations and states against what cars have; follow the level before a step."""
    e: Check = s.check
    y = x.demand - s.demand.value
    check_a_x(c, s)
    if braking and counts and e.a_x > 0.0:
        e.level += (s.level.level - e.level) * c.block / min(s.braked + c.block, c.usual_level)
    e.modulated = 0.0 if e.chatter > c.chatter else e.modulated + c.block
    beyond = y < c.least_demand or y > c.most_demand or abs(s.speed.offset) > c.far * c.offset
    beyond = beyond or abs(s.speed.scale - c.scale) > c.far_scale * c.scale_sigma
    beyond = beyond or s.speed.slip - c.log_slip > c.far_slip * c.log_slip_sigma
    e.far = 0.0 if beyond and counts else e.far + c.block


def predict(c: Constants, s: State, x: Sample[float], bends: float, *, braking: bool) -> None:
    """Predict the speed by a_x.

    ``bends`` is the change of the mean deceleration [1].
    """
    f: SpeedFilter = s.speed
    rims = rim_speed(s, x)
    if not s.anchored:  # radii that are made equal now would look like a speed that jumps
        reset_speed(c, s)
        s.rim = rims
        s.anchored = braking or s.eta_less_1.variance < 0.5 * c.zero**2
    dt = c.block
    lost = G * dt * (0.5 * (x.z + s.z) - f.offset)
    by_offset = G * dt * (1.0 - f.scale) if braking else G * dt
    by_scale = lost if braking else 0.0
    f.v += s.rim - rims
    f.v -= lost * (1.0 - f.scale) if braking else lost
    e: Check = s.check
    errs = unexplained(c, s, x)
    e.v += by_offset * e.offset + by_scale * e.scale - 0.5 * by_offset * (errs + e.error)
    e.error = errs
    s.rim = rims
    var_v = f.var_v + by_offset * f.cov_v_offset + by_scale * f.cov_v_scale
    f.cov_v_slip += by_offset * f.cov_slip_offset + by_scale * f.cov_slip_scale
    f.cov_v_offset += by_offset * f.var_offset + by_scale * f.cov_offset_scale
    f.cov_v_scale += by_offset * f.cov_offset_scale + by_scale * f.var_scale
    f.var_v = var_v + by_offset * f.cov_v_offset + by_scale * f.cov_v_scale
    f.var_v += (G * c.noise_z) ** 2 * dt + (G * c.apart * (x.z - s.z)) ** 2
    f.var_offset += c.q_grade**2 * dt
    if s.braked > dt:
        f.var_slip += c.q_slip**2 * dt + c.q_bends * bends
    else:
        f.slip, f.var_slip = c.log_slip, c.log_slip_sigma**2
        f.cov_v_slip, f.cov_slip_offset, f.cov_slip_scale = 0.0, 0.0, 0.0
        e.slip = 0.0


def update_wheels(c: Constants, s: State, x: Sample[float], *, braking: bool) -> None:
    """Update the speed by the wheels; what does not fit changes offset, scale and slip."""
    e: Check = s.check
    v, over = s.rim + s.speed.v, max(x.demand - s.demand.value, 0.0)
    slip = over * math.exp(s.speed.slip) if braking else 0.0
    variance = c.noise_rim**2 / c.block + (c.r_slip * slip * v) ** 2
    then = slip if over <= 0.0 else slip * max(1.0 - e.error / over, 0.0)  # if a_x errs
    then /= 1.0 + e.slip + 0.5 * e.slip**2  # is exp(e.slip), nearly
    mean = (v - e.v) * (1.0 - then) - v * (1.0 - slip)
    s.innovation = update(c, s, 1.0 - slip, -v * slip, v * slip - s.speed.v, variance, mean)


def step_filters(c: Constants, s: State, x: Sample[float], *, counts: bool) -> None:
    """Update the filters of brakes and speed by a block."""
    dt, braking, last_mean = c.block, x.pressure > c.bite, s.mean_z
    if braking:
        s.braked += dt
        s.released = 0.0
        if counts:
            update_level(c, s, x)
    else:
        s.released += dt
        if s.braked > 0.0 and s.released > 1.0 + 0.5 * dt:
            reset_stop(c, s)
    predict(c, s, x, abs(s.mean_z - last_mean), braking=braking)
    if counts:
        update_wheels(c, s, x, braking=braking)
    check_states(c, s, x, braking=braking, counts=counts)
    s.z = x.z


def failed_checks(c: Constants, s: State) -> float:
    """Bits of the checks that fail, or did just now, in the order of `CHECKS`."""
    e: Check = s.check
    bits = (1.0 if e.a_x < c.recover else 0.0) + (2.0 if e.motor < c.recover else 0.0)
    bits += (4.0 if e.modulated < c.recover else 0.0) + (8.0 if e.far < c.recover else 0.0)
    return bits + (16.0 if e.refused >= c.refusals else 0.0)


def block_state(c: Constants, s: State, x: Sample[float], *, counts: bool) -> BlockState[float]:
    """Return the estimate of brakes and tyres after a block."""
    f: SpeedFilter = s.speed
    n = s.sums.blocks if s.sums.blocks > 0.0 else 1.0
    return BlockState(
        s.level.level, s.level.var_level, s.sums.blocks, s.mean_z,
        s.sums.shift / n, s.sums.z_squared / n,
        s.rim + f.v, f.slip, f.scale, f.var_slip, f.cov_slip_scale, f.var_scale,
        s.demand.variance, s.eta_less_1.variance,
        s.acting / x.nominal if x.pressure > c.bite else 1.0, s.innovation, s.braked,
        1.0 + s.eta_less_1.value, s.slip.value, 1.0 if counts else 0.0,
        failed_checks(c, s),
    )  # fmt: skip


def held_variance(c: Constants, s: State, level: float) -> float:
    """Variance by which the held ratio grew: pads warm up, and those that changed did so unlike."""
    return c.ageing**2 * s.age + (c.unlike * math.log(level / s.level_then)) ** 2


def share_of(c: Constants, width: float, held_width: float) -> float:
    """Share of a reading [1] by how much narrower its ``width`` is than that of what it replaces.

    It grows from none to all: no last digit decides.
    """
    return min(max((held_width / width - 1.0) / c.narrower, 0.0), 1.0)


def reset_held(c: Constants, s: State, level: float, share: float) -> float:
    """Variance by which the held ratio grew, once it has its ``share`` of a reading."""
    s.age = (1.0 - share) * s.age
    s.level_then = (1.0 - share) * s.level_then + share * level
    return held_variance(c, s, level)


def slip_evidence(
    c: Constants, block: BlockState[Array], z: Array, by_map: Array, sigma: Array
) -> SlipEvidence:
    """Slip and level (k,); ``by_map`` is its ln(slip/z), with its ``sigma``.

    What the scale of a_x departs by from what its prior trusts may be another error, as of the
    wheels: the level is in doubt by as much.
    """
    variance, residual = block.slip_variance, by_map - block.log_slip
    gain = 1.0 / (variance + sigma**2)
    scale = block.scale + gain * block.slip_scale * residual
    doubt = np.maximum(np.abs(scale - c.scale) - c.trusted * c.scale_sigma, 0.0)
    scale_variance = np.maximum(block.scale_variance - gain * block.slip_scale**2, 0.0)
    steady = np.maximum(block.level, c.least_share)
    return SlipEvidence(
        -gain * sigma * residual,
        np.sqrt(gain * variance),
        np.maximum(1.0 - scale, c.least_share),
        steady * np.clip(block.effective_pressure_share, c.least_share, 1.0 / c.least_share),
        np.minimum(np.maximum(block.level_variance, 0.0) / steady**2, 1.0),
        block.demand_variance / z**2 + scale_variance + doubt**2,
    )


def eta_error(c: Constants, block: BlockState[Array], z: Array) -> Array:
    """Standard deviation of the mean of eta - 1 (k,) by wheels, zero and a changing z."""
    wheels = c.noise_rim / np.maximum(block.speed, 1.0)
    wheels = wheels / np.sqrt(c.block * np.maximum(block.blocks, 1.0))
    # a mean over decelerations that differ is not the curve at their mean
    nonlinearity = block.shift * np.maximum(block.z_squared / z**2 - 1.0, 0.0)
    return np.sqrt(wheels**2 + block.eta_variance + nonlinearity**2)


def reason_of(
    c: Constants, x: Sample[Array], block: BlockState[Array], level: Array, of_map: Mask
) -> Array:
    """The first `Reason` that applies to blocks (k,); ``level`` of the pads [1]."""
    why = np.where(of_map, Reason.VALID, Reason.BEYOND_MAP)
    why = np.where((level <= c.least_level) | (level >= c.most_level), Reason.NO_PAD, why)
    why = np.where(block.checks > 0.0, Reason.IMPLAUSIBLE, why)
    why = np.where(block.braked < c.settle - 0.5 * c.block, Reason.JUST_APPLIED, why)
    why = np.where(x.rim <= c.moving, Reason.SLOW, why)
    why = np.where(x.disturbed > 0.0, x.disturbed, why)  # the rims of locked wheels are slow
    return np.where(x.pressure <= c.least_pressure, Reason.NOT_BRAKED, why)
