r"""The estimator of the table: one step for each block of 50 ms, causal, with fixed memory.

    rolling:  zeros of deceleration, eta and slip              one scalar Kalman filter each
    braking:  d - d_0 = a u - b du/dt                          level a and delay b/a, Kalman filter
              means of z, eta - 1, slip that forget            -> map -> ln of the pads' ratio
    answer :  level, ratio, each with 95 % bounds

d is the brake force that the deceleration demands, u that of the nominal pads, both over the
weight. Rolling resistance, bias of the accelerometer and pitch at rest need not be known: d_0 holds
them all. A zero ages while the car brakes, and lasts over the next stop. The best informed answer
is kept; it ages as pads that warm up do. `valid` says that the model holds, not that the interval
is narrow.
"""

import math
from bisect import bisect_right
from collections import deque
from dataclasses import dataclass, field
from enum import IntEnum
from itertools import product
from typing import NamedTuple

from calib.base.names import G
from calib.car.braking import BITE, MOVING
from calib.run.driving_record import SETTLE, STEADY
from calib.run.noise import WALK
from calib.table.maps import Map

Z95 = 1.959964


class Reason(IntEnum):
    """Why an answer does not stand; 0 for one that does. The first that applies."""

    VALID = 0
    NOT_BRAKED = 1
    JUST_APPLIED = 2
    SLOW = 3
    DISTURBED = 4
    NO_ZERO = 5
    OUTSIDE = 6


class Sample(NamedTuple):
    """Means over a block. ``demand``, ``nominal`` brake forces over the weight [1]; ``pressure``
    [Pa]; ``eta``, ``slip`` (NaN without v) as read; ``omega`` of the front wheels [rad/s];
    ``disturbed`` while a wheel locks or the car corners.
    """

    demand: float
    nominal: float
    pressure: float
    z: float
    eta: float
    slip: float
    v: float
    speed: float
    omega: float
    disturbed: bool


@dataclass(frozen=True)
class Constants:
    """What the step takes from a table: maps, noise densities, and its tuned numbers."""

    ratio: "Reader"
    level: "Reader"
    with_v: bool
    noise_omega: float
    noise_z: float
    noise_v: float
    block: float
    memory: float = 0.5  # of the means that go into the map [s]
    settle: float = 0.3  # time of braking before an answer stands [s]
    least_pressure: float = 2e5  # [Pa]
    least_z: float = 0.05  # below it eta says nothing [1]
    level_sigma: float = 0.4  # of a level before any braking [1]
    level_walk: float = 0.03  # [1/sqrt(s)]
    level_rough: float = 0.012  # of a block, relative: road and body
    delay: float = 0.02  # of the brakes [s], and its sigma
    delay_sigma: float = 0.06
    zero: float = 0.01  # sigma of a zero before any rolling [1]
    grade_walk: float = 0.001  # of the zero of the demand [1/sqrt(s)]
    ageing: float = 0.01  # of a kept ratio [1/sqrt(s)]
    offset: float = 0.03  # of a_x and a slope together [1]
    scale: float = 0.009  # of a_x and pitch: mean and sigma that the level map has


class Reader:
    """A map read between its cells, held at its ends; numbers of Python, for one point at a time."""

    def __init__(self, m: Map, columns: tuple[str, ...]) -> None:
        self.axes = [axis.tolist() for axis in m.axes.values()]
        self.strides = []
        step = 1
        for axis in reversed(self.axes):
            self.strides.insert(0, step)
            step *= len(axis)
        self.cell = [min(b - a for a, b in zip(x, x[1:], strict=False)) for x in self.axes]
        self.cells = list(zip(*(getattr(m, name).tolist() for name in columns), strict=True))

    def __call__(self, *point: float) -> tuple[float, ...]:
        """All columns at a point, linear along each axis."""
        corners = []
        for x, axis, stride in zip(point, self.axes, self.strides, strict=True):
            i = min(max(bisect_right(axis, x) - 1, 0), len(axis) - 2)
            w = min(max((x - axis[i]) / (axis[i + 1] - axis[i]), 0.0), 1.0)
            corners.append(((i * stride, 1.0 - w), ((i + 1) * stride, w)))
        out = [0.0] * len(self.cells[0])
        for corner in product(*corners):
            at, weight = 0, 1.0
            for offset, share in corner:
                at += offset
                weight *= share
            if weight:
                for k, value in enumerate(self.cells[at]):
                    out[k] += weight * value
        return tuple(out)


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


class Answer(NamedTuple):
    """Level and ratio, each ln with 95 % bounds; ``change`` of the ratio since the ramp."""

    level: float
    level_lower: float
    level_upper: float
    ratio: float
    ratio_lower: float
    ratio_upper: float
    change: float
    change_lower: float
    change_upper: float
    delay: float
    reason: Reason


