"""What the estimator remembers, and what a block makes of it: scalars, fixed memory.

    rolling   zeros of deceleration, eta and slip            a scalar Kalman filter each
    always    speed, offset and scale of a_x, slip           a Kalman filter: a_x carries the speed
                                                             on, the wheels and v measure it
    braking   d - d_0 = a u, u behind a lag of first order   level, its rate, lag: a Kalman filter
              means of z and eta - 1 that forget

d is the brake force that the deceleration demands, u that of the nominal pads, both over the
weight. Rolling resistance, bias of the accelerometer and pitch at rest need not be known: d_0 holds
them all. A zero ages while the car brakes, and lasts over the next stop. Without v the wheels alone
measure the speed: what they lose against a_x is slip, and as the car gets slow it is an error of
a_x.
"""

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Generic, NamedTuple, TypeVar

from calib.base.arrays import Array
from calib.base.names import G
from calib.estimation.constants import Constants

Number = TypeVar("Number", float, Array)
"""Of one block, or of each of many (k,)."""


class Sample(NamedTuple, Generic[Number]):
    """Means over a block, SI."""

    demand: Number  # brake force that the deceleration demands, over the weight [1]
    nominal: Number  # that of nominal pads [1]
    pressure: Number  # the higher one [Pa]
    z: Number
    eta: Number  # as read [1]
    rim: Number  # speed of the front wheels' rims [m/s]
    rear_share: Number  # of the load [1]
    v: Number  # [m/s], NaN where not logged
    disturbed: Number  # number of a `Reason` while the car is steered or a wheel locks, else 0
    log_odds: Number  # ln of the front pressure over the rear one
    driven: Number  # 1 while the accelerator is pressed: thrust and slip are no zeros


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
    innovation: Number  # of the wheels, in standard deviations; NaN where they do not count
    braked: Number  # time of this stop [s]
    zero_eta: Number  # as they stand [1]
    zero_slip: Number
    adds: Number  # 1 where the block adds to the means, else 0


@dataclass(slots=True)
class Zero:
    """What a signal reads while nothing brakes: a Gaussian that walks."""

    value: float
    variance: float

    def measured(self, x: float, variance: float) -> None:
        """Take in a reading with its variance."""
        gain = self.variance / (self.variance + variance)
        self.value += gain * (x - self.value)
        self.variance *= 1.0 - gain


Numbers = tuple[float, ...]
"""Of a Kalman filter: its states, then the upper half of their covariance, row by row."""


@dataclass(slots=True)
class State:
    """All that the estimator remembers."""

    demand: Zero
    eta: Zero
    slip: Zero
    level: Numbers  # of the pads [1], lag of the brakes [s], rate of the level [1/s]
    speed: Numbers = ()  # [m/s], ln(slip/z), offset and scale of a_x [1]
    anchored: bool = False  # once the speed no longer moves with the zero of eta
    waiting: deque[Sample[float]] = field(default_factory=deque)
    nominal: float = 0.0  # brake force of nominal pads over the weight [1]
    acting: float = 0.0  # the same behind the lag [1]
    by_lag: float = 0.0  # its slope by the lag [1/s]
    z: float = 0.0
    braked: float = 0.0  # time of this stop [s]
    released: float = 0.0  # [s]
    sums: Numbers = (0.0,) * 4  # that forget: of 1, of z and eta - 1 from their zeros, of z squared
    mean_z: float = 0.0
    # the best informed ratio and its change, their lower and upper bounds, variance by reading
    kept: Sequence[float] = (*(0.0,) * 2, *(-1e3,) * 2, *(1e3,) * 2, 0.0)
    age: float = 0.0  # of it [s]
    level_then: float = 1.0  # [1]


def started(c: Constants) -> State:
    """The state before the first block: radii of the car within 1 %, pads of any level."""
    demand, eta, slip = (Zero(x, c.zero**2) for x in (0.0, c.radii, 0.0))
    s = State(demand, eta, slip, level=(1.0, c.lag, *(0.0,) * 4, c.lag_sigma**2))
    _forget_stop(c, s)
    return s


