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
from calib.estimation.constants import Constants
from calib.estimation.reasons import Reason
from calib.estimation.state import Number, Sample, State, Zero


class Seen(NamedTuple, Generic[Number]):
    """What is known of brakes and tyres once a block is taken in."""

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
    acts: Number  # share of the pressure that acts [1]
    innovation: Number  # of the wheels where they count, in standard deviations
    braked: Number  # time of this stop [s]
    zero_eta: Number  # as they stand [1]
    zero_slip: Number
    counts: Number  # 1 where the wheels tell the speed, else 0


class Weighed(NamedTuple):
    """Slip, one of what was measured and what the map has, and level, of blocks (k,)."""

    slip: Array  # how far ln(slip/z) is from that of the map, in its sigma
    slip_sigma: Array
    scaled: Array  # share of a_x that is deceleration [1]: what the slip was off, it was
    pads: Array  # level as it is now, of the pressure as it is now [1]
    noise: Array  # its variance
    accelerometer: Array  # and by a_x


def measure(zero: Zero, x: float, variance: float) -> None:
    """Take in a reading with its variance."""
    gain = zero.variance / (zero.variance + variance)
    zero.value += gain * (x - zero.value)
    zero.variance *= 1.0 - gain


def shift(s: State, x: Sample[float]) -> float:
    """Eta over its zero, less 1."""
    return (x.eta_less_1 - s.eta_less_1.value) / (1.0 + s.eta_less_1.value)


def rim(s: State, x: Sample[float]) -> float:
    """Speed of all wheels' rims [m/s], weighted by load, radii made equal."""
    return x.rim + x.rim * x.rear_share * shift(s, x)


def forget_stop(c: Constants, s: State) -> None:
    """What is only of the last stop; the lag is the car's."""
    lag, variance = s.level[1], s.level[6]
    s.level = 1.0, lag, 0.0, c.level_sigma**2, 0.0, 0.0, variance, 0.0, c.fade**2
    s.sums = 0.0, 0.0, 0.0, 0.0
    s.braked = 0.0
    s.mean_z = 0.0


def press(c: Constants, s: State, nominal: float) -> None:
    """Nominal brake force behind its lag, and its slope by the lag, exact for a straight rise."""
    dt, lag = c.block, max(s.level[1], c.least_lag)
    left = math.exp(-dt / lag)
    rate = (nominal - s.nominal) / dt
    behind = s.acting - s.nominal + lag * rate
    s.by_lag = -rate + (s.by_lag + rate) * left + behind * left * dt / lag**2
    s.acting = nominal - lag * rate + behind * left
    s.nominal = nominal


def brake(c: Constants, s: State, x: Sample[float]) -> None:
    """Level and lag; means of what goes into the map."""
    y, dt = x.demand - s.demand.value, c.block
    a, lag, rate, aa, al, ar, ll, lr, rr = s.level
    a += rate * dt
    aa += dt * (2.0 * ar + dt * rr) + (c.level_walk * a) ** 2 * dt
    al += dt * lr
    ar += dt * rr
    rr += (c.fade_walk * a) ** 2 * dt
    h, k = s.acting, a * s.by_lag
    pa, pl, pr = h * aa + k * al, h * al + k * ll, h * ar + k * lr
    rough = (c.level_rough * y) ** 2 + (c.lag_rough * a * (x.nominal - h)) ** 2
    spread = h * pa + k * pl + c.noise_z**2 / dt + rough
    jump = min((y - a * h) ** 2 - c.jump**2 * spread, (c.level_sigma * h) ** 2)
    keep = math.exp(-dt / c.memory)
    if jump > 0.0:  # pads that change at once: what no noise explains, and the means are of others
        aa += jump / h**2
        pa += jump / h
        keep *= spread / (spread + jump)
        spread += jump
    gain = 1.0 / spread
    off, ga, gl = gain * (y - a * h), gain * pa, gain * pl
    s.level = (
        a + off * pa, max(lag + off * pl, 0.0), rate + off * pr,
        aa - ga * pa, al - ga * pl, ar - ga * pr, ll - gl * pl, lr - gl * pr, rr - gain * pr * pr,
    )  # fmt: skip
    n, z, eta, zz = s.sums
    s.sums = keep * n + 1.0, keep * z + y, keep * eta + shift(s, x), keep * zz + y * y
    s.mean_z = max(s.sums[1] / s.sums[0], c.least_mean_z)


