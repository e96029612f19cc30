r"""The accelerometer in doubt: its scale and offset, from the reference speed and from coasting.

    z as read = (1/(1 - c)) (zeta + grade) + bias        zeta = -(dv/dt)/g

    v + g int z dt = v_0 + c g int z dt + (bias + grade) g t + lag g z        where v is logged
    z on the lead-in less the known resistance = bias + drag                  always

The tyres carry W (zeta + grade): a grade is felt by the accelerometer and by the tyres alike, a
bias by the accelerometer alone. So the sum of bias and grade must be split before a_x may be put
right, and the lead-in splits it: an unbraked car on a slope reads its resistance, one with a bias
does not. What slows the car there besides the known resistance (an engine in gear, wind) is the
third that could explain it. Each of the three is there or not. So is a grade that changes on the
way, a random walk beside the noise: a_x feels it as the tyres do, and then only quick changes of z
tell the scale. The sixteen cases are weighed by how well they predict what was measured, and what
cannot be told widens the interval. A scale that no sensor has, by a unit, a clock or a filter, is
weighed against all of them.

A bias that changes within the log looks like a grade that does, and is taken for one.
"""

import math
from dataclasses import dataclass
from itertools import product

import numpy as np

from calib.base.arrays import Array, Mask
from calib.base.intervals import Mixture, second_differences, weigh_hypotheses
from calib.base.names import G
from calib.car.beliefs import SENSOR
from calib.car.braking import BITE
from calib.run.blocks import Blocks
from calib.run.driving_record import GREATEST
from calib.run.filters import centred_mean, recursive, samples_in
from calib.run.speed_delay import CHANGING, EVEN, ODDS_ROAD

_THERE, _STILL = np.array([0.03, 0.05, 0.03]), np.array([0.0015, 0.002, 0.002])
"""Sigma of bias, grade and drag [g] where each is there, and where it is said not to be. A mounting
that is 2 degrees off is 0.035 g, a road of 4 % is 0.04 g and a mountain road has 0.15 g, an engine
in gear at 2000 rpm 0.02 to 0.05 g."""

_ODDS = np.array([0.15, 0.3, 0.15, ODDS_ROAD[1]])
"""How often a bias, a grade, a drag and a grade that walks are there."""

_OTHER_SCALE, _ODDS_OTHER = 0.3, 3e-4
"""Sigma of c where a unit, a clock or a filter is wrong: knots taken for m/s are 49 % off, a clock
of 110 Hz taken for 100 is 10 % off. One log in 3000; a scale that is sharp is then another cause
from 9 % on, 4.6 sigma of a sensor."""

_ROLLING, _DRAG, _RESISTS = 0.011, 2.7e-5, 0.3
"""Resistance of a usual car over its weight: rolling [1], by the speed squared [s^2/m^2], 0.66 m^2
of 1500 kg; its relative standard deviation [1]."""

_LAG = 0.02  # how far v and a_x may be out of step [s]
_SECOND = 1.0  # time over which a_x and v are compared [s]: the noise of v is then 0.002 g
_STEP = 4  # blocks that are judged together: 0.2 s; what is left of the run is not used

_CASES = np.array(list(product((False, True), repeat=4)))
"""Whether bias, grade, drag and a grade that walks are there (16, 4): those that walk by turns."""

_SENSED = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 1.0, 0.0], [0.0, 1.0, 0.0, 1.0]])
"""From the causes (c, bias, grade, drag) to what is measured: (c, bias + grade, bias + drag)."""


@dataclass(frozen=True)
class Accelerometer:
    """Scale and offset of the accelerometer by all of a run.

    ``scale`` c [1], ``bias`` [g] and their ``variance_scale``, ``variance_bias``, ``covariance``;
    ``drag`` [g] as far as it is told apart from a grade; ``lag`` [s] by which a_x comes after v,
    with ``variance_lag``. ``wanders`` [1] how likely the grade changes on the way; ``disagrees``
    [g] how much a_x and the slowing of v differ by turns, over a second, the scale aside.
    """

    scale: float
    bias: float
    variance_scale: float
    variance_bias: float
    covariance: float
    drag: float
    lag: float
    variance_lag: float
    wanders: float
    disagrees: float

    def corrected(self, z: Array) -> Array:
        """Deceleration [1] that the tyres feel, from z [1] as read, (k,)."""
        return np.asarray((z - self.bias) * (1.0 - self.scale))

    def sigma(self, z: Array) -> Array:
        """Standard deviation of the corrected z [1]."""
        variance = self.variance_scale * z**2 + self.variance_bias + 2.0 * self.covariance * z
        return np.asarray(np.sqrt(np.maximum(variance, 0.0)))


