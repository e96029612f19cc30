r"""The estimator of the table: one step for each block of 50 ms, causal, with fixed memory.

    rolling   zeros of deceleration, eta and slip            a scalar Kalman filter each
    always    speed, offset and scale of a_x, slip           a Kalman filter: a_x carries the speed
                                                             on, the wheels and v measure it
    braking   d - d_0 = a u - b du/dt                        level a and delay b/a, a Kalman filter
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
from typing import Any, NamedTuple

import numpy as np

from calib.base.intervals import Z95
from calib.base.names import G
from calib.car.braking import BITE, MOVING
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


class Sample(NamedTuple):
    """Means over a block, SI.

    ``demand`` brake force that the deceleration ``z`` demands, ``nominal`` that of nominal pads,
    over the weight [1]; ``pressure`` [Pa]; ``eta`` [1] as read; ``rim`` speed of the front wheels'
    rims [m/s]; ``rear_share`` of the load [1]; ``v`` [m/s], NaN where not logged; ``disturbed``
    while a wheel locks or the car corners.
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


class Reader:
    """A map read between its cells, held at its ends; one point at a time."""

    def __init__(self, m: Map, columns: tuple[str, ...]) -> None:
        self.axes = [axis.tolist() for axis in m.axes.values()]
        self.columns = columns
        self.cells = np.stack([m.grid(name) for name in columns], axis=-1).tolist()

    def cell(self, axis: int, x: float) -> float:
        """Width of the cell of an axis in which ``x`` lies."""
        points = self.axes[axis]
        i = min(max(bisect_right(points, x) - 1, 0), len(points) - 2)
        return float(points[i + 1] - points[i])

    def __call__(self, *point: float) -> list[float]:
        """All columns at a point, linear along each axis."""
        cells = self.cells
        places = []
        for x, axis in zip(point, self.axes, strict=True):
            i = min(max(bisect_right(axis, x) - 1, 0), len(axis) - 2)
            places.append((i, min(max((x - axis[i]) / (axis[i + 1] - axis[i]), 0.0), 1.0)))
        return _between(cells, places)


def _between(cells: list[Any], places: list[tuple[int, float]]) -> list[float]:
    if not places:
        return cells
    (i, w), *rest = places
    low, high = _between(cells[i], rest), _between(cells[i + 1], rest)
    return [a + w * (b - a) for a, b in zip(low, high, strict=True)]


@dataclass(frozen=True)
class Constants:
    """What the step takes from a table, and its tuned numbers."""

    ratio: Reader
    level: Reader
    noise_omega: float
    noise_z: float
    noise_v: float
    radius: float
    block: float
    memory: float = 0.5  # of the means that go into the map [s]
    before_bite: float = 0.3  # time that no zero rests on [s]: pads may touch
    settle: float = 0.3  # time of braking before an answer stands [s]
    least_pressure: float = 2e5  # [Pa]
    least_z: float = 0.05  # below it eta says nothing [1]
    level_sigma: float = 0.4  # of a level before any braking [1]
    level_walk: float = 0.03  # [1/sqrt(s)]
    level_rough: float = 0.012  # of a block, relative: road and body
    delay: float = 0.02  # of the brakes [s], and its sigma
    delay_sigma: float = 0.06
    zero: float = 0.01  # sigma of a zero before any rolling [1]
    offset: float = 0.03  # sigma of bias and slope together before any rolling [1]
    grade_walk: float = 0.001  # of bias and slope [1/sqrt(s)]
    scale: float = 0.009  # a_x reads too much while braking, scale and pitch; and its sigma
    scale_sigma: float = 0.01
    ageing: float = 0.01  # of a kept ratio [1/sqrt(s)]
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

    def measured(self, y: float, H: list[float], variance: float) -> None:
        """Take in a reading ``y`` of ``H`` x; ``y`` is what is left of it over the prediction."""
        PH = [sum(p * h for p, h in zip(row, H, strict=True)) for row in self.P]
        gain = 1.0 / (sum(h * p for h, p in zip(H, PH, strict=True)) + variance)
        self.x = [x + gain * p * y for x, p in zip(self.x, PH, strict=True)]
        self.P = [
            [old - gain * p * q for old, q in zip(row, PH, strict=True)]
            for row, p in zip(self.P, PH, strict=True)
        ]


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
class State:
    """All that the estimator remembers.

    ``motion`` speed [m/s], offset and scale of a_x [1], ln(slip/z) over that of the map; ``level``
    level and level times delay; ``sums`` weight and weighted sums of z, eta - 1 and z^2.
    """

    demand: Zero
    eta: Zero
    slip: Zero
    level: Gaussian
    motion: Gaussian | None = None
    waiting: deque[Sample] = field(default_factory=deque)
    nominal: float = 0.0
    z: float = 0.0
    mean_z: float = 0.0
    braked: float = 0.0
    released: float = 0.0
    sums: list[float] = field(default_factory=lambda: [0.0] * 4)
    best: list[float] | None = None


