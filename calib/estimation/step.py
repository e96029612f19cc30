r"""The estimator of the table: one step for each block of 50 ms, causal, with fixed memory.

    rolling   zeros of deceleration, eta and slip            a scalar Kalman filter each
    always    speed, offset and scale of a_x, slip           a Kalman filter: a_x carries the speed
                                                             on, the wheels and v measure it
    braking   d - d_0 = a u, u behind a lag of first order   level, its rate, lag: a Kalman filter
              means of z and eta - 1 that forget  -> map     ln of the pads' ratio, given the slip
    answer    level and ratio, each with 95 % bounds

d is the brake force that the deceleration demands, u that of the nominal pads, both over the
weight. Rolling resistance, bias of the accelerometer and pitch at rest need not be known: d_0 holds
them all. A zero ages while the car brakes, and lasts over the next stop. Without v the wheels alone
measure the speed: what they lose against a_x is slip, and as the car gets slow it is an error of
a_x. The best informed answer is kept; it ages as pads that warm up do. `valid` says that the model
holds, not that the interval is narrow.
"""

import math
from bisect import bisect_right
from collections import deque
from dataclasses import dataclass, field
from enum import IntEnum
from operator import mul
from typing import NamedTuple

import numpy as np

from calib.base.intervals import Z95
from calib.base.names import G
from calib.car.braking import BITE, MOVING
from calib.estimation.gates import Gates
from calib.run.driving_record import STEADY
from calib.run.noise import WALK
from calib.table.maps import Map


class Reason(IntEnum):
    """Why an answer does not stand; 0 for one that does. The first that applies."""

    VALID = 0
    NOT_BRAKED = 1
    SLOW = 2
    JUST_APPLIED = 3
    DISTURBED = 4
    NO_ZERO = 5
    BEYOND_MAP = 6


class Sample(NamedTuple):
    """Means over a block, SI.

    ``demand`` brake force that the deceleration ``z`` demands, ``nominal`` that of nominal pads,
    over the weight [1]; ``pressure`` [Pa]; ``eta`` [1] as read; ``rim`` speed of the front wheels'
    rims [m/s]; ``rear_share`` of the load [1]; ``v`` [m/s], NaN where not logged; ``disturbed``
    while a wheel locks or the car corners; ``log_odds`` ln of the front pressure over the rear one.
    """

    demand: float
    nominal: float
    pressure: float
    z: float
    eta: float
    rim: float
    rear_share: float
    v: float
    disturbed: bool
    log_odds: float = 0.0


class Reader:
    """A map read between its cells, held at its ends; one point at a time."""

    def __init__(self, m: Map, columns: tuple[str, ...]) -> None:
        self.axes = [axis.tolist() for axis in m.axes.values()]
        self.cells = np.stack([m.grid(name) for name in columns], axis=-1).tolist()

    def cell(self, axis: int, x: float) -> float:
        """Width of the cell of an axis in which ``x`` lies."""
        points = self.axes[axis]
        i, _ = _place(points, x)
        return float(points[i + 1] - points[i])

    def __call__(self, z: float) -> list[float]:
        """All columns of a map over z alone."""
        i, w = _place(self.axes[0], z)
        return _between(self.cells[i], self.cells[i + 1], w)

    def at(self, z: float) -> "Plane":
        """The map at one deceleration, over its other two axes."""
        return Plane(self, *_place(self.axes[0], z))


class Plane:
    """A map of three axes at one value of the first, which many points share."""

    def __init__(self, reader: Reader, i: int, w: float) -> None:
        self.axes = reader.axes[1:]
        self.low, self.high, self.w = reader.cells[i], reader.cells[i + 1], w
        self.corners: dict[tuple[int, int], list[float]] = {}

    def _corner(self, j: int, k: int) -> list[float]:
        if (j, k) not in self.corners:
            self.corners[j, k] = _between(self.low[j][k], self.high[j][k], self.w)
        return self.corners[j, k]

    def __call__(self, shift: float, slip: float) -> list[float]:
        """All columns at a point, linear along each axis."""
        (j, u), (k, v) = _place(self.axes[0], shift), _place(self.axes[1], slip)
        corners = [self._corner(*one) for one in ((j, k), (j, k + 1), (j + 1, k), (j + 1, k + 1))]
        a, b, c, d = (1.0 - u) * (1.0 - v), (1.0 - u) * v, u * (1.0 - v), u * v
        return [a * p + b * q + c * r + d * s for p, q, r, s in zip(*corners, strict=True)]


