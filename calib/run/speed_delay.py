r"""Delay of the reference speed, 0.1 to 0.3 s for a satellite receiver.

    v read(t) = v_0 + (1 + c) I(t - tau) + e t        I = int a_x dt

    a_x   ------\______        v   --------\                the corner at the bite, and all that
                                            \               z does after it, come tau later
    scale c and slope e do not move a corner, so tau can be separated from them

A v on the bus of the other channels has a delay of sigma `USUAL`, the remainder is a state of the
filter. A late v has any delay up to `_LATEST`, constant over the log. Both hypotheses are weighed
by their likelihood. A late v is replaced by v(t + tau).

Wrong where the wheel speeds are as late as v, or the filter of a_x is slower than that of v.
"""

from dataclasses import dataclass, replace

import numpy as np

from calib.base.arrays import Array, Mask
from calib.base.intervals import second_differences, white_noise
from calib.base.names import G
from calib.car.lag import integral
from calib.run.driving_record import GREATEST
from calib.run.filters import block_mean, recursive, samples_in

_BLOCK = 0.05  # length of the means that are compared [s]

USUAL = 0.02
"""One sigma [s] of the delay of a v on the bus of the other channels."""

_LATEST = 0.5
"""Greatest delay [s] that is tried: receivers have 0.1 to 0.3 s, slow filters more. v within this
time of the start may be from before the log, and is not compared."""

_ODDS = 0.05  # prior odds of a late v: few take v from a receiver

_SCALE = 0.05
"""One sigma of the scale of a_x [1], wider than that of a sensor, so that no delay has to explain a
wrong scale."""

EVEN, CHANGING = 0.0002, 0.015
"""Random walk of the grade in a second [g/s^0.5]: tracks are even to 1 mm in 2 m; a crest of 6 km
radius changes it by 0.005 at 30 m/s, a bridge or a ramp by 0.02."""

ODDS_ROAD = np.array([0.97, 0.03])
"""Prior probability of a constant and a changing slope on roads that are chosen for such runs."""

_BRAKES = 1.5  # least deceleration that shows a delay [m/s^2]

_LIKELY, _SURE = 0.3, 0.95
"""Probability of a late v from which it is not used as read, and from which it is corrected."""

_STEP = 0.01  # of the delays that are tried [s]: half of `_SHARP`

_SHARP = 0.02
"""Sigma of a delay [s] from which v is left out instead of shifted: at 0.5 g it makes 0.1 m/s, a
tenth of the slip."""


@dataclass(frozen=True)
class SpeedDelay:
    """Delay of v [s], its ``sigma``, and the probability ``chance`` that v is late at all."""

    value: float
    sigma: float
    chance: float

    @property
    def late(self) -> bool:
        """Whether v must not be used as read."""
        return self.chance > _LIKELY

    @property
    def sharp(self) -> bool:
        """Whether the delay may be corrected."""
        return self.sigma < _SHARP and self.chance > _SURE


IN_TIME = SpeedDelay(0.0, USUAL, chance=0.0)


def speed_delay(time: Array, v: Array, a_x: Array, step: float) -> SpeedDelay:
    """Delay of ``v`` [m/s] against ``a_x`` [m/s^2]; ``time`` [s], all (n,), ``step`` [s]."""
    even = _DelayEvidence.from_signals(time, v, a_x, step)
    if even is None or abs(even.first()) < 2.0 * USUAL:
        return IN_TIME
    tried = np.arange(-5.0 * USUAL, _LATEST + 0.5 * _STEP, _STEP)
    roads = even, even.on_road(CHANGING)
    misfit = np.array([[road.misfit(delay) for delay in tried] for road in roads])
    count = np.count_nonzero(even.usable)
    noisier = max(misfit.min() / max(count, 1), 1.0)  # noise beyond that of the medians
    likelihood = -0.5 * misfit / noisier - count * np.log([[road.sigma] for road in roads])
    likelihood = np.logaddexp(*(likelihood - likelihood.max() + np.log(ODDS_ROAD)[:, None]))
    usual = np.exp(likelihood - 0.5 * (tried / USUAL) ** 2) / (USUAL * np.sqrt(2.0 * np.pi))
    late = np.exp(likelihood) * (tried > 0.0) / _LATEST
    chance = float(_ODDS * late.sum() / (usual.sum() + _ODDS * late.sum()))
    if chance < _LIKELY:
        return IN_TIME
    value = float(late @ tried / late.sum())
    variance = float(late @ (tried - value) ** 2 / late.sum()) + _STEP**2 / 12.0
    return SpeedDelay(value, float(np.sqrt(variance)), chance)