def started(c: Constants) -> State:
    """The state before the first block: radii within 1 %, pads of any level."""
    return State(
        demand=Zero(0.0, c.zero**2),
        eta=Zero(1.0, c.zero**2),
        slip=Zero(0.0, c.zero**2),
        level=_level_before(c, c.delay, c.delay_sigma**2),
    )


def _level_before(c: Constants, delay: float, variance: float) -> Gaussian:
    """Level, and level times delay, before a braking."""
    aa = c.level_sigma**2
    return Gaussian([1.0, delay], [[aa, delay * aa], [delay * aa, variance + delay**2 * aa]])


def step(c: Constants, s: State, x: Sample) -> Answer:
    """Take in a block, and answer. Changes the state."""
    for zero, walk in ((s.demand, c.grade_walk), (s.eta, WALK), (s.slip, WALK)):
        zero.variance = min(zero.variance + walk**2 * c.block, c.zero**2)
    braking = x.pressure > BITE
    if braking:
        s.waiting.clear()
        s.braked += c.block
        s.released = 0.0
        _brake(c, s, x)
    else:
        s.released += c.block
        if s.braked > 0.0 and s.released > 1.0:
            _forget_stop(c, s)
        _roll(c, s, x)
    _move(c, s, x, braking)
    s.nominal, s.z = x.nominal, x.z
    return _answer(c, s, x)


def _means(s: State) -> tuple[float, float]:
    """Demanded brake force over the weight and eta - 1, means that forget, from the zeros."""
    weight, z, shift, _ = s.sums
    return (max(z / weight, 0.01), shift / weight) if weight > 0.0 else (0.1, 0.0)


def _roll(c: Constants, s: State, x: Sample) -> None:
    """Zeros, from blocks that lie far enough before a bite."""
    if len(s.waiting) * c.block >= c.before_bite:
        old = s.waiting.popleft()
        wheels = c.noise_omega * c.radius / old.rim
        s.demand.measured(old.demand, (c.noise_z**2 + 1e-8) / c.block)
        s.eta.measured(old.eta, 2.0 * wheels**2 / c.block)
        if old.v == old.v:
            slip = 1.0 - _rim(s, old) / old.v
            s.slip.measured(slip, (wheels**2 + (c.noise_v / old.v) ** 2) / c.block)
    if abs(x.z) < STEADY and x.rim > MOVING and not x.disturbed:
        s.waiting.append(x)
    else:
        s.waiting.clear()


def _rim(s: State, x: Sample) -> float:
    """Speed of all wheels' rims [m/s], weighted by load, radii made equal."""
    return x.rim * (1.0 + x.rear_share * (x.eta / s.eta.value - 1.0))