def _place(axis: list[float], x: float) -> tuple[int, float]:
    """Cell of an axis in which ``x`` lies, and where in it, 0 to 1; held at the ends."""
    i = min(max(bisect_right(axis, x) - 1, 0), len(axis) - 2)
    return i, min(max((x - axis[i]) / (axis[i + 1] - axis[i]), 0.0), 1.0)


def _between(low: list[float], high: list[float], w: float) -> list[float]:
    return [a + w * (b - a) for a, b in zip(low, high, strict=True)]


@dataclass(frozen=True)
class Constants:
    """What the step takes from a table, and its tuned numbers.

    ``late`` time by which v comes after the wheel speeds [s], with its sigma; ``ramp_ratio`` ln of
    the pads' ratio on the ramp [1].
    """

    ratio: Reader
    level: Reader
    noise_omega: float
    noise_z: float
    noise_v: float
    radius: float
    late: float
    late_sigma: float
    ramp_ratio: float
    block: float
    memory: float = 0.3  # of the means that go into the map [s]
    before_bite: float = 0.1  # time that no zero rests on [s]: pads may touch
    untouched: float = 7e4  # pressure up to which they do not [Pa]
    settle: float = Gates.settle  # time of braking before an answer stands [s]
    least_pressure: float = Gates.pressure  # [Pa]
    least_z: float = 0.05  # below it eta says nothing [1]
    level_sigma: float = 0.4  # of a level before any braking [1]
    level_walk: float = 0.01  # [1/sqrt(s)]
    fade: float = 0.06  # sigma of the rate at which the level changes [1/s], and its walk
    fade_walk: float = 0.02
    level_rough: float = 0.007  # of a block, relative: road and body
    lag: float = 0.03  # time constant of the brakes [s], and its sigma
    lag_sigma: float = 0.04
    least_lag: float = 0.004
    apart: float = 0.02  # of the clocks of a_x and speeds [s]
    zero: float = 0.01  # sigma of a zero before any rolling [1]
    offset: float = 0.03  # sigma of bias and slope together before any rolling [1]
    bias_walk: float = 1e-4  # of a_x as it warms up [1/sqrt(s)]
    grade_walk: float = 0.001  # of bias and slope [1/sqrt(s)]
    scale: float = 0.009  # a_x reads too much while braking, scale and pitch; and its sigma
    scale_sigma: float = 0.01
    ageing: float = 0.01  # of a kept ratio [1/sqrt(s)]
    unlike: float = 0.5  # how far pads change apart that change together, sigma [1]
    slip_rough: float = 0.04  # of the slip of a block, relative
    log_slip: float = -3.2  # ln(slip/z) before any braking, 0.04, and its sigma [1]
    log_slip_sigma: float = 0.7
    slip_walk: float = 0.03  # of ln(slip/z) [1/sqrt(s)]
    slip_bends: float = 0.1  # its variance per deceleration that changes [1]: tyres are no lines


@dataclass
class Zero:
    """What a signal reads while nothing brakes: a Gaussian that walks."""

    value: float
    variance: float

    def measured(self, x: float, variance: float) -> None:
        """Take in a reading with its variance."""
        gain = self.variance / (self.variance + variance)
        self.value += gain * (x - self.value)
        self.variance *= 1.0 - gain


@dataclass
class Gaussian:
    """Mean (n,) and covariance (n, n)."""

    x: list[float]
    P: list[list[float]]

    def measured(self, y: float, H: list[float], variance: float) -> float:
        """Take in a reading of ``H`` x, and return what it is off by, in standard deviations.

        ``y`` is what is left of it over the prediction.
        """
        PH = [sum(map(mul, row, H)) for row in self.P]
        gain = 1.0 / (sum(map(mul, H, PH)) + variance)
        self.x = [x + gain * p * y for x, p in zip(self.x, PH, strict=True)]
        self.P = [
            [old - gain * p * q for old, q in zip(row, PH, strict=True)]
            for row, p in zip(self.P, PH, strict=True)
        ]
        return y * math.sqrt(gain)