@dataclass
class Motion:
    """Speed v [m/s], offset o [1] and scale k [1] of the deceleration as read, with covariances.

    dv/dt = -g k (z - o) while the car brakes, with k = 1 while it rolls. What o and k are not told
    by v stays as open as the list of what a stop may bring has it.
    """

    v: float
    o: float
    k: float
    vv: float
    vo: float
    vk: float
    oo: float
    ok: float
    kk: float

    def moved(self, z: float, dt: float, braking: bool, noise: float, walk: float) -> None:
        """Over a block with the mean deceleration ``z``."""
        k = self.k if braking else 1.0
        f_o, f_k = G * k * dt, -G * (z - self.o) * dt * braking
        self.v -= G * k * (z - self.o) * dt
        self.vv += f_o * (2.0 * self.vo + f_o * self.oo) + f_k * (2.0 * self.vk + f_k * self.kk)
        self.vv += 2.0 * f_o * f_k * self.ok + (G * noise) ** 2 * dt
        self.vo += f_o * self.oo + f_k * self.ok
        self.vk += f_o * self.ok + f_k * self.kk
        self.oo += walk**2 * dt

    def measured(self, v: float, variance: float) -> None:
        """Take in a speed."""
        total = self.vv + variance
        a, b, c = self.vv / total, self.vo / total, self.vk / total
        rest = v - self.v
        self.v, self.o, self.k = self.v + a * rest, self.o + b * rest, self.k + c * rest
        self.oo -= b * self.vo
        self.ok -= b * self.vk
        self.kk -= c * self.vk
        self.vo -= a * self.vo
        self.vk -= a * self.vk
        self.vv -= a * self.vv


@dataclass
class State:
    """All that the estimator remembers."""

    demand: Zero
    eta: Zero
    slip: Zero
    level: list[float]  # a, b, and their covariance: aa, ab, bb
    waiting: deque[Sample] = field(default_factory=lambda: deque(maxlen=math.ceil(SETTLE / 0.05)))
    nominal: float = 0.0
    z: float = 0.0
    braked: float = 0.0
    released: float = 0.0
    sums: list[float] = field(default_factory=lambda: [0.0] * 5)
    best: list[float] | None = None
    motion: "Motion | None" = None


def started(c: Constants) -> State:
    """The state before the first block: radii within 1 %, pads of any level."""
    return State(
        demand=Zero(0.0, c.zero**2),
        eta=Zero(1.0, c.zero**2),
        slip=Zero(0.0, c.zero**2),
        level=_level_before(c, c.delay, c.delay_sigma**2),
    )


def _level_before(c: Constants, delay: float, variance: float) -> list[float]:
    """Level and level times delay, before a braking."""
    return [1.0, delay, c.level_sigma**2, delay * c.level_sigma**2, variance + (delay * c.level_sigma) ** 2]


def step(c: Constants, s: State, x: Sample) -> Answer:
    """Take in a block, and answer. Changes the state."""
    dt = c.block
    for zero, walk in ((s.demand, c.grade_walk), (s.eta, WALK), (s.slip, WALK)):
        zero.variance = min(zero.variance + walk**2 * dt, c.zero**2)
    if x.pressure > BITE:
        s.waiting.clear()
        s.braked += dt
        s.released = 0.0
        _brake(c, s, x)
    else:
        s.released += dt
        if s.braked and s.released > 1.0:
            _forget_stop(c, s)
        _roll(c, s, x)
    if c.with_v:
        _move(c, s, x)
    s.nominal, s.z = x.nominal, x.z
    return _answer(c, s, x)


def _move(c: Constants, s: State, x: Sample) -> None:
    """Scale of the deceleration from the speed."""
    variance = (c.noise_v**2 + 1e-6) / c.block
    if s.motion is None:
        s.motion = Motion(x.v, 0.0, 1.0 - c.scale, variance, 0.0, 0.0, c.offset**2, 0.0, c.scale**2)
        return
    s.motion.moved(0.5 * (x.z + s.z), c.block, x.pressure > BITE, c.noise_z, c.grade_walk)
    if x.speed > MOVING:
        s.motion.measured(x.v, variance)


def _roll(c: Constants, s: State, x: Sample) -> None:
    """Zeros, from blocks that lie far enough before a bite."""
    if len(s.waiting) == s.waiting.maxlen:
        old = s.waiting.popleft()
        noise = c.noise_omega / old.omega
        s.demand.measured(old.demand, (c.noise_z**2 + 1e-8) / c.block)
        s.eta.measured(old.eta, 2.0 * noise**2 / c.block)
        if c.with_v:
            s.slip.measured(old.slip, (noise**2 + (c.noise_v / old.v) ** 2) / c.block)
    if abs(x.z) < STEADY and x.speed > MOVING and not x.disturbed:
        s.waiting.append(x)
    else:
        s.waiting.clear()


def _forget_stop(c: Constants, s: State) -> None:
    a, b, aa, ab, bb = s.level
    delay = b / a
    variance = max(bb - 2.0 * delay * ab + delay**2 * aa, 0.0) / a**2
    s.level = _level_before(c, delay, variance)
    s.braked, s.best = 0.0, None
    s.sums = [0.0] * 5


