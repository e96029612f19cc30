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

from dataclasses import dataclass
from itertools import product
from typing import NamedTuple

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.base.mixtures import Mixture, weigh_hypotheses
from calib.base.names import G
from calib.base.noise import second_differences
from calib.car.beliefs import SENSOR
from calib.car.braking import BITE
from calib.run.blocks import Blocks
from calib.run.filters import centred_mean
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

_LAG = 0.02  # how far v and a_x may be out of step [s]
_GREATEST = 1.5  # deceleration that no road car reaches [1]: the block holds a glitch of a_x
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
    with ``variance_lag``. ``wanders`` [1] how likely the grade changes on the way; ``other_scale``
    [1] the scale where it is likelier that of a unit or a clock than of a sensor, else 0.
    ``disagrees`` [g] how much a_x and the slowing of v differ by turns, over a second, the scale
    aside.
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
    other_scale: float
    disagrees: float

    def corrected(self, z: Array) -> Array:
        """Deceleration [1] that the tyres feel, from z [1] as read, (k,)."""
        return np.asarray((z - self.bias) * (1.0 - self.scale))

    def sigma(self, z: Array) -> Array:
        """Standard deviation of the corrected z [1]."""
        variance = self.variance_scale * z**2 + self.variance_bias + 2.0 * self.covariance * z
        return np.asarray(np.sqrt(np.maximum(variance, 0.0)))


class _Reading(NamedTuple):
    """What is judged; as `accelerometer` takes it."""

    b: Blocks
    unexplained: Array
    sigma: Array
    density_z: float
    density_v: float