class Answer(NamedTuple):
    """Level and ratio, each ln with 95 % bounds; ``change`` of the ratio since the ramp.

    ``noise``, ``accelerometer`` variance of the level by sensors, ``zeros`` of the ratio by what is
    read. ``slip`` ln(slip/z) with its ``slip_sigma``; ``innovation`` how far the wheels were from
    the speed that was carried on, in standard deviations, NaN where they do not count.
    """

    level: float
    level_lower: float
    level_upper: float
    ratio: float
    ratio_lower: float
    ratio_upper: float
    change: float
    change_lower: float
    change_upper: float
    noise: float
    accelerometer: float
    zeros: float
    lag: float
    slip: float
    slip_sigma: float
    innovation: float
    reason: Reason


@dataclass
class State:
    """All that the estimator remembers.

    ``motion`` speed [m/s], offset and scale of a_x [1], ln(slip/z); ``level`` level, lag [s] and
    rate of the level [1/s]; ``sums`` weight and weighted sums of z, eta - 1 and z^2.
    """

    demand: Zero
    eta: Zero
    slip: Zero
    level: Gaussian
    motion: Gaussian | None = None
    anchored: bool = False
    waiting: deque[Sample] = field(default_factory=deque)
    nominal: float = 0.0
    acting: float = 0.0
    by_lag: float = 0.0
    z: float = 0.0
    mean_z: float = 0.0
    braked: float = 0.0
    released: float = 0.0
    sums: list[float] = field(default_factory=lambda: [0.0] * 4)
    best: list[float] | None = None
    held: Answer | None = None
    age: float = 0.0
    level_then: float = 1.0


def started(c: Constants) -> State:
    """The state before the first block: radii within 1 %, pads of any level."""
    return State(
        demand=Zero(0.0, c.zero**2),
        eta=Zero(1.0, c.zero**2),
        slip=Zero(0.0, c.zero**2),
        level=_level_before(c, c.lag, c.lag_sigma**2),
    )


def _level_before(c: Constants, lag: float, variance: float) -> Gaussian:
    """Level, lag and rate of the level before a braking."""
    sigmas = (c.level_sigma**2, variance, c.fade**2)
    return Gaussian(
        [1.0, lag, 0.0], [[x * (i == k) for k in range(3)] for i, x in enumerate(sigmas)]
    )


def step(c: Constants, s: State, x: Sample) -> Answer:
    """Take in a block, and answer. Changes the state."""
    for zero, walk in ((s.demand, c.bias_walk), (s.eta, WALK), (s.slip, WALK)):
        zero.variance = min(zero.variance + walk**2 * c.block, c.zero**2)
    braking = x.pressure > BITE
    _follow(c, s, x.nominal)
    if braking:
        s.waiting.clear()
        s.braked += c.block
        s.released = 0.0
        _brake(c, s, x)
    else:
        s.released += c.block
        if s.braked > 0.0 and s.released > 1.0 + 0.5 * c.block:
            _forget_stop(c, s)
        _roll(c, s, x)
    innovation = _move(c, s, x, braking)
    s.z = x.z
    if s.held is None or braking:
        s.held = _answer(c, s, x)
    return s.held._replace(innovation=innovation, reason=_reason(c, s, x))


def _means(s: State) -> tuple[float, float]:
    """Demanded brake force over the weight and eta - 1, means that forget, from the zeros."""
    weight, z, shift, _ = s.sums
    return (max(z / weight, 0.01), shift / weight) if weight > 0.0 else (0.1, 0.0)


