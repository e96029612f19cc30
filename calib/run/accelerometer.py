r"""Scale and offset of the accelerometer, from the reference speed v and from coasting.

    z as read = (-(dv/dt)/g + grade)/(1 - c) + bias

    v + g int z dt = v_0 + c g int z dt + (bias + grade) g t + lag g z        where v is logged
    z on the lead-in less the known resistance = bias + drag                  always

c is the error of scale, drag an unknown resistance (an engine in gear, wind), lag the time by which
v comes after a_x. The grade is positive downhill. The tyres carry W (grade - (dv/dt)/g): they feel
a grade as the accelerometer does, but no bias. The speed shows only the sum of bias and grade. The
lead-in separates them: on a slope an unbraked car reads its resistance, with a bias it does not.
Unknown drag looks like a bias there.

Bias, grade and drag are each present or absent, and so is a walk: a grade that changes at random in
the run. Slow changes of z may then be the road, and only quick ones show the scale. The sixteen
cases are weighed by their evidence. `other_scale` weighs them against a scale that no sensor has (a
wrong unit, clock or filter). A bias that changes within the log is taken for a grade that changes.
"""

import math
from dataclasses import dataclass
from itertools import product
from typing import NamedTuple

import numpy as np

from calib.base.arrays import Array, Mask
from calib.base.intervals import Mixture, second_difference_model, weigh_hypotheses
from calib.base.names import G
from calib.car.beliefs import SENSOR
from calib.car.braking import BITE
from calib.run.blocks import Blocks
from calib.run.driving_record import GREATEST_Z
from calib.run.filters import centred_mean, recursive_filter, samples_in
from calib.run.speed_delay import CHANGING, EVEN, ODDS_ROAD

_PRESENT, _ABSENT = np.array([0.03, 0.05, 0.03]), np.array([0.0015, 0.002, 0.002])
"""Sigma of bias, grade and drag [g], present and absent. A mounting 2 degrees off makes 0.035 g, a
road of 4 % 0.04 g, a mountain road 0.15 g, an engine in gear at 2000 rpm 0.02 to 0.05 g."""
_ODDS = np.array([0.15, 0.3, 0.15, ODDS_ROAD[1]])  # prior chances of bias, grade, drag and walk
_OTHER_SCALE, _ODDS_OTHER = 0.3, 3e-4
"""Sigma of c where a unit, a clock or a filter is wrong, and the prior odds of that. With these
odds a sharp c counts as wrong from 9 % on: a clock of 110 Hz taken for 100 makes 10 %."""
_ROLLING, _DRAG, _RESISTS = 0.011, 2.7e-5, 0.3
"""Resistance of a usual car over its weight: rolling [1], and by the speed squared [s^2/m^2] of
0.66 m^2 and 1500 kg; relative standard deviation of both [1]."""
_LAG = 0.02  # sigma of the lag between v and a_x [s]; `calib.plausibility` looks for larger ones
_AVERAGING = 1.0  # time over which a_x and v are averaged [s]: the noise of v is then 0.002 g
_MULTIPLE = 4  # the number of compared steps is a multiple of this: of 0.2 s
_CASES = np.array(list(product((False, True), repeat=4)))
"""Whether bias, grade, drag and a walk are present (16, 4); every second case has a walk."""
_SENSED = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 1.0, 0.0], [0.0, 1.0, 0.0, 1.0]])
"""Matrix from c, bias, grade, drag to what is measured: c, e = bias + grade, d = bias + drag."""


@dataclass(frozen=True)
class Accelerometer:
    """Scale and offset of the accelerometer from a whole run."""

    scale: float  # c [1]
    bias: float  # [g]
    variance_scale: float
    variance_bias: float
    covariance: float
    drag: float  # beside the known resistance [g]
    walk_probability: float  # of a grade that changes at random [1]
    disagreement: float  # largest less least mean over 1 s of the corrected z plus (dv/dt)/g [g]

    def corrected(self, z: Array) -> Array:
        """Deceleration [1] that the tyres feel, from z [1] as read, (k,)."""
        return np.asarray((z - self.bias) * (1.0 - self.scale))

    def sigma(self, z: Array) -> Array:
        """Standard deviation of the corrected z [1]."""
        variance = self.variance_scale * z**2 + self.variance_bias + 2.0 * self.covariance * z
        return np.asarray(np.sqrt(np.maximum(variance, 0.0)))