def _forget_stop(c: Constants, s: State) -> None:
    """What is only of the last stop; the delay is the car's."""
    (a, b), ((aa, ab), (_, bb)) = s.level.x, s.level.P
    delay = b / a
    variance = max(bb - 2.0 * delay * ab + delay**2 * aa, 0.0) / a**2
    s.level = _level_before(c, delay, variance)
    s.braked, s.best, s.sums = 0.0, None, [0.0] * 4


def _brake(c: Constants, s: State, x: Sample) -> None:
    """Level and delay; means of what goes into the map."""
    if x.disturbed or x.rim <= MOVING:
        return
    level, rate = s.level, (x.nominal - s.nominal) / c.block
    y = x.demand - s.demand.value
    level.P[0][0] += (c.level_walk * level.x[0]) ** 2 * c.block
    # a shift of the pressure is -b du/dt in the first order only
    variance = c.noise_z**2 / c.block + (c.level_rough * y) ** 2 + (0.3 * rate * c.block) ** 2
    a, b = level.x
    level.measured(y - (a * x.nominal - b * rate), [x.nominal, -rate], variance)
    keep = math.exp(-c.block / c.memory)
    new = (1.0, y, x.eta / s.eta.value - 1.0, y * y)
    s.sums = [keep * old + one for old, one in zip(s.sums, new, strict=True)]


def _move(c: Constants, s: State, x: Sample, braking: bool) -> None:
    """Speed by a_x, measured by the wheels and v; what does not fit is offset, scale and slip."""
    if s.motion is None:
        P = [[0.0] * 4 for _ in range(4)]
        P[0][0], P[1][1], P[2][2] = 1.0, c.offset**2, c.scale_sigma**2
        s.motion = Gaussian([_rim(s, x), 0.0, c.scale, 0.0], P)
    m, dt = s.motion, c.block
    z, (mean_z, _) = 0.5 * (x.z + s.z), _means(s)
    v, o, e, slip = m.x
    k = 1.0 - e * braking
    v -= G * k * (z - o) * dt
    m.x[0] = v
    to_v = [1.0, G * k * dt, G * (z - o) * dt * braking, 0.0]
    PF = [sum(p * f for p, f in zip(row, to_v, strict=True)) for row in m.P]
    m.P[0] = [sum(f * p for f, p in zip(to_v, PF, strict=True)), *PF[1:]]
    for i in (1, 2, 3):
        m.P[i][0] = PF[i]
    m.P[0][0] += (G * c.noise_z) ** 2 * dt
    m.P[1][1] += c.grade_walk**2 * dt
    m.P[3][3] += c.slip_walk**2 * dt + c.slip_bends * abs(mean_z - s.mean_z)
    s.mean_z = mean_z
    if s.braked <= dt:
        m.x[3] = slip = c.log_slip
        for i in (0, 1, 2):
            m.P[3][i] = m.P[i][3] = 0.0
        m.P[3][3] = c.log_slip_sigma**2
    if x.disturbed or x.rim <= MOVING:
        return
    slip = max(x.demand - s.demand.value, 0.0) * math.exp(slip) if braking else 0.0
    rest, variance = _rim(s, x) - v * (1.0 - slip), (c.noise_omega * c.radius) ** 2 / dt
    m.measured(rest, [1.0 - slip, 0.0, 0.0, -v * slip], variance + (c.slip_rough * slip * v) ** 2)
    if x.v == x.v:
        v = m.x[0]
        variance = (c.noise_v**2 + 1e-8) / dt + v**2 * s.slip.variance
        m.measured(x.v * (1.0 - s.slip.value) - v, [1.0, 0.0, 0.0, 0.0], variance)


def _with_map(m: Gaussian, read: list[float]) -> tuple[float, float, float, float]:
    """Scale of a_x and ln(slip/z), each with its variance, with what the map says of the slip."""
    prior, sigma = read[SLIP], read[SLIP + 1]
    both = [row[3] for row in m.P]
    gain, rest = 1.0 / (both[3] + sigma**2), prior - m.x[3]
    e, ee = m.x[2] + gain * both[2] * rest, m.P[2][2] - gain * both[2] ** 2
    return e, ee, m.x[3] + gain * both[3] * rest, m.P[3][3] - gain * both[3] ** 2