@dataclass(frozen=True)
class _AgainstSpeed:
    """What v says of (c, e, d) with the lag taken out, and of the lag where (c, e) are known.

    e = bias + grade, d = bias + drag. ``likelihood`` its logarithm where c, e and d are zero, up to
    a constant; ``information`` [1/s^2] and ``side`` [1/s] of the lag, which moves ``along`` (c, e)
    [1/s] (2,).
    """

    precision: Array
    vector: Array
    likelihood: float
    information: float
    side: float
    along: Array

    def lag_of(self, weighed: Mixture) -> tuple[float, float]:
        """Time by which a_x comes after v [s], and its variance."""
        moved = _SENSED[:2] @ weighed.mean
        covariance = _SENSED[:2] @ weighed.covariance @ _SENSED[:2].T
        spread = float(self.along @ covariance @ self.along)
        lag = (self.side - float(self.along @ moved)) / self.information
        return -lag, 1.0 / self.information + spread / self.information**2


@dataclass(frozen=True)
class SpeedEvidence:
    """What v says of the accelerometer of a run, whatever resistance the car is taken to have.

    ``last`` blocks are judged; ``density_z`` noise [s^0.5]; ``grades`` by a steady grade and by one
    that walks.
    """

    blocks: Blocks
    last: int
    density_z: float
    grades: tuple[_AgainstSpeed, ...]


def speed_evidence(
    b: Blocks, density_z: float, density_v: float, smooth: Array | None = None
) -> SpeedEvidence:
    """Compare a_x with v, ``density_z`` [s^0.5] and ``density_v`` [m/s s^0.5] their noise.

    A ``smooth`` z [1] (k,) tells scale and lag, or z itself.
    """
    last = (b.end.size - 1) // _STEP * _STEP
    compared, noise = _compared(b, b.z if smooth is None else smooth), (density_z, density_v)
    grades = (_against_speed(b.length, compared, last, walk, noise) for walk in (EVEN, CHANGING))
    return SpeedEvidence(b, last, density_z, tuple(grades))


def accelerometer(evidence: SpeedEvidence, unexplained: Array, sigma: Array) -> Accelerometer:
    """Judge the accelerometer of a log by what v has ``evidence`` and by its lead-in.

    ``unexplained`` z less what the known resistance explains of it, read on the lead-in only, and
    ``sigma`` of that resistance, common to the log [1], (k,).
    """
    rolling = _on_lead_in(evidence, unexplained, sigma)
    weighed = _mixture(evidence.grades, rolling, _CASES, SENSOR.a_x_scale.sigma)
    c, bias, _, drag = weighed.mean.tolist()
    wanders = float(weighed.weights[1::2].sum())
    (lag, variance), (other_lag, other_variance) = (x.lag_of(weighed) for x in evidence.grades)
    return Accelerometer(
        scale=c,
        bias=bias,
        variance_scale=float(weighed.covariance[0, 0]),
        variance_bias=float(weighed.covariance[1, 1]),
        covariance=float(weighed.covariance[0, 1]),
        drag=drag,
        lag=(1.0 - wanders) * lag + wanders * other_lag,
        variance_lag=(1.0 - wanders) * variance
        + wanders * other_variance
        + (1.0 - wanders) * wanders * (other_lag - lag) ** 2,
        wanders=wanders,
        disagrees=_disagreement(evidence.blocks, c, evidence.last),
    )


def _usable(b: Blocks, apart: int) -> Mask:
    """Pairs of blocks ``apart`` in both of which the car moves and a_x has no glitch."""
    usable = (b.speed > 2.0) & (np.abs(b.z) < GREATEST)
    return np.asarray(usable[apart:] & usable[:-apart])


def _compared(b: Blocks, smooth: Array) -> tuple[Array, Mask] | None:
    """Second differences of v + g int z dt, and what c, e and the lag make of it, (4, k - 1).

    And where they are to be used, (k - 1,). None without v.
    """
    if b.v is None:
        return None
    gained, scaled = (G * 0.5 * b.length * (z[1:] + z[:-1]) for z in (b.z, smooth))
    usable = _usable(b, 1)
    slope = np.full(gained.size, G * b.length)
    columns = np.stack([np.diff(b.v) + gained, scaled, slope, G * np.diff(smooth)])
    usable = usable & np.concatenate([[True], usable[:-1]])
    return np.where(usable, np.diff(columns, axis=1, prepend=0.0), 0.0), usable