def observe(s: State, h: float, k: float, rest: float, variance: float) -> float:
    """Take in a reading of ``h`` v + ``k`` ln(slip/z), and its variance.

    ``rest`` is what is left of it over the prediction; it comes back in standard deviations. No
    tyre slips by more than z, or by less than 1/3000 of it.
    """
    v, log_slip, o, e, vv, vs, vo, ve, ss, so, se, oo, oe, ee = s.speed
    pv, ps, po, pe = h * vv + k * vs, h * vs + k * ss, h * vo + k * so, h * ve + k * se
    gain = 1.0 / (h * pv + k * ps + variance)
    y, gv, gs, go = gain * rest, gain * pv, gain * ps, gain * po
    s.speed = (
        v + y * pv, min(max(log_slip + y * ps, -8.0), 0.0), o + y * po, e + y * pe,
        vv - gv * pv, vs - gv * ps, vo - gv * po, ve - gv * pe,
        ss - gs * ps, so - gs * po, se - gs * pe,
        oo - go * po, oe - go * pe, ee - gain * pe * pe,
    )  # fmt: skip
    return rest * math.sqrt(gain)


def move(c: Constants, s: State, x: Sample[float], bends: float, *, braking: bool) -> None:
    """The speed by a_x, until it is measured.

    ``bends`` by how much the mean deceleration changed [1].
    """
    rims = rim(s, x)
    if not s.anchored:  # radii that are made equal now would look like a speed that jumps
        s.speed = (
            0.0, 0.0, 0.0, c.scale,
            1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, c.offset**2, 0.0, c.scale_sigma**2,
        )  # fmt: skip
        s.rim = rims
        s.anchored = braking or s.eta_less_1.variance < 0.5 * c.zero**2
    dt = c.block
    v, log_slip, o, e, vv, vs, vo, ve, ss, so, se, oo, oe, ee = s.speed  # v less rims
    lost = G * dt * (0.5 * (x.z + s.z) - o)
    by_o = G * dt * (1.0 - e) if braking else G * dt
    by_e = lost if braking else 0.0
    v += s.rim - rims
    v -= lost * (1.0 - e) if braking else lost
    s.rim = rims
    pv = vv + by_o * vo + by_e * ve
    vs += by_o * so + by_e * se
    vo += by_o * oo + by_e * oe
    ve += by_o * oe + by_e * ee
    vv = pv + by_o * vo + by_e * ve
    vv += (G * c.noise_z) ** 2 * dt + (G * c.apart * (x.z - s.z)) ** 2
    oo += c.grade_walk**2 * dt
    if s.braked > dt:
        ss += c.slip_walk**2 * dt + c.slip_bends * bends
        s.speed = v, log_slip, o, e, vv, vs, vo, ve, ss, so, se, oo, oe, ee
    else:
        ss = c.log_slip_sigma**2
        s.speed = v, c.log_slip, o, e, vv, 0.0, vo, ve, ss, 0.0, 0.0, oo, oe, ee


def see_rims(c: Constants, s: State, x: Sample[float], *, braking: bool) -> None:
    """The speed by the wheels; what does not fit is offset, scale and slip."""
    v, over = s.rim + s.speed[0], max(x.demand - s.demand.value, 0.0)
    slip = over * math.exp(s.speed[1]) if braking else 0.0
    variance = c.noise_rim**2 / c.block + (c.slip_rough * slip * v) ** 2
    s.innovation = observe(s, 1.0 - slip, -v * slip, v * slip - s.speed[0], variance)


def take_in(c: Constants, s: State, x: Sample[float], *, counts: bool) -> None:
    """What a block tells of brakes and speed."""
    dt, braking, before = c.block, x.pressure > c.bite, s.mean_z
    press(c, s, x.nominal)
    if braking:
        s.braked += dt
        s.released = 0.0
        if counts:
            brake(c, s, x)
    else:
        s.released += dt
        if s.braked > 0.0 and s.released > 1.0 + 0.5 * dt:
            forget_stop(c, s)
    move(c, s, x, abs(s.mean_z - before), braking=braking)
    if counts:
        see_rims(c, s, x, braking=braking)
    s.z = x.z