def accelerometer(
    b: Blocks,
    unexplained: Array,
    sigma: Array,
    density_z: float,
    density_v: float,
) -> Accelerometer:
    """Judge the accelerometer of a log.

    ``unexplained`` z less what the known resistance explains of it, read on the lead-in only, and
    ``sigma`` of that resistance, common to the log [1], (k,); ``density_z`` [s^0.5], ``density_v``
    [m/s s^0.5] noise.
    """
    at = np.array([(b.end.size - 1) // _STEP * _STEP])
    read = _Reading(b, unexplained, sigma, density_z, density_v)
    speeds, evidence = _evidence(read, b.z, at)
    weighed = _mixture(evidence, _CASES, SENSOR.a_x_scale.sigma)
    c, bias, _, drag = weighed.mean.T
    wanders = weighed.weights[:, 1::2].sum(axis=1)
    lags = [s.lag_of(weighed) for s in speeds]
    lag, variance_lag = ((1.0 - wanders) * x + wanders * y for x, y in zip(*lags, strict=True))
    variance_lag += (1.0 - wanders) * wanders * (lags[1][0] - lags[0][0]) ** 2
    braked = np.any(np.maximum(b.p_f, b.p_r) > BITE)  # rolling, z is noise for the most part
    other = _other_scale(read, at) if braked and b.v is not None else 0.0
    covariance = weighed.covariance[0]
    return Accelerometer(
        scale=float(c[0]),
        bias=float(bias[0]),
        variance_scale=float(covariance[0, 0]),
        variance_bias=float(covariance[1, 1]),
        covariance=float(covariance[0, 1]),
        drag=float(drag[0]),
        lag=float(lag[0]),
        variance_lag=float(variance_lag[0]),
        wanders=float(wanders[0]),
        other_scale=other,
        disagrees=_disagreement(b, float(c[0]), int(at[0])),
    )


_Evidence = tuple[Array, Array, Array]
"""Of a steady grade and of one that walks: precision (m, 2, 3, 3), vector (m, 2, 3) of (c, e, d),
logarithm of the likelihood where they are zero (m, 2)."""


def _evidence(read: _Reading, smooth: Array, at: Index) -> tuple[list["_AgainstSpeed"], _Evidence]:
    """What v and the lead-in say at ``at`` (m,); e = bias + grade, d = bias + drag."""
    compared = _compared(read.b, smooth)
    speeds = [_against_speed(read, compared, at, walk) for walk in (EVEN, CHANGING)]
    d, variance_d = _on_lead_in(read, at)
    precision, vector, likelihood = (
        np.stack([getattr(s, name) for s in speeds], 1)
        for name in ("precision", "vector", "likelihood")
    )
    precision[..., 2, 2] += 1.0 / variance_d[:, None]
    vector[..., 2] += (d / variance_d)[:, None]
    return speeds, (precision, vector, likelihood)


@dataclass(frozen=True)
class _AgainstSpeed:
    """What v says of (c, e, d) with the lag taken out, and of the lag where (c, e) are known.

    ``precision`` (m, 3, 3), ``vector`` (m, 3); ``likelihood`` (m,) its logarithm where c, e and d
    are zero, up to a constant; of the lag ``own`` precision [1/s^2], ``side`` [1/s] and ``along``
    (c, e), (m, 2), how the lag moves with them [1/s].
    """

    precision: Array
    vector: Array
    likelihood: Array
    own: Array
    side: Array
    along: Array

    def lag_of(self, weighed: Mixture) -> tuple[Array, Array]:
        """Time by which a_x comes after v [s], and its variance, (m,)."""
        moved = weighed.mean @ _SENSED.T[:, :2]
        covariance = _SENSED[:2] @ weighed.covariance @ _SENSED[:2].T
        lag = (self.side - np.sum(self.along * moved, axis=1)) / self.own
        spread = np.einsum("mi,mij,mj->m", self.along, covariance, self.along)
        return -lag, 1.0 / self.own + spread / self.own**2


def _usable(b: Blocks) -> Mask:
    """Blocks (k,) in which v and a_x are compared: the car moves, and a_x has no glitch."""
    return np.asarray((b.speed > 2.0) & (np.abs(b.z) < _GREATEST))


def _compared(b: Blocks, smooth: Array) -> tuple[Array, Mask] | None:
    """Second differences of v + g int z dt, and what c, e and the lag make of it, (4, k - 1).

    And where they are to be used, (k - 1,). None without v. ``smooth`` z [1], (k,), tells scale and
    lag.
    """
    if b.v is None:
        return None
    gained, scaled = (G * 0.5 * b.length * (z[1:] + z[:-1]) for z in (b.z, smooth))
    usable = _usable(b)
    usable = usable[1:] & usable[:-1]
    columns = np.stack(
        [np.diff(b.v) + gained, scaled, np.full(gained.size, G * b.length), G * np.diff(smooth)]
    )
    usable = usable & np.concatenate([[True], usable[:-1]])
    return np.where(usable, np.diff(columns, axis=1, prepend=0.0), 0.0), usable


def _against_speed(
    read: _Reading, compared: tuple[Array, Mask] | None, at: Index, wander: float
) -> _AgainstSpeed:
    """Information about (c, e, d) and the lag from v against the integral of z, at ``at``.

    The noise of v is white and that of the integral a random walk, and the grade walks by
    ``wander`` [g/s^0.5]: second differences are then a moving average of order two, which a filter
    makes white. e is that at the start.
    """
    precision, vector = np.zeros((at.size, 3, 3)), np.zeros((at.size, 3))
    if compared is None:
        none = np.zeros(at.size)
        along = np.zeros((at.size, 2))
        return _AgainstSpeed(precision, vector, none, none + _LAG**-2.0, none, along)
    from scipy.signal import lfilter

    h = read.b.length
    white, walk = read.density_v**2 / h, (G * read.density_z) ** 2 * h
    columns, usable = compared
    average, sigma = second_differences(white, walk, (G * h * wander) ** 2 * h)
    start = np.zeros_like(columns[:1])
    start[0, :2] = -1.0, 1.0  # the noise of the first v, which all others are compared with
    y, *known = lfilter([1.0], average, np.concatenate([columns, start])) / sigma
    X = np.stack(known)
    pair, side = _so_far(X[:, None] * X)[..., at], _so_far(X * y)[..., at]
    likelihood = -_so_far(0.5 * y**2 + usable * np.log(sigma))[at]
    # the shares of the start and of the lag are taken out with their priors
    for last, variance in ((3, white), (2, _LAG**2)):
        own, along, right = pair[last, last] + 1.0 / variance, pair[:last, last], side[last]
        likelihood += 0.5 * (right**2 / own - np.log(own))
        pair = pair[:last, :last] - along[:, None] * along[None, :] / own
        side = side[:last] - along * right / own
    precision[:, :2, :2], vector[:, :2] = np.moveaxis(pair, -1, 0), side.T
    return _AgainstSpeed(precision, vector, likelihood, own, right, along.T)


def _so_far(x: Array) -> Array:
    """Sums of a step-to-step quantity (..., k - 1) up to each block: none for the first."""
    return np.insert(np.cumsum(x, axis=-1), 0, 0.0, axis=-1)


def _on_lead_in(read: _Reading, at: Index) -> tuple[Array, Array]:
    """Mean of ``unexplained`` over the lead-in so far, and its variance [1]; inf without any."""
    b = read.b
    free = b.lead_in & (b.speed > 3.0)
    count = np.cumsum(free)
    some = np.maximum(count, 1)
    mean, common = (
        np.cumsum(np.where(free, x, 0.0)) / some for x in (read.unexplained, read.sigma)
    )
    variance = read.density_z**2 / (some * b.length) + common**2
    return mean[at], np.where(count > 0, variance, np.inf)[at]


def _other_scale(read: _Reading, last: Index) -> float:
    """The scale over all of the run where it is likelier that of no sensor, else 0.

    Without a grade that walks, which explains what such a scale does. It takes no part in what is
    corrected: a run with such a scale is not used. By means of z over `_SECOND`: the noise of a_x
    is in the integral and in what a scale makes of it alike, and looks like a scale of 1.
    """
    slow = centred_mean(read.b.z, max(1, round(_SECOND / read.b.length)))
    _, evidence = _evidence(read, slow, last)
    other = _mixture(evidence, _CASES[::2], _OTHER_SCALE)
    sensor = _mixture(evidence, _CASES, SENSOR.a_x_scale.sigma)
    likelier = other.evidence + np.log(_ODDS_OTHER) > sensor.evidence
    return float(other.mean[0, 0]) if likelier[0] else 0.0


def _mixture(evidence: _Evidence, there: Mask, scale: float) -> Mixture:
    """Mixture over the cases of (c, bias, grade, drag), ``there`` (k, 4) as in `_CASES`."""
    spread = np.where(there[:, :3], _THERE, _STILL)
    walks = there[:, 3].astype(int)
    precision, vector, likelihood = evidence
    return weigh_hypotheses(
        (_SENSED.T @ precision @ _SENSED)[:, walks],
        (vector @ _SENSED)[:, walks],
        np.column_stack([np.full(len(there), scale), spread]),
        np.where(there, _ODDS, 1.0 - _ODDS).prod(axis=1),
        likelihood[:, walks],
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
    usable = _usable(b)[:last]
    usable = usable[whole:] & usable[:-whole]
    return float(np.ptp((lost + mean * (1.0 - scale))[usable])) if usable.any() else 0.0
