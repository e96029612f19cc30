r"""Delay of the reference speed v, 0.1 to 0.3 s for a satellite receiver.

    v read(t) = v_0 + (1 + c) I(t - tau) + e t        I = int a_x dt

    a_x   ------\______        v   --------\                v has a corner at the bite, tau later
                                            \               than a_x; so has all that follows

The scale error c of a_x and the slope e (bias and grade) do not move a corner, so the delay tau can
be separated from them. Two hypotheses are weighed by their likelihood: a v in time, on the bus of
the other channels, whose delay has the standard deviation `USUAL`; and a late v, with any delay up
to `_LATEST`, constant over the log. A late v is replaced by v(t + tau).

Wrong where the wheel speeds are as late as v, or the filter of a_x is slower than that of v.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from calib.base.arrays import Array, Mask
from calib.base.intervals import second_difference_model, white_noise
from calib.base.names import G
from calib.car.lag import integral
from calib.run.driving_record import GREATEST_Z
from calib.run.filters import block_mean, recursive_filter, samples_in

_BLOCK = 0.05  # length of the means that are compared [s]
USUAL = 0.02  # standard deviation of the delay of a v in time [s]
_LATEST = 0.5
"""Greatest delay that is tried [s]: slow filters have more than the 0.3 s of receivers. v within
this time of the start may be from before the log, and is not compared."""
_ODDS = 0.05  # prior odds of a late v: few take v from a receiver
_SCALE = 0.05  # sigma of c [1]: wider than a sensor's, so that no delay stands for a wrong scale
EVEN, CHANGING = 0.0002, 0.015
"""Random walk of the grade on an even and on a changing road [g/s^0.5]: tracks are even to 1 mm in
2 m; a crest of 6 km radius changes the grade by 0.005 a second at 30 m/s, a bridge by 0.02."""
ODDS_ROAD = np.array([0.97, 0.03])  # prior chances of an even and a changing road
_BRAKES = 1.5  # least deceleration that shows a delay [m/s^2]
_LIKELY = 0.3  # chance of a late v from which v is not used as read
_SURE = 0.95  # chance of a late v from which it may be corrected
_STEP = 0.01  # step of the delays that are tried [s]: half of `_SHARP`
_SHARP = 0.02
"""Standard deviation of a delay [s] below which a late v is corrected; else v is not used. At 0.5 g
it makes 0.1 m/s, a tenth of the slip."""


@dataclass(frozen=True)
class SpeedDelay:
    """Delay of v, ``value`` with ``sigma`` [s], and the probability ``chance`` that v is late."""

    value: float
    sigma: float
    chance: float

    @property
    def late(self) -> bool:
        """Whether v must not be used as read."""
        return self.chance > _LIKELY

    @property
    def sharp(self) -> bool:
        """Whether the delay is known well enough to be corrected."""
        return self.sigma < _SHARP and self.chance > _SURE


IN_TIME = SpeedDelay(0.0, USUAL, chance=0.0)


def speed_delay(time: Array, v: Array, a_x: Array, step: float) -> SpeedDelay:
    """Estimate the delay of ``v`` [m/s] after ``a_x`` [m/s^2], as in the head of the file.

    ``time`` [s] and the signals are (n,), ``step`` is the sample time [s]. The result is `IN_TIME`
    for a v that is likely in time, and where the log does not show a delay.
    """
    even = _DelayEvidence.from_signals(time, v, a_x, step)
    if even is None or abs(even.first_guess()) < 2.0 * USUAL:
        return IN_TIME
    tried = np.arange(-5.0 * USUAL, _LATEST + 0.5 * _STEP, _STEP)  # (m,)
    roads = even, replace(even, grade_walk=CHANGING)
    misfit = np.array([[road.misfit(delay) for delay in tried] for road in roads])  # (2, m)
    count = np.count_nonzero(even.usable)
    excess = max(misfit.min() / max(count, 1), 1.0)  # variance of the noise over the assumed one
    sigma = np.array([[road.whitening[1]] for road in roads])  # (2, 1)
    by_road = -0.5 * misfit / excess - count * np.log(sigma)  # log-likelihoods (2, m)
    by_road = by_road - by_road.max() + np.log(ODDS_ROAD)[:, None]
    log_likelihood = np.logaddexp(*by_road)  # (m,), the road marginalised
    # likelihood times prior density of a v in time, normal, and of a late v, uniform
    usual = np.exp(log_likelihood - 0.5 * (tried / USUAL) ** 2) / (USUAL * np.sqrt(2.0 * np.pi))
    late = np.exp(log_likelihood) * (tried > 0.0) / _LATEST
    chance = float(_ODDS * late.sum() / (usual.sum() + _ODDS * late.sum()))
    if chance < _LIKELY:
        return IN_TIME
    value = float(late @ tried / late.sum())
    variance = float(late @ (tried - value) ** 2 / late.sum()) + _STEP**2 / 12.0
    return SpeedDelay(value, float(np.sqrt(variance)), chance)


def in_time(time: Array, v: Array, a_x: Array, delay: SpeedDelay) -> Array:
    """Return v(t + tau) [m/s] (n,) of a late v, at the end extrapolated by the integral of a_x."""
    gained = integral(time, a_x)
    later = time + delay.value
    gained_after_end = gained - np.interp(time[-1] - delay.value, time, gained)
    return np.where(later <= time[-1], np.interp(later, time, v), v[-1] + gained_after_end)


@dataclass(frozen=True)
class _DelayEvidence:
    """Block means of v, to be compared with those of the integral of a_x at a delay."""

    time: Array  # [s] (n,)
    gained: Array  # integral of a_x [m/s] (n,)
    v: Array  # block means [m/s] (k,)
    usable: Mask  # where second differences are compared (k - 2,)
    size: int  # samples of a block
    length: float  # of a block [s]
    noise: tuple[float, float]  # variances of v, and of the integral over one block [m^2/s^2]
    grade_walk: float = EVEN  # random walk of the road's grade [g/s^0.5]

    @classmethod
    def from_signals(
        cls, time: Array, v: Array, a_x: Array, step: float
    ) -> "_DelayEvidence | None":
        """Evidence on an even road; None where the log is short or brakes too little."""
        size = samples_in(_BLOCK, step)
        means, a_x_means = block_mean(v, size), block_mean(a_x, size)
        if means.size < 20 or np.min(a_x_means) > -_BRAKES:
            return None
        length = size * step
        white, walk = (max(white_noise(x, 2) ** 2, 1e-12) for x in (means, length * a_x_means))
        usable = (means > 2.0) & (np.abs(a_x_means) < GREATEST_Z * G)
        usable &= length * np.arange(means.size) >= _LATEST
        usable = usable[2:] & usable[1:-1] & usable[:-2]
        return cls(time, integral(time, a_x), means, usable, size, length, (white, walk))

    @cached_property
    def whitening(self) -> tuple[Array, float, Array]:
        """Filter and sigma that make second differences white; basis (k - 2, 2) of v_0 and e."""
        grade = (G * self.length * self.grade_walk) ** 2 * self.length
        average, sigma = second_difference_model(*self.noise, grade)
        # v_0 and e, both unknown, change the usable differences `first` and `first` + 1 alone
        first = int(np.argmax(self.usable))
        changed = np.eye(self.usable.size, 2, -first)
        return average, sigma, np.linalg.qr(recursive_filter(changed.T, average).T)[0]

    def first_guess(self) -> float:
        """Delay [s] by one Gauss-Newton step from 0, which is cheaper than to try all delays."""
        y, x = self._white(0.0)
        by_delay = self._filtered(block_mean(-np.gradient(self.gained, self.time), self.size))
        A = np.column_stack([x, by_delay])
        precision = A.T @ A + np.diag([_SCALE**-2, _LATEST**-2])
        return float(np.linalg.solve(precision, A.T @ y)[1])

    def misfit(self, delay: float) -> float:
        """Residual sum of squares over the variance at a ``delay`` [s], with the best scale c."""
        y, x = self._white(delay)
        return float(y @ y - (x @ y) ** 2 / (float(x @ x) + _SCALE**-2))

    def _white(self, delay: float) -> tuple[Array, Array]:
        """Difference v - I(t - tau), and the factor I of the scale c, `_filtered`, (k - 2,)."""
        gained = block_mean(np.interp(self.time - delay, self.time, self.gained), self.size)
        return self._filtered(self.v - gained), self._filtered(gained)

    def _filtered(self, x: Array) -> Array:
        """Second differences of ``x`` (k,), white with sigma 1, without what v_0 and e explain."""
        average, sigma, basis = self.whitening
        white = recursive_filter(np.where(self.usable, np.diff(x, 2), 0.0), average)
        white -= basis @ (basis.T @ white)
        return np.asarray(white / sigma)