def follow(c: Constants, s: State, x: Sample[float]) -> Seen[float]:
    """Take in a block. Changes the state."""
    dt, most = c.block, c.zero**2
    for zero, walk in ((s.demand, c.bias_walk), (s.eta, c.radius_walk), (s.slip, c.radius_walk)):
        variance = zero.variance + walk * walk * dt
        zero.variance = variance if variance < most else most
    braking, counts = x.pressure > c.bite, x.rim > c.moving and not x.disturbed
    _press(c, s, x.nominal)
    before = s.mean_z
    if braking:
        s.waiting.clear()
        s.braked += dt
        s.released = 0.0
        if counts:
            _brake(c, s, x)
    else:
        s.released += dt
        if s.braked > 0.0 and s.released > 1.0 + 0.5 * dt:
            _forget_stop(c, s)
        _roll(c, s, x, counts)
    _move(c, s, x, abs(s.mean_z - before), braking=braking)
    innovation = _see_speed(c, s, x, braking=braking) if counts else math.nan
    s.z = x.z
    level, _, _, level_variance, *_ = s.level
    blocks, _, shift, zz = s.sums
    n = blocks or 1.0
    v, log_slip, _, scale, _, _, _, _, ss, _, se, _, _, ee = s.speed
    return Seen(
        level, level_variance, blocks, s.mean_z, shift / n, zz / n,
        v, log_slip, scale, ss, se, ee, s.demand.variance, s.eta.variance,
        s.acting / x.nominal if braking else 1.0, innovation, s.braked,
        s.eta.value, s.slip.value, float(braking and counts),
    )  # fmt: skip


def _roll(c: Constants, s: State, x: Sample[float], counts: bool) -> None:
    """Zeros, from blocks that lie far enough before a bite."""
    if len(s.waiting) >= round(c.before_bite / c.block):
        old = s.waiting.popleft()
        wheels = c.noise_rim / old.rim
        s.demand.measured(old.demand, (c.noise_z**2 + 1e-8) / c.block)
        s.eta.measured(old.eta, 2.0 * wheels**2 / c.block)
        if old.v > c.moving:  # not where v is missing: NaN is not
            slip = 1.0 - _rim(s, old) / old.v
            s.slip.measured(slip, (wheels**2 + (c.noise_v / old.v) ** 2) / c.block)
    if counts and not x.driven and x.pressure < c.untouched and abs(x.z) < c.steady:
        s.waiting.append(x)
    else:
        s.waiting.clear()


def _rim(s: State, x: Sample[float]) -> float:
    """Speed of all wheels' rims [m/s], weighted by load, radii made equal."""
    return x.rim * (1.0 + x.rear_share * (x.eta / s.eta.value - 1.0))


def _forget_stop(c: Constants, s: State) -> None:
    """What is only of the last stop; the lag is the car's."""
    lag, variance = s.level[1], s.level[6]
    s.level = 1.0, lag, 0.0, c.level_sigma**2, 0.0, 0.0, variance, 0.0, c.fade**2
    s.braked, s.sums, s.mean_z = 0.0, (0.0,) * 4, 0.0


def _press(c: Constants, s: State, nominal: float) -> None:
    """Nominal brake force behind its lag, and its slope by the lag, exact for a straight rise."""
    dt, lag = c.block, max(s.level[1], c.least_lag)
    left = math.exp(-dt / lag)
    rate = (nominal - s.nominal) / dt
    behind = s.acting - s.nominal + lag * rate
    s.by_lag = -rate + (s.by_lag + rate) * left + behind * left * dt / lag**2
    s.acting = nominal - lag * rate + behind * left
    s.nominal = nominal


def _brake(c: Constants, s: State, x: Sample[float]) -> None:
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
        aa, pa = aa + jump / h**2, pa + jump / h
        keep *= spread / (spread + jump)
        spread += jump
    gain = 1.0 / spread
    off, ga, gl = gain * (y - a * h), gain * pa, gain * pl
    s.level = (
        a + off * pa, max(lag + off * pl, 0.0), rate + off * pr,
        aa - ga * pa, al - ga * pl, ar - ga * pr, ll - gl * pl, lr - gl * pr, rr - gain * pr * pr,
    )  # fmt: skip
    weight, z, shift, zz = s.sums
    weight, z = keep * weight + 1.0, keep * z + y
    s.sums = weight, z, keep * shift + x.eta / s.eta.value - 1.0, keep * zz + y * y
    s.mean_z = max(z / weight, c.least_mean_z)