def in_time(time: Array, v: Array, a_x: Array, delay: SpeedDelay) -> Array:
    """A late v [m/s] (n,) with its delay corrected; a_x extrapolates it at the end."""
    gained = integral(time, a_x)
    later = time + delay.value
    after = gained - np.interp(time[-1] - delay.value, time, gained)
    return np.where(later <= time[-1], np.interp(later, time, v), v[-1] + after)


@dataclass(frozen=True)
class _DelayEvidence:
    """v (k,) by blocks of ``size`` samples and ``length`` [s], and the integral of a_x (n,).

    ``noise`` variance of v and of a step of the integral [m^2/s^2]; ``average`` and ``sigma``
    whiten second differences; ``begins`` (k - 2, 2) spans the unknown v and slope at the start.
    """

    time: Array
    gained: Array
    v: Array
    usable: Mask
    size: int
    length: float
    noise: tuple[float, float]
    average: Array
    sigma: float
    begins: Array

    @classmethod
    def from_signals(
        cls, time: Array, v: Array, a_x: Array, step: float
    ) -> "_DelayEvidence | None":
        """Evidence on an even road; None where the log is short or brakes too little."""
        size = samples_in(_BLOCK, step)
        means, slowing = block_mean(v, size), block_mean(a_x, size)
        if means.size < 20 or np.min(slowing) > -_BRAKES:
            return None
        h = size * step
        white, walk = (max(white_noise(x, 2) ** 2, 1e-12) for x in (means, h * slowing))
        usable = (means > 2.0) & (np.abs(slowing) < GREATEST * G)
        usable &= h * np.arange(means.size) >= _LATEST
        usable = usable[2:] & usable[1:-1] & usable[:-2]
        none, gained = np.zeros(1), integral(time, a_x)
        evidence = cls(time, gained, means, usable, size, h, (white, walk), none, 1.0, none)
        return evidence.on_road(EVEN)

    def on_road(self, walks: float) -> "_DelayEvidence":
        """The same on a road whose slope walks by ``walks`` [g/s^0.5]."""
        turned = (G * self.length * walks) ** 2 * self.length
        average, sigma = second_differences(*self.noise, turned)
        first = np.eye(self.usable.size, 2, -int(np.argmax(self.usable)))
        begins = np.linalg.qr(recursive(first.T, average).T)[0]
        return replace(self, average=average, sigma=sigma, begins=begins)

    def first(self) -> float:
        """Delay by one Gauss-Newton step from 0 [s], to exclude cheaply that there is one."""
        y, x = self._white(0.0)
        shift = self._filtered(block_mean(-np.gradient(self.gained, self.time), self.size))
        A = np.column_stack([x, shift])
        precision = A.T @ A + np.diag([_SCALE**-2, _LATEST**-2])
        return float(np.linalg.solve(precision, A.T @ y)[1])

    def misfit(self, delay: float) -> float:
        """Residual sum of squares over the noise at a ``delay`` [s], with the best scale."""
        y, x = self._white(delay)
        return float(y @ y - (x @ y) ** 2 / (float(x @ x) + _SCALE**-2))

    def _white(self, delay: float) -> tuple[Array, Array]:
        """Difference of v and the column of the scale, whitened to sigma 1, (k - 2,)."""
        gained = block_mean(np.interp(self.time - delay, self.time, self.gained), self.size)
        return self._filtered(self.v - gained), self._filtered(gained)

    def _filtered(self, x: Array) -> Array:
        white = recursive(np.where(self.usable, np.diff(x, 2), 0.0), self.average)
        white -= self.begins @ (self.begins.T @ white)
        return np.asarray(white / self.sigma)