def _brake(c: Constants, s: State, x: Sample) -> None:
    """Level and delay; means of what goes into the map."""
    if x.disturbed or x.speed <= MOVING:
        return
    a, b, aa, ab, bb = s.level
    rate = (x.nominal - s.nominal) / c.block
    y = x.demand - s.demand.value
    aa += (c.level_walk * a) ** 2 * c.block
    # y = a u - b rate
    pa, pb = aa * x.nominal - ab * rate, ab * x.nominal - bb * rate
    variance = pa * x.nominal - pb * rate + c.noise_z**2 / c.block + (c.level_rough * y) ** 2
    # what a shift does beyond its first order
    variance += (0.3 * rate * c.block) ** 2 * a**2
    rest = y - (a * x.nominal - b * rate)
    ka, kb = pa / variance, pb / variance
    s.level = [a + ka * rest, b + kb * rest, aa - ka * pa, ab - ka * pb, bb - kb * pb]
    keep = math.exp(-c.block / c.memory)
    slip = x.slip - s.slip.value if c.with_v else 0.0
    new = (1.0, x.z - s.demand.value, x.eta / s.eta.value - 1.0, slip, c.noise_omega / x.omega)
    s.sums = [keep * old + one for old, one in zip(s.sums, new, strict=True)]


def _answer(c: Constants, s: State, x: Sample) -> Answer:
    weight = s.sums[0]
    a, b, aa = s.level[0], s.level[1], s.level[2]
    a = max(a, 0.02)
    z, shift, slip, noise = (one / weight for one in s.sums[1:]) if weight else (0.1, 0.0, 0.0, 0.0)
    z = max(z, 0.01)
    lower, middle, upper = c.level(z)[:3]
    noisy = math.hypot(math.sqrt(max(aa, 0.0)) / a, math.sqrt(s.demand.variance) / z)
    level = math.log(a) + middle
    down, up = (math.hypot(part, Z95 * noisy) for part in (middle - lower, upper - middle))
    if s.motion is not None:  # v tells the scale: its prior goes out, its posterior comes in
        level += math.log(s.motion.k / (1.0 - c.scale))
        known = Z95**2 * (s.motion.kk - c.scale**2)
        least = Z95 * noisy
        down, up = (math.sqrt(max(x * x + known, least**2)) for x in (down, up))
    now = _ratio(c, s, z, shift, slip, noise, weight)
    if s.best is not None:
        grown = Z95 * c.ageing * math.sqrt(c.block)
        for k in (1, 2, 4, 5):
            s.best[k] = math.hypot(s.best[k], grown)
    if s.best is None or now[1] + now[2] <= s.best[1] + s.best[2]:
        s.best = now
    ratio, below, above, change, change_below, change_above = s.best
    return Answer(
        level, level - down, level + up,
        ratio, ratio - below, ratio + above,
        change, change - change_below, change + change_above,
        b / a, _reason(c, s, x),
    )  # fmt: skip


def _ratio(
    c: Constants, s: State, z: float, shift: float, slip: float, noise: float, weight: float
) -> list[float]:
    """ln of the ratio with the distances of its bounds, then the same of its change."""
    known = c.level(z)[3:]
    if not weight or z < c.least_z:
        return _around(known)
    noise *= math.sqrt(0.5 / (c.block * weight))
    sigma = math.hypot(math.sqrt(2.0) * noise, math.sqrt(s.eta.variance)) / z
    if c.with_v:
        slip = max(slip, 1e-4)
        error = math.hypot(noise, math.sqrt(s.slip.variance)) / slip
        point, sigmas = (z, shift / slip, math.log(slip / z)), (0.0, sigma * z / slip, error)
    else:
        point, sigmas = (z, shift / z), (0.0, sigma)
    out = _around(c.ratio(*point))
    for k, one in enumerate(sigmas):
        if one > 0.0:
            h = min(one, c.ratio.cell[k])
            ends = [c.ratio(*(y + d * (k == i) for i, y in enumerate(point))) for d in (-h, h)]
            for column, at in ((1, 0), (4, 3)):
                more = Z95 * one * (ends[1][column] - ends[0][column]) / (2.0 * h)
                out[at + 1], out[at + 2] = math.hypot(out[at + 1], more), math.hypot(out[at + 2], more)
    prior = _around(known)
    return out if out[1] + out[2] < prior[1] + prior[2] else prior


def _around(read: tuple[float, ...]) -> list[float]:
    """Medians, each with the distances to its bounds, from (lower, median, upper) of two things."""
    lower, middle, upper, change_lower, change, change_upper = read
    return [middle, middle - lower, upper - middle, change, change - change_lower, change_upper - change]


def _reason(c: Constants, s: State, x: Sample) -> Reason:
    if x.pressure <= c.least_pressure:
        return Reason.NOT_BRAKED
    if x.speed <= MOVING:
        return Reason.SLOW
    if s.braked <= c.settle:
        return Reason.JUST_APPLIED
    if x.disturbed:
        return Reason.DISTURBED
    if s.eta.variance >= 0.9 * c.zero**2:
        return Reason.NO_ZERO
    return Reason.VALID