def seen_of(c: Constants, s: State, x: Sample[float], *, counts: bool) -> Seen[float]:
    """What is known of brakes and tyres."""
    level, _, _, level_variance, _, _, _, _, _ = s.level
    blocks, _, eta, zz = s.sums
    n = blocks if blocks > 0.0 else 1.0
    v, log_slip, _, scale, _, _, _, _, ss, _, se, _, _, ee = s.speed
    return Seen(
        level, level_variance, blocks, s.mean_z, eta / n, zz / n,
        s.rim + v, log_slip, scale, ss, se, ee, s.demand.variance, s.eta_less_1.variance,
        s.acting / x.nominal if x.pressure > c.bite else 1.0, s.innovation, s.braked,
        1.0 + s.eta_less_1.value, s.slip.value, 1.0 if counts else 0.0,
    )  # fmt: skip


def aged(c: Constants, s: State, level: float) -> float:
    """Variance of the kept ratio: pads warm up, and those that changed did so unlike."""
    return c.ageing**2 * s.age + (c.unlike * math.log(level / s.level_then)) ** 2


def share_of(c: Constants, width: float, known: float) -> float:
    """Share of a reading by how much narrower its ``width`` is than what is ``known`` [1].

    It grows from none to all: no last digit decides.
    """
    return min(max((known / width - 1.0) / c.narrower, 0.0), 1.0)


def renewed(c: Constants, s: State, level: float, share: float) -> float:
    """Variance of the kept ratio once it has its share of a reading."""
    s.age = (1.0 - share) * s.age
    s.level_then = (1.0 - share) * s.level_then + share * level
    return aged(c, s, level)


def weighed(c: Constants, seen: Seen[Array], z: Array, usual: Array, sigma: Array) -> Weighed:
    """Slip and level (k,); ``usual`` is ln(slip/z) by the map, with its ``sigma``."""
    known, rest = seen.slip_variance, usual - seen.log_slip
    gain = 1.0 / (known + sigma**2)
    scale_variance = np.maximum(seen.scale_variance - gain * seen.slip_scale**2, 0.0)
    steady = np.maximum(seen.level, c.least_share)
    return Weighed(
        -gain * sigma * rest,
        np.sqrt(gain * known),
        np.maximum(1.0 - seen.scale - gain * seen.slip_scale * rest, c.least_share),
        steady * np.clip(seen.acts, c.least_share, 1.0 / c.least_share),
        np.minimum(np.maximum(seen.level_variance, 0.0) / steady**2, 1.0),
        seen.demand_variance / z**2 + scale_variance,
    )


def eta_error(c: Constants, seen: Seen[Array], z: Array) -> Array:
    """Standard deviation of the mean of eta - 1 (k,) by wheels, zero and a changing z."""
    wheels = c.noise_rim / np.maximum(seen.speed, 1.0)
    wheels = wheels / np.sqrt(c.block * np.maximum(seen.blocks, 1.0))
    # a mean over decelerations that differ is not the curve at their mean
    bent = seen.shift * np.maximum(seen.z_squared / z**2 - 1.0, 0.0)
    return np.sqrt(wheels**2 + seen.eta_variance + bent**2)


def reason_of(
    c: Constants, x: Sample[Array], seen: Seen[Array], level: Array, of_map: Mask
) -> Array:
    """The first `Reason` that applies to blocks (k,); ``level`` of the pads [1]."""
    why = np.where(of_map, Reason.VALID, Reason.BEYOND_MAP)
    why = np.where((level <= c.least_level) | (level >= c.most_level), Reason.NO_PAD, why)
    why = np.where(seen.braked < c.settle - 0.5 * c.block, Reason.JUST_APPLIED, why)
    why = np.where(x.rim <= c.moving, Reason.SLOW, why)
    why = np.where(x.disturbed > 0.0, x.disturbed, why)  # the rims of locked wheels are slow
    return np.where(x.pressure <= c.least_pressure, Reason.NOT_BRAKED, why)