def _roll(c: Constants, s: State, x: Sample) -> None:
    """Zeros, from blocks that lie far enough before a bite."""
    if len(s.waiting) >= round(c.before_bite / c.block):
        old = s.waiting.popleft()
        wheels = c.noise_omega * c.radius / old.rim
        s.demand.measured(old.demand, (c.noise_z**2 + 1e-8) / c.block)
        s.eta.measured(old.eta, 2.0 * wheels**2 / c.block)
        if old.v > MOVING:  # not where v is missing: NaN is not
            slip = 1.0 - _rim(s, old) / old.v
            s.slip.measured(slip, (wheels**2 + (c.noise_v / old.v) ** 2) / c.block)
    free = x.pressure < c.untouched and abs(x.z) < STEADY
    if free and x.rim > MOVING and not x.disturbed:
        s.waiting.append(x)
    else:
        s.waiting.clear()


def _rim(s: State, x: Sample) -> float:
    """Speed of all wheels' rims [m/s], weighted by load, radii made equal."""
    return x.rim * (1.0 + x.rear_share * (x.eta / s.eta.value - 1.0))


def _forget_stop(c: Constants, s: State) -> None:
    """What is only of the last stop; the lag is the car's."""
    s.level = _level_before(c, s.level.x[1], s.level.P[1][1])
    s.braked, s.best, s.held, s.sums = 0.0, None, None, [0.0] * 4


def _follow(c: Constants, s: State, nominal: float) -> None:
    """Nominal brake force behind its lag, and its slope by the lag, exact for a straight rise."""
    lag = max(s.level.x[1], c.least_lag)
    left = math.exp(-c.block / lag)
    rate = (nominal - s.nominal) / c.block
    behind = s.acting - s.nominal + lag * rate
    s.by_lag = -rate + (s.by_lag + rate) * left + behind * left * c.block / lag**2
    s.acting = nominal - lag * rate + behind * left
    s.nominal = nominal


def _brake(c: Constants, s: State, x: Sample) -> None:
    """Level and lag; means of what goes into the map."""
    if x.disturbed or x.rim <= MOVING:
        return
    level, y = s.level, x.demand - s.demand.value
    dt, P = c.block, level.P
    level.x[0] += level.x[2] * dt
    P[0][0] += dt * (2.0 * P[0][2] + dt * P[2][2]) + (c.level_walk * level.x[0]) ** 2 * dt
    P[0][1] = P[1][0] = P[0][1] + dt * P[1][2]
    P[0][2] = P[2][0] = P[0][2] + dt * P[2][2]
    P[2][2] += (c.fade_walk * level.x[0]) ** 2 * dt
    a = level.x[0]
    H = [s.acting, a * s.by_lag, 0.0]
    level.measured(y - a * s.acting, H, c.noise_z**2 / c.block + (c.level_rough * y) ** 2)
    level.x[1] = max(level.x[1], 0.0)
    keep = math.exp(-c.block / c.memory)
    new = (1.0, y, x.eta / s.eta.value - 1.0, y * y)
    s.sums = [keep * old + one for old, one in zip(s.sums, new, strict=True)]