class _Evidence(NamedTuple):
    """Normal equations of (c, e = bias + grade, d = bias + drag) from v, the lag eliminated."""

    precision: Array  # (3, 3), 0 for d
    vector: Array  # (3,), 0 for d
    likelihood: float  # ln of the likelihood at c = e = d = 0, up to a constant


@dataclass(frozen=True)
class SpeedEvidence:
    """What v shows of the accelerometer, whatever the resistance of the car."""

    blocks: Blocks
    last: int  # the first ``last`` steps from block to block are compared
    density_z: float  # noise of z [s^0.5]
    by_road: tuple[_Evidence, ...]  # without and with a walk


def speed_evidence(
    b: Blocks, density_z: float, density_v: float, smooth: Array | None = None
) -> SpeedEvidence:
    """Compare a_x with v, whose noise is ``density_z`` [s^0.5] and ``density_v`` [m/s s^0.5].

    Scale and lag are regressed on ``smooth`` z [1] (k,), if given, else on z.
    """
    last = (b.end.size - 1) // _MULTIPLE * _MULTIPLE
    by_road: tuple[_Evidence, ...] = (_Evidence(np.zeros((3, 3)), np.zeros(3), 0.0),) * 2
    if b.v is not None:
        rows = _differences(b, b.v, b.z if smooth is None else smooth)
        noise = density_z, density_v
        by_road = tuple(_against_speed(b.length, rows, last, q, noise) for q in (EVEN, CHANGING))
    return SpeedEvidence(b, last, density_z, by_road)


def accelerometer(evidence: SpeedEvidence, unexplained: Array, sigma: Array) -> Accelerometer:
    """Estimate scale and offset from the ``evidence`` of v and from the lead-in.

    ``unexplained`` (k,) is z less the known resistance [1]. ``sigma`` (k,) is that of the known
    resistance [1], whose error is common to the log.
    """
    rolling = _on_lead_in(evidence, unexplained, sigma)
    weighed = _mixture(evidence.by_road, rolling, _CASES, SENSOR.a_x_scale.sigma)
    c, bias, _, drag = weighed.mean.tolist()
    return Accelerometer(
        scale=c,
        bias=bias,
        variance_scale=float(weighed.covariance[0, 0]),
        variance_bias=float(weighed.covariance[1, 1]),
        covariance=float(weighed.covariance[0, 1]),
        drag=drag,
        walk_probability=float(weighed.weights[1::2].sum()),
        disagreement=_disagreement(evidence.blocks, c, evidence.last),
    )


def other_scale(b: Blocks, density_z: float, density_v: float) -> float:
    """Return the scale c [1] of a wrong unit, clock or filter; 0 if a sensor's scale is likelier.

    The result is also 0 without ``v`` or a braking. The resistance is that of a usual car. A walk
    would explain such a scale and is excluded. The regressor of c is averaged over `_AVERAGING`:
    noise that is in both the regressor and the integral would pull c towards 1.
    """
    if b.v is None or not np.any(np.maximum(b.p_f, b.p_r) > BITE):
        return 0.0
    slow = centred_mean(b.z, samples_in(_AVERAGING, b.length))
    evidence = speed_evidence(b, density_z, density_v, slow)
    resistance = _ROLLING + _DRAG * b.speed**2
    rolling = _on_lead_in(evidence, b.z - resistance, _RESISTS * resistance)
    other = _mixture(evidence.by_road, rolling, _CASES[::2], _OTHER_SCALE)
    sensor = _mixture(evidence.by_road, rolling, _CASES, SENSOR.a_x_scale.sigma)
    likelier = other.evidence + np.log(_ODDS_OTHER) > sensor.evidence
    return float(other.mean[0]) if likelier else 0.0


def _usable(b: Blocks, apart: int) -> Mask:
    """Pairs of blocks ``apart``, (k - apart,), in both of which the car moves without a glitch."""
    usable = (b.speed > 2.0) & (np.abs(b.z) < GREATEST_Z)
    return np.asarray(usable[apart:] & usable[:-apart])


def _differences(b: Blocks, v: Array, smooth: Array) -> tuple[Array, Mask]:
    """Second differences of the equation of v, (4, k - 1), and where they are usable (k - 1,).

    The rows are those of v + g int z dt, and of the factors of c, bias + grade and lag. The first
    column has first differences.
    """
    gained, scaled = (G * 0.5 * b.length * (z[1:] + z[:-1]) for z in (b.z, smooth))
    usable = _usable(b, 1)
    slope = np.full(gained.size, G * b.length)
    rows = np.stack([np.diff(v) + gained, scaled, slope, G * np.diff(smooth)])
    usable = usable & np.concatenate([[True], usable[:-1]])
    return np.where(usable, np.diff(rows, axis=1, prepend=0.0), 0.0), usable