def _against_speed(
    h: float,
    compared: tuple[Array, Mask] | None,
    last: int,
    wander: float,
    densities: tuple[float, float],
) -> _AgainstSpeed:
    """Information about (c, e, d) and the lag from v against the integral of z, up to the ``last``.

    The noise of v is white and that of the integral a random walk, and the grade walks by
    ``wander`` [g/s^0.5]: second differences are then a moving average of order two, which a filter
    makes white. e is that at the start. ``h`` length of a block [s]; ``densities`` of z and v.
    """
    if compared is None:
        return _AgainstSpeed(np.zeros((3, 3)), np.zeros(3), 0.0, _LAG**-2.0, 0.0, np.zeros(2))
    white, walk = densities[1] ** 2 / h, (G * densities[0]) ** 2 * h
    columns, usable = compared
    average, sigma = second_differences(white, walk, (G * h * wander) ** 2 * h)
    start = np.zeros_like(columns[:1])
    start[0, :2] = -1.0, 1.0  # the noise of the first v, which all others are compared with
    rows = recursive(np.concatenate([columns, start]), average)[:, :last] / sigma
    products = rows @ rows.T
    likelihood = -0.5 * float(products[0, 0]) - np.count_nonzero(usable[:last]) * math.log(sigma)
    precision, vector = np.zeros((3, 3)), np.zeros(3)
    pair, side = products[1:, 1:], products[1:, 0]
    # the shares of the start and of the lag are taken out with their priors
    for place, variance in ((3, white), (2, _LAG**2)):
        along, right = pair[:place, place], side[place]
        curvature = pair[place, place] + 1.0 / variance
        likelihood += float(0.5 * (right**2 / curvature - np.log(curvature)))
        pair = pair[:place, :place] - np.outer(along, along) / curvature
        side = side[:place] - along * right / curvature
    precision[:2, :2], vector[:2] = pair, side
    return _AgainstSpeed(precision, vector, likelihood, float(curvature), float(right), along)


def _on_lead_in(evidence: SpeedEvidence, unexplained: Array, sigma: Array) -> tuple[float, float]:
    """Mean of ``unexplained`` over the lead-in, and its variance [1]; inf without any."""
    b = evidence.blocks
    free = (b.lead_in & (b.speed > 3.0))[: evidence.last + 1]
    count = np.count_nonzero(free)
    if not count:
        return 0.0, np.inf
    mean, common = (float(np.mean(x[: evidence.last + 1][free])) for x in (unexplained, sigma))
    return mean, evidence.density_z**2 / (count * b.length) + common**2


def other_scale(b: Blocks, density_z: float, density_v: float) -> float:
    """The scale c [1] over all of a run where it is likelier that of no sensor, else 0.

    0 without ``v`` or a braking. Without a grade that walks, which explains what such a scale does.
    By means of z over `_SECOND`: the noise of a_x, in the integral and in what a scale makes of it
    alike, looks like a scale of 1. The resistance on the lead-in is that of usual cars.
    """
    if b.v is None or not np.any(np.maximum(b.p_f, b.p_r) > BITE):
        return 0.0
    slow = centred_mean(b.z, samples_in(_SECOND, b.length))
    evidence = speed_evidence(b, density_z, density_v, slow)
    usual = _ROLLING + _DRAG * b.speed**2
    rolling = _on_lead_in(evidence, b.z - usual, _RESISTS * usual)
    other = _mixture(evidence.grades, rolling, _CASES[::2], _OTHER_SCALE)
    sensor = _mixture(evidence.grades, rolling, _CASES, SENSOR.a_x_scale.sigma)
    likelier = other.evidence + np.log(_ODDS_OTHER) > sensor.evidence
    return float(other.mean[0]) if likelier else 0.0


def _mixture(
    grades: tuple[_AgainstSpeed, ...],
    rolling: tuple[float, float],
    present: Mask,
    scale: float,
) -> Mixture:
    """Mixture over the cases ``present`` (k, 4); ``rolling`` mean and variance of d."""
    precision, vector, likelihood = (
        np.array([getattr(x, name) for x in grades])
        for name in ("precision", "vector", "likelihood")
    )
    precision[:, 2, 2] += 1.0 / rolling[1]
    vector[:, 2] += rolling[0] / rolling[1]
    walks = present[:, 3].astype(int)
    return weigh_hypotheses(
        (_SENSED.T @ precision @ _SENSED)[walks],
        (vector @ _SENSED)[walks],
        np.insert(np.where(present[:, :3], _THERE, _STILL), 0, scale, axis=1),
        np.where(present, _ODDS, 1.0 - _ODDS).prod(axis=1),
        likelihood[walks],
    )


def _disagreement(b: Blocks, scale: float, last: int) -> float:
    """Largest less smallest mean over a second of z less the slowing of v [g], up to the ``last``.

    Less what the ``scale`` explains.
    """
    whole = max(round(_SECOND / b.length), 1)
    if b.v is None or last < whole:
        return 0.0
    lost = (b.v[whole:last] - b.v[: last - whole]) / (G * whole * b.length)
    total = np.concatenate([[0.0], np.cumsum(0.5 * (b.z[1:] + b.z[:-1]))])[:last]
    mean = (total[whole:] - total[:-whole]) / whole
    usable = _usable(b, whole)[: last - whole]
    return float(np.ptp((lost + mean * (1.0 - scale))[usable])) if usable.any() else 0.0