def _move(c: Constants, s: State, x: Sample[float], bends: float, *, braking: bool) -> None:
    """The speed by a_x, until it is measured.

    ``bends`` by how much the mean deceleration changed [1].
    """
    if not s.anchored:  # radii that are made equal now would look like a speed that jumps
        s.speed = (
            _rim(s, x), 0.0, 0.0, c.scale,
            1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, c.offset**2, 0.0, c.scale_sigma**2,
        )  # fmt: skip
        s.anchored = braking or s.eta.variance < 0.5 * c.zero**2
    dt = c.block
    v, log_slip, o, e, vv, vs, vo, ve, ss, so, se, oo, oe, ee = s.speed
    lost = G * dt * (0.5 * (x.z + s.z) - o)
    scaled = 1.0 - e * braking
    v -= lost * scaled
    by_o, by_e = G * dt * scaled, lost * braking
    pv = vv + by_o * vo + by_e * ve
    vs += by_o * so + by_e * se
    vo += by_o * oo + by_e * oe
    ve += by_o * oe + by_e * ee
    vv = pv + by_o * vo + by_e * ve
    vv += (G * c.noise_z) ** 2 * dt + (G * c.apart * (x.z - s.z)) ** 2
    oo += c.grade_walk**2 * dt
    if s.braked > dt:
        ss += c.slip_walk**2 * dt + c.slip_bends * bends
    else:
        log_slip, vs, so, se, ss = c.log_slip, 0.0, 0.0, 0.0, c.log_slip_sigma**2
    s.speed = v, log_slip, o, e, vv, vs, vo, ve, ss, so, se, oo, oe, ee


def _see_speed(c: Constants, s: State, x: Sample[float], *, braking: bool) -> float:
    """The speed by the wheels and v; what does not fit is offset, scale and slip.

    Returns the innovation of the wheels.
    """
    dt, (v, log_slip, *_) = c.block, s.speed
    slip = max(x.demand - s.demand.value, 0.0) * math.exp(log_slip) if braking else 0.0
    rest, turned = _rim(s, x) - v * (1.0 - slip), 1.0 - slip
    variance = c.noise_rim**2 / dt + (c.slip_rough * slip * v) ** 2
    s.speed, innovation = measured(s.speed, turned, -v * slip, rest, variance)
    if x.v == x.v:
        v = s.speed[0]
        variance = (c.noise_v**2 + 1e-8) / dt + v**2 * s.slip.variance
        variance += (G * x.z * c.late_sigma) ** 2
        in_time = x.v - G * x.z * c.late
        rest = in_time * (1.0 - s.slip.value) - v
        s.speed, _ = measured(s.speed, 1.0, 0.0, rest, variance)
    return innovation


_SLIPS = (-8.0, 0.0)
"""Least and greatest ln(slip/z) of any tyre."""


def measured(x: Numbers, h: float, k: float, rest: float, variance: float) -> tuple[Numbers, float]:
    """`State.speed` with a reading of ``h`` v + ``k`` ln(slip/z), and its variance.

    ``rest`` is what is left of it over the prediction; second comes the same in standard
    deviations.
    """
    v, s, o, e, vv, vs, vo, ve, ss, so, se, oo, oe, ee = x
    pv, ps, po, pe = h * vv + k * vs, h * vs + k * ss, h * vo + k * so, h * ve + k * se
    gain = 1.0 / (h * pv + k * ps + variance)
    y, gv, gs, go = gain * rest, gain * pv, gain * ps, gain * po
    return (
        v + y * pv, min(max(s + y * ps, _SLIPS[0]), _SLIPS[1]), o + y * po, e + y * pe,
        vv - gv * pv, vs - gv * ps, vo - gv * po, ve - gv * pe,
        ss - gs * ps, so - gs * po, se - gs * pe,
        oo - go * po, oe - go * pe, ee - gain * pe * pe,
    ), rest * math.sqrt(gain)  # fmt: skip