LEVEL = ("level", "level_lower", "level_upper")
PADS = ("ratio", "ratio_lower", "ratio_upper", "change", "change_lower", "change_upper")
COLUMNS = (*PADS, "log_slip", "log_slip_sigma")
SLIP = COLUMNS.index("log_slip")


def _answer(c: Constants, s: State, x: Sample) -> Answer:
    a, b = s.level.x
    a = max(a, 0.02)
    z, shift = _means(s)
    before = c.level(z)
    read = c.ratio(z, shift / z, 0.0)
    assert s.motion is not None
    e, ee, log_slip, left = _with_map(s.motion, read)
    noisy = Z95 * math.sqrt(s.level.P[0][0] / a**2 + s.demand.variance / z**2 + ee)
    level = math.log(a * (1.0 - e)) + before[0]
    down, up = math.hypot(before[0] - before[1], noisy), math.hypot(before[2] - before[0], noisy)
    apart = ((log_slip - read[SLIP]) / read[SLIP + 1], math.sqrt(left) / read[SLIP + 1])
    now = _ratio(c, s, (z, shift), apart, before[len(LEVEL) :])
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
    c: Constants,
    s: State,
    mean: tuple[float, float],
    slip: tuple[float, float],
    before: list[float],
) -> list[float]:
    """ln of the ratio with the distances of its bounds, then the same of its change.

    ``mean`` of z and eta - 1; ``slip`` and its sigma, along the axis of the map.
    """
    (z, shift), prior = mean, _around(before)
    weight = s.sums[0]
    assert s.motion is not None
    if not weight or z < c.least_z:
        return prior
    at = shift / z
    noise = c.noise_omega * c.radius / max(s.motion.x[0], 1.0) / math.sqrt(2.0 * c.block * weight)
    # a mean over decelerations that differ is not the curve at their mean
    bent = shift * max(s.sums[3] / weight / z**2 - 1.0, 0.0)
    sigma = math.hypot(math.sqrt(2.0) * noise, math.sqrt(s.eta.variance), bent) / z
    out = _around(c.ratio(z, at, slip[0]))
    h = min(sigma, c.ratio.cell(1, at))
    k = min(slip[1], 1.0)
    for low, high, spread in (
        (c.ratio(z, at - h, slip[0]), c.ratio(z, at + h, slip[0]), sigma / h),
        (c.ratio(z, at, slip[0] - k), c.ratio(z, at, slip[0] + k), slip[1] / k),
    ):
        for column in (0, 3):
            more = 0.5 * Z95 * spread * (high[column] - low[column])
            out[column + 1] = math.hypot(out[column + 1], more)
            out[column + 2] = math.hypot(out[column + 2], more)
    return out if out[1] + out[2] < prior[1] + prior[2] else prior


def _around(read: list[float]) -> list[float]:
    """Medians of ratio and change, each with the distances to its bounds."""
    ratio, lower, upper, change, change_lower, change_upper = read[:6]
    return [
        ratio,
        ratio - lower,
        upper - ratio,
        change,
        change - change_lower,
        change_upper - change,
    ]


def _reason(c: Constants, s: State, x: Sample) -> Reason:
    checks = (
        (x.pressure <= c.least_pressure, Reason.NOT_BRAKED),
        (x.rim <= MOVING, Reason.SLOW),
        (s.braked <= c.settle, Reason.JUST_APPLIED),
        (x.disturbed, Reason.DISTURBED),
        (s.eta.variance >= 0.9 * c.zero**2, Reason.NO_ZERO),
    )
    return next((reason for applies, reason in checks if applies), Reason.VALID)