def _against_speed(
    h: float,
    differences: tuple[Array, Mask],
    last: int,
    grade_walk: float,
    densities: tuple[float, float],
) -> _Evidence:
    """Compare v with the integral of z over the first ``last`` steps between blocks of ``h`` [s].

    The noise of v is white, that of the integral is a random walk, and the grade walks by
    ``grade_walk`` [g/s^0.5]; ``densities`` are those of z and v. Second differences are then a
    moving average of order two, which a filter makes white. The grade in e is that at the start.
    """
    white, walk = densities[1] ** 2 / h, (G * densities[0]) ** 2 * h
    columns, usable = differences
    average, sigma = second_difference_model(white, walk, (G * h * grade_walk) ** 2 * h)
    start = np.zeros_like(columns[:1])
    start[0, :2] = -1.0, 1.0  # effect of the noise of the first v, the reference of all others
    rows = recursive_filter(np.concatenate([columns, start]), average)[:, :last] / sigma
    products = rows @ rows.T  # (5, 5): measurement, c, e, lag, start
    likelihood = -0.5 * float(products[0, 0]) - np.count_nonzero(usable[:last]) * math.log(sigma)
    matrix, right_side, by_start = _without_last(products[1:, 1:], products[1:, 0], white)
    precision, vector = np.zeros((3, 3)), np.zeros(3)
    precision[:2, :2], vector[:2], by_lag = _without_last(matrix, right_side, _LAG**2)
    return _Evidence(precision, vector, likelihood + by_start + by_lag)


def _without_last(matrix: Array, right_side: Array, variance: float) -> tuple[Array, Array, float]:
    """Eliminate the last unknown, of prior ``variance``; return also its part of ln likelihood."""
    coupling, last = matrix[:-1, -1], right_side[-1]
    curvature = matrix[-1, -1] + 1.0 / variance
    reduced = matrix[:-1, :-1] - np.outer(coupling, coupling) / curvature
    added = float(0.5 * (last**2 / curvature - np.log(curvature)))
    return reduced, right_side[:-1] - coupling * last / curvature, added


def _on_lead_in(evidence: SpeedEvidence, unexplained: Array, sigma: Array) -> tuple[float, float]:
    """Mean of ``unexplained`` over the lead-in [1], and its variance, infinite without one."""
    b, use = evidence.blocks, slice(evidence.last + 1)
    rolling = (b.lead_in & (b.speed > 3.0))[use]
    count = np.count_nonzero(rolling)
    if count == 0:
        return 0.0, np.inf
    mean, common = (float(np.mean(x[use][rolling])) for x in (unexplained, sigma))
    return mean, evidence.density_z**2 / (count * b.length) + common**2


def _mixture(
    by_road: tuple[_Evidence, ...], rolling: tuple[float, float], present: Mask, scale: float
) -> Mixture:
    """Posterior of (c, bias, grade, drag), a mixture over the cases ``present`` (k, 4).

    ``rolling`` is mean and variance of d = bias + drag on the lead-in, ``scale`` the sigma of c.
    """
    precision, vector, likelihood = map(np.array, zip(*by_road, strict=True))
    precision[:, 2, 2] += 1.0 / rolling[1]
    vector[:, 2] += rolling[0] / rolling[1]
    walks = present[:, 3].astype(int)  # of each case, the index in ``by_road``
    return weigh_hypotheses(
        (_SENSED.T @ precision @ _SENSED)[walks],
        (vector @ _SENSED)[walks],
        np.insert(np.where(present[:, :3], _PRESENT, _ABSENT), 0, scale, axis=1),
        np.where(present, _ODDS, 1.0 - _ODDS).prod(axis=1),
        likelihood[walks],
    )


def _disagreement(b: Blocks, scale: float, last: int) -> float:
    """`Accelerometer.disagreement` with a z that is corrected for ``scale``."""
    n = max(round(_AVERAGING / b.length), 1)
    if b.v is None or last < n:
        return 0.0
    rise_of_v = (b.v[n:last] - b.v[: last - n]) / (G * n * b.length)
    total = np.concatenate([[0.0], np.cumsum(0.5 * (b.z[1:] + b.z[:-1]))])[:last]
    mean_z = (total[n:] - total[:-n]) / n
    usable = _usable(b, n)[: last - n]
    return float(np.ptp((rise_of_v + mean_z * (1.0 - scale))[usable])) if usable.any() else 0.0