def _move(c: Constants, s: State, x: Sample, braking: bool) -> float:
    """Speed by a_x, measured by the wheels and v; what does not fit is offset, scale and slip.

    Returns the innovation of the wheels.
    """
    if not s.anchored:  # radii that are made equal now would look like a speed that jumps
        P = [[0.0] * 4 for _ in range(4)]
        P[0][0], P[1][1], P[2][2] = 1.0, c.offset**2, c.scale_sigma**2
        s.motion = Gaussian([_rim(s, x), 0.0, c.scale, 0.0], P)
        s.anchored = braking or s.eta.variance < 0.5 * c.zero**2
    assert s.motion is not None
    m, dt = s.motion, c.block
    z, (mean_z, _) = 0.5 * (x.z + s.z), _means(s)
    v, o, e, slip = m.x
    k = 1.0 - e * braking
    v -= G * k * (z - o) * dt
    m.x[0] = v
    to_v = [1.0, G * k * dt, G * (z - o) * dt * braking, 0.0]
    PF = [sum(map(mul, row, to_v)) for row in m.P]
    m.P[0] = [sum(map(mul, to_v, PF)), *PF[1:]]
    for i in (1, 2, 3):
        m.P[i][0] = PF[i]
    m.P[0][0] += (G * c.noise_z) ** 2 * dt + (G * c.apart * (x.z - s.z)) ** 2
    m.P[1][1] += c.grade_walk**2 * dt
    m.P[3][3] += c.slip_walk**2 * dt + c.slip_bends * abs(mean_z - s.mean_z)
    s.mean_z = mean_z
    if s.braked <= dt:
        m.x[3] = slip = c.log_slip
        for i in (0, 1, 2):
            m.P[3][i] = m.P[i][3] = 0.0
        m.P[3][3] = c.log_slip_sigma**2
    if x.disturbed or x.rim <= MOVING:
        return math.nan
    slip = max(x.demand - s.demand.value, 0.0) * math.exp(slip) if braking else 0.0
    rest, variance = _rim(s, x) - v * (1.0 - slip), (c.noise_omega * c.radius) ** 2 / dt
    variance += (c.slip_rough * slip * v) ** 2
    innovation = m.measured(rest, [1.0 - slip, 0.0, 0.0, -v * slip], variance)
    m.x[3] = min(max(m.x[3], _SLIPS[0]), _SLIPS[1])
    if x.v == x.v:
        v = m.x[0]
        variance = (c.noise_v**2 + 1e-8) / dt + v**2 * s.slip.variance
        variance += (G * x.z * c.late_sigma) ** 2
        in_time = x.v - G * x.z * c.late
        m.measured(in_time * (1.0 - s.slip.value) - v, [1.0, 0.0, 0.0, 0.0], variance)
    return innovation


def _with_map(m: Gaussian, read: list[float]) -> tuple[float, float, float, float]:
    """Scale of a_x and ln(slip/z), each with its variance, with what the map says of the slip."""
    prior, sigma = read[SLIP], read[SLIP + 1]
    both = [row[3] for row in m.P]
    gain, rest = 1.0 / (both[3] + sigma**2), prior - m.x[3]
    e, ee = m.x[2] + gain * both[2] * rest, max(m.P[2][2] - gain * both[2] ** 2, 0.0)
    return e, ee, m.x[3] + gain * both[3] * rest, max(m.P[3][3] - gain * both[3] ** 2, 0.0)


_LEAST = 0.02
"""Level, or share of the pressure that acts, below which there is none [1]."""

_SLIPS = (-8.0, 0.0)
"""Least and greatest ln(slip/z) of any tyre."""

LEVEL = ("level", "level_lower", "level_upper")
PADS = ("ratio", "ratio_lower", "ratio_upper", "change", "change_lower", "change_upper")
COLUMNS = (*PADS, "log_slip", "log_slip_sigma")
SLIP = COLUMNS.index("log_slip")


def _answer(c: Constants, s: State, x: Sample) -> Answer:
    # friction as it is now, of the pressure as it is now
    acts = s.acting / x.nominal if x.pressure > BITE else 1.0
    steady = max(s.level.x[0], _LEAST)
    a = steady * min(max(acts, _LEAST), 1.0 / _LEAST)
    z, shift = _means(s)
    before = c.level(z)
    here = c.ratio.at(z)
    read = here(shift / z, 0.0)
    assert s.motion is not None
    e, ee, log_slip, left = _with_map(s.motion, read)
    noise = min(max(s.level.P[0][0], 0.0) / steady**2, 1.0)
    accelerometer = s.demand.variance / z**2 + ee
    noisy = Z95 * math.sqrt(noise + accelerometer)
    level = math.log(a * max(1.0 - e, _LEAST)) + before[0]
    down, up = math.hypot(before[0] - before[1], noisy), math.hypot(before[2] - before[0], noisy)
    apart = ((log_slip - read[SLIP]) / read[SLIP + 1], math.sqrt(left) / read[SLIP + 1])
    now = _ratio(c, s, here, (z, shift), apart, before[len(LEVEL) :])
    # the map has the ratio of the brake forces, about the pressures that the axles had on the ramp
    moved = x.log_odds - (before[len(LEVEL)] - c.ramp_ratio)
    open_share = (now[1] + now[2]) / (before[len(LEVEL) + 2] - before[len(LEVEL) + 1])
    now[0] += open_share**2 * moved - x.log_odds
    if s.best is None or now[1] + now[2] <= sum(_aged(c, s, a)[1:3]):
        s.best, s.age, s.level_then = now, 0.0, a
    ratio, below, above, change, change_below, change_above, zeros = _aged(c, s, a)
    s.age += c.block
    return Answer(
        level, level - down, level + up,
        ratio, ratio - below, ratio + above,
        change, change - change_below, change + change_above,
        noise, accelerometer, zeros, s.level.x[1],
        log_slip, math.sqrt(left), math.nan, Reason.VALID,
    )  # fmt: skip


