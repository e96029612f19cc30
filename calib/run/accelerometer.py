r"""Scale and offset of the accelerometer, from the reference speed and from coasting.

    z as read = (1/(1 - c)) (zeta + grade) + bias        zeta = -(dv/dt)/g

    v + g int z dt = v_0 + c g int z dt + (bias + grade) g t + lag g z        where v is logged
    z on the lead-in less the known resistance = bias + drag                  always

The tyres carry W (zeta + grade): they feel a grade as the accelerometer does, but no bias. The
speed shows only the sum of both. The lead-in splits it: on a slope an unbraked car reads its
resistance, with a bias it does not. Unknown drag there (an engine in gear, wind) looks like a bias.
Each of the three is present or absent, and so is a grade that walks at random on the way: with it
only quick changes of z show the scale. The sixteen hypotheses are weighed by their evidence. A
scale that no sensor has (a wrong unit, clock or filter) is weighed against all of them.

A bias that changes within the log is taken for a grade that changes.
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
from calib.run.driving_record import GREATEST_Z
from calib.run.filters import centred_mean, recursive_filter, samples_in
from calib.run.speed_delay import CHANGING, EVEN, ODDS_ROAD

_THERE, _STILL = np.array([0.03, 0.05, 0.03]), np.array([0.0015, 0.002, 0.002])
"""Sigma of bias, grade and drag [g], present and absent. A mounting that is 2 degrees off makes
0.035 g, a road of 4 % 0.04 g, a mountain road 0.15 g, an engine in gear at 2000 rpm 0.02 to 0.05 g.
"""

_ODDS = np.array([0.15, 0.3, 0.15, ODDS_ROAD[1]])
"""Prior probability of a bias, a grade, a drag and a grade that walks."""

_OTHER_SCALE, _ODDS_OTHER = 0.3, 3e-4
"""Sigma of c where a unit, a clock or a filter is wrong, and how often one is: knots taken for m/s
make 49 %, a clock of 110 Hz taken for 100 makes 10 %. A well-known c is then no sensor's from 9 %
on, 4.6 sigma of a sensor."""

_ROLLING, _DRAG, _RESISTS = 0.011, 2.7e-5, 0.3
"""Resistance of a usual car over its weight: rolling [1], by the speed squared [s^2/m^2], 0.66 m^2
of 1500 kg; its relative standard deviation [1]."""

_LAG = 0.02  # how far v and a_x may be out of step [s]
_SECOND = 1.0  # time over which a_x and v are compared [s]: the noise of v is then 0.002 g
_STEP = 4  # blocks that are judged together: 0.2 s; a shorter end of the run is not used

_CASES = np.array(list(product((False, True), repeat=4)))
"""Whether bias, grade, drag and a walk of the grade are present (16, 4); every second one walks."""

_SENSED = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 1.0, 0.0], [0.0, 1.0, 0.0, 1.0]])
"""From the causes (c, bias, grade, drag) to what is measured: (c, bias + grade, bias + drag)."""


@dataclass(frozen=True)
class Accelerometer:
    """Scale and offset of the accelerometer from a whole run.

    ``scale`` c [1], ``bias`` [g] and their ``variance_scale``, ``variance_bias``, ``covariance``;
    ``drag`` [g] besides the known resistance; ``lag`` [s] of a_x behind v. ``wanders`` probability
    that the grade changes on the way [1]; ``disagrees`` see `_disagreement` [g].
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
    """Normal equations of (c, e = bias + grade, d = bias + drag) from v, the lag eliminated.

    ``likelihood`` its logarithm at c = e = d = 0, up to a constant; ``information`` [1/s^2],
    ``side`` [1/s] and ``along`` [1/s] (2,): row of the lag, with coupling to (c, e).
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
    """What v shows of the accelerometer, whatever the resistance of the car.

    The first ``last`` blocks count; ``density_z`` noise of z [s^0.5]; ``grades``: with a steady
    grade, and with one that walks.
    """

    blocks: Blocks
    last: int
    density_z: float
    grades: tuple[_AgainstSpeed, ...]


def speed_evidence(
    b: Blocks, density_z: float, density_v: float, smooth: Array | None = None
) -> SpeedEvidence:
    """Compare a_x with v, whose noise is ``density_z`` [s^0.5] and ``density_v`` [m/s s^0.5].

    Scale and lag are regressed on ``smooth`` z [1] (k,), if given, else on z.
    """
    last = (b.end.size - 1) // _STEP * _STEP
    compared, noise = _compared(b, b.z if smooth is None else smooth), (density_z, density_v)
    grades = (_against_speed(b.length, compared, last, walk, noise) for walk in (EVEN, CHANGING))
    return SpeedEvidence(b, last, density_z, tuple(grades))


def accelerometer(evidence: SpeedEvidence, unexplained: Array, sigma: Array) -> Accelerometer:
    """Estimate scale and offset from the ``evidence`` of v and from the lead-in.

    ``unexplained`` z less the known resistance, read on the lead-in alone; ``sigma`` of that
    resistance, common to the log [1], (k,).
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
    usable = (b.speed > 2.0) & (np.abs(b.z) < GREATEST_Z)
    return np.asarray(usable[apart:] & usable[:-apart])


def _compared(b: Blocks, smooth: Array) -> tuple[Array, Mask] | None:
    """Second differences of v + g int z dt and columns of c, e, lag (4, k - 1); where usable."""
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
    """Compare v with the integral of z up to the ``last`` of the blocks of ``h`` [s].

    The noise of v is white, that of the integral is a random walk, and the grade walks by
    ``wander`` [g/s^0.5]. Second differences are then a moving average of order two, which a filter
    makes white. e is that at the start; ``densities`` of z and v.
    """
    if compared is None:
        return _AgainstSpeed(np.zeros((3, 3)), np.zeros(3), 0.0, _LAG**-2.0, 0.0, np.zeros(2))
    white, walk = densities[1] ** 2 / h, (G * densities[0]) ** 2 * h
    columns, usable = compared
    average, sigma = second_differences(white, walk, (G * h * wander) ** 2 * h)
    start = np.zeros_like(columns[:1])
    start[0, :2] = -1.0, 1.0  # noise of the first v, the reference of all others
    rows = recursive_filter(np.concatenate([columns, start]), average)[:, :last] / sigma
    products = rows @ rows.T
    likelihood = -0.5 * float(products[0, 0]) - np.count_nonzero(usable[:last]) * math.log(sigma)
    precision, vector = np.zeros((3, 3)), np.zeros(3)
    pair, side = products[1:, 1:], products[1:, 0]
    # eliminate start and lag, each with its prior
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
    """Return the scale c [1] of a wrong unit, clock or filter; 0 if a sensor's scale is likelier.

    0 too without ``v`` or a braking. A walk of the grade is excluded: it would explain such a
    scale. z is averaged over `_SECOND`, as its noise stands in the integral and in the column of c
    alike and looks like a scale of 1. The resistance is that of a usual car.
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
    """Range of the means over 1 s of a_x, its ``scale`` corrected, less the slowing of v [g]."""
    whole = max(round(_SECOND / b.length), 1)
    if b.v is None or last < whole:
        return 0.0
    lost = (b.v[whole:last] - b.v[: last - whole]) / (G * whole * b.length)
    total = np.concatenate([[0.0], np.cumsum(0.5 * (b.z[1:] + b.z[:-1]))])[:last]
    mean = (total[whole:] - total[:-whole]) / whole
    usable = _usable(b, whole)[: last - whole]
    return float(np.ptp((lost + mean * (1.0 - scale))[usable])) if usable.any() else 0.0