def _aged(c: Constants, s: State, level: float) -> list[float]:
    """The kept ratio as it is known now: pads warm up, and those that changed did so unlike."""
    assert s.best is not None
    changed = c.unlike * math.log(max(level, _LEAST) / max(s.level_then, _LEAST))
    variance = c.ageing**2 * s.age + changed**2
    more = Z95 * math.sqrt(variance)
    ratio, below, above, change, change_below, change_above, zeros = s.best
    return [
        ratio,
        math.hypot(below, more),
        math.hypot(above, more),
        change,
        math.hypot(change_below, more),
        math.hypot(change_above, more),
        zeros + variance,
    ]


def _ratio(
    c: Constants,
    s: State,
    here: Plane,
    mean: tuple[float, float],
    slip: tuple[float, float],
    before: list[float],
) -> list[float]:
    """ln of the ratio with the distances of its bounds, then the same of its change.

    ``here`` the map at the mean z; ``mean`` of z and eta - 1; ``slip`` and its sigma, along the
    axis of the map.
    """
    (z, shift), prior = mean, _around(before)
    weight = s.sums[0]
    assert s.motion is not None
    if not weight or z < c.least_z:
        return prior
    at = shift / z
    if not _on_map(c, s):
        return prior
    noise = c.noise_omega * c.radius / max(s.motion.x[0], 1.0) / math.sqrt(2.0 * c.block * weight)
    # a mean over decelerations that differ is not the curve at their mean
    bent = shift * max(s.sums[3] / weight / z**2 - 1.0, 0.0)
    sigma = math.hypot(math.sqrt(2.0) * noise, math.sqrt(s.eta.variance), bent) / z
    out = _around(here(at, slip[0]))
    h = min(sigma, c.ratio.cell(1, at))
    k = min(slip[1], 1.0)
    for low, high, spread in (
        (here(at - h, slip[0]), here(at + h, slip[0]), sigma / h),
        (here(at, slip[0] - k), here(at, slip[0] + k), slip[1] / k),
    ):
        for column in (0, 3):
            more = 0.5 * Z95 * spread * (high[column] - low[column])
            out[column + 1] = math.hypot(out[column + 1], more)
            out[column + 2] = math.hypot(out[column + 2], more)
            out[6] += (more / Z95) ** 2 * (column == 0)
    return out if out[1] + out[2] < prior[1] + prior[2] else prior


def _on_map(c: Constants, s: State) -> bool:
    """Whether a stop of the list shows such an eta."""
    z, shift = _means(s)
    return bool(c.ratio.axes[1][0] <= shift / z <= c.ratio.axes[1][-1])


def _around(read: list[float]) -> list[float]:
    """Medians of ratio and change, each with the distances to its bounds; no part by reading."""
    ratio, lower, upper, change, change_lower, change_upper = read[:6]
    return [
        ratio,
        ratio - lower,
        upper - ratio,
        change,
        change - change_lower,
        change_upper - change,
        0.0,
    ]


def _reason(c: Constants, s: State, x: Sample) -> Reason:
    checks = (
        (x.pressure <= c.least_pressure, Reason.NOT_BRAKED),
        (x.rim <= MOVING, Reason.SLOW),
        (s.braked < c.settle + 0.5 * c.block, Reason.JUST_APPLIED),
        (x.disturbed, Reason.DISTURBED),
        (s.eta.variance >= 0.9 * c.zero**2, Reason.NO_ZERO),
        (not _on_map(c, s), Reason.BEYOND_MAP),
    )
    return next((reason for applies, reason in checks if applies), Reason.VALID)
