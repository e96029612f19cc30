"""Mistakes that make v and the wheel speeds disagree: an offset, or a wrong clock of v.

    v = R (omega - offset + slip and growth of the tyre) + late
    v = v_0 - (scale of a_x) g int z dt + slope t + late
    late = g int z dt from (t - delay)/(1 + c) to t

over coasting, lead-in and braking, until a wheel is at its limit. Each hypothesis is a linear
Gaussian model with its own prior of the radius R, the offset, the rate error c of the clock of v,
and the road. Slip is a cubic of z and a steep term near the peak of the tyres; of the pressure
instead of z where that fits better, since near the peak it amplifies the noise of a_x.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from calib.base.arrays import Array, Mask
from calib.base.intervals import LIKELY_LOG_ODDS, posterior
from calib.base.names import AXLES, G
from calib.car.lag import integral
from calib.run.driving_record import DRIVEN_Z, GREATEST_Z, NOMINAL_RADIUS, SMOOTHING
from calib.run.filters import block_mean, samples_in
from calib.run.run import Run

OFFSET, CLOCK = "offset", "clock"

_FEWEST, _LASTING = 20, 4.0
"""Fewest means, and the factor on their variance for correlated errors [1]."""
_FILE, _USUAL, _CAR, _UNIT = 0.012, 0.08, 0.1, 3.0
"""Sigma of a radius over that of the vehicle file, of any radius, of one of another car, and of one
in another unit [1]."""
_STEEP, _GENTLE = 8, 0.1
"""Order in z of the steep term; least z to which it is scaled [1]."""
SLIP = ((0.04, 0.02), (0.01, 0.02), (0.0, 0.02), (0.0, 0.002), (0.0, 0.003))
"""Mean and sigma of the coefficients of slip: of z, its square, cube and steep term; and of the
growth of a tyre by the square of the wheel speed over 100 rad/s [1]."""
_SLIPPERY = ((0.12, 0.03), (0.1, 0.1), (0.4, 0.3), (0.03, 0.03), SLIP[-1])
"""The same on a wet road: a brush of stiffness K and peak m has (1 + z/(3 m) + 5 z^2/(27 m^2) ...)
z/K, over the load that it bears. K is 8 to 18, m 0.35 to 0.6. No sigma is above its mean, since
negative slip is that of a v that runs fast."""
_IN_TIME, _LATE, _FINEST = 0.05, (0.1, 0.2, 0.3, 0.4), 5e-3
"""Sigma of a delay, delays of a receiver or a slow filter [s]; least error of v [m/s]."""
_ROLLS = 0.2  # sigma of the slip of an unbraked axle over the usual one [1]
_A_X, _SCALE = ((0.0, 100.0), (0.0, 0.3), (0.0, 0.02)), 0.015
"""Mean and sigma of v_0 [m/s], of slope and zero of a_x [m/s^2], of their drift [m/s^3]; sigma of
the scale of a_x [1]."""
_SMALL, _LARGE = 0.3, (3.0, 30.0)  # sigma of a usual offset, and of mistakes of any size [rad/s]
_RATES, _NEAR, _STEADY = tuple(x / 100.0 for x in range(-10, 11, 2) if x), 0.01, 1e-3
"""Rate errors of a wrong clock, their sigma, and the sigma of a correct one [1]."""
_RARE, _RARER = math.log(0.05), math.log(0.01)  # prior odds of other explanations, of a mistake
_EXPLAINED = 1.4
"""The most that a mistake leaves of v over what free numbers leave [1]: true ones leave 0.4 to 1.0,
and 1.6 the best of those that stood for a peak which no hypothesis has."""


class SpeedMistake(NamedTuple):
    """A mistake of a ``kind``, with its size and sigma: an offset [rad/s], or a rate error [1].

    ``log_odds`` against all hypotheses without a mistake; ``radius`` of the wheels with it [m].
    """

    kind: str
    size: float
    sigma: float
    log_odds: float
    radius: float


def speed_mistakes(run: Run) -> dict[str, tuple[SpeedMistake, ...]]:
    """Mistakes that explain v, by axle, or by "" if both axles share them; most probable first."""
    car = run.vehicle
    radii = (car.front.rolling_radius, car.rear.rolling_radius) if car else (None, None)
    means = _Means.of_run(run)
    by_axle = {a: _mistakes(run, means, a, radius) for a, radius in zip(AXLES, radii, strict=True)}
    named = {axle: _named(mistakes) for axle, mistakes in by_axle.items()}
    named = {axle: mistakes for axle, mistakes in named.items() if mistakes}
    if not named:
        return {}
    likeliest = max(named.values(), key=lambda mistakes: mistakes[0].log_odds)
    alike = [m for mistakes in by_axle.values() for m in mistakes if m.kind == likeliest[0].kind]
    apart = np.ptp([m.size for m in alike]) > 3.0 * math.hypot(*(m.sigma for m in alike))
    return named if apart else {"": likeliest}


def _named(mistakes: list[SpeedMistake]) -> tuple[SpeedMistake, ...]:
    """The sure mistakes within `SURE` of the most probable one, which is first."""
    least = max([LIKELY_LOG_ODDS, *(m.log_odds - LIKELY_LOG_ODDS for m in mistakes)])
    near = (m for m in mistakes if m.log_odds > least)
    return tuple(sorted(near, key=lambda m: m.log_odds, reverse=True))


def _mistakes(run: Run, means: "_Means", axle: str, radius: float | None) -> list[SpeedMistake]:
    """Offset and clock by the wheels of an axle, whose ``radius`` [m] may be unknown.

    Empty for a short log, and for an axle that brakes alone, whose slip is unknown. A mistake that
    fits badly is left out.
    """
    if run.alone == axle or means.v.size < _FEWEST:
        return []
    speed = _AxleSpeed.of_axle(run, means, axle, radius or NOMINAL_RADIUS)
    fits = speed.fits(list(_beliefs(_FILE if radius else _USUAL)))
    sound = np.logaddexp.reduce([fit.log for fit in fits if not fit.belief.kind])
    mistakes = []
    for kind, place in ((OFFSET, 1), (CLOCK, -1)):
        of_kind = [fit for fit in fits if fit.belief.kind == kind]
        best = max(of_kind, key=lambda fit: fit.log)
        if _LASTING * best.misfit < _EXPLAINED * means.v.size:
            log_odds = float(np.logaddexp.reduce([fit.log for fit in of_kind]) - sound)
            sigma = math.sqrt(best.covariance[place, place])
            size, scale = float(best.unknowns[place]), float(best.unknowns[0])
            mistakes.append(SpeedMistake(kind, size, sigma, log_odds, speed.radius * scale))
    return mistakes


class _Belief(NamedTuple):
    """Prior of a hypothesis: ``kind`` of the mistake or "", ln of its ``odds``.

    Sigma of ``radius`` [1], ``offset`` [rad/s] and ``scale`` of a_x [1]; ``delay`` of v [s];
    ``rate`` error of its clock [1]; ``slips``: v is made of wheel speeds, and slips with them.
    """

    kind: str
    odds: float
    radius: float
    offset: float = _SMALL
    delay: float = 0.0
    rate: float = 0.0
    rate_sigma: float = _STEADY
    slips: bool = False
    scale: float = _SCALE
    slippery: bool = False


def _beliefs(radius: float) -> Iterator[_Belief]:
    """All hypotheses; ``radius`` sigma of the known radius [1]."""
    yield _Belief("", 0.0, radius)
    yield _Belief("", _RARE, radius, slips=True)
    yield _Belief("", _RARE, radius, slippery=True)
    yield _Belief("", _RARE, _CAR)
    yield from (_Belief("", _RARE, other, scale=other) for other in (_CAR, _UNIT))
    for delay in _LATE:
        yield _Belief("", _RARE - math.log(len(_LATE)), radius, delay=delay)
    for offset in _LARGE:
        yield _Belief(OFFSET, _RARER - math.log(len(_LARGE)), radius, offset)
    for rate in _RATES:
        odds = _RARER - math.log(len(_RATES))
        yield _Belief(CLOCK, odds, radius, rate=rate, rate_sigma=_NEAR)


class _Fit(NamedTuple):
    """Posterior of a ``belief``: ``log`` of odds times evidence; ``misfit`` squared residuals."""

    belief: _Belief
    log: float
    unknowns: Array
    covariance: Array
    misfit: float


class _Means(NamedTuple):
    """Means (n,) over 0.1 s, where the car moves and no engine drives it, for both axles.

    ``places`` (m,) whether each mean counts, of ``size`` samples; ``braked`` z, and the pressure to
    its scale; ``shifts`` of v [m/s] by delay and rate error; ``late`` (n, 2) columns of these,
    ``a_x`` (n, 5) those of the second equation, and the noise of v by it [m/s].
    """

    places: Mask
    size: int
    v: Array
    braked: list[Array]
    shifts: dict[tuple[float, float], Array]
    late: Array
    a_x: Array
    a_x_noise: float

    @classmethod
    def of_run(cls, run: Run) -> "_Means":
        """Compute the means of a run."""
        d, size = run.driving, samples_in(SMOOTHING, run.driving.step)
        ends = run.slipping.first if run.slipping else math.inf
        inside = d.moving & (d.z > -DRIVEN_Z) & (d.z < GREATEST_Z) & (d.time < ends)
        use = block_mean(np.where(inside, 1.0, 0.0), size) == 1.0
        time, lost = d.time - d.time[0], G * integral(d.time, d.z)
        pairs = [(delay, 0.0) for delay in (0.0, *_LATE)] + [(0.0, rate) for rate in _RATES]
        shifts = [lost - np.interp((time - late) / (1.0 + c), time, lost) for late, c in pairs]
        signals = np.array([run.log["v"], d.z, time, lost, *shifts])
        v, z, time, lost, *shifts = block_mean(signals, size)[:, use]
        braked = [z]
        if d.pressure is not None:
            p = block_mean(d.pressure, size)[use]
            braked.append(p * float(z @ p) / max(float(p @ p), 1.0))
        late = np.stack([G * z, G * z * time], axis=1)
        a_x = np.stack([np.ones_like(v), time, 0.5 * time**2, -z * v, -lost], axis=1)
        noise = _noise(np.hstack([a_x, late]), v, shifts)
        by_shift = dict(zip(pairs, shifts, strict=True))
        return cls(use, size, v, braked, by_shift, late, a_x, noise)


@dataclass(frozen=True)
class _AxleSpeed:
    """How the wheels of an axle and a_x explain v, by its ``means`` (n,).

    ``columns`` (2 n, 14) of both equations: radius over ``radius`` [m], offset, slip (5), v_0,
    slope, its change, slip of v, scale, delay, rate; ``noise`` of v (2 n,) [m/s]; ``brakes``
    factors on mean and sigma of the slip (2,) [1].
    """

    means: _Means
    columns: Array
    radius: float
    noise: Array
    brakes: Array

    @classmethod
    def of_axle(cls, run: Run, means: _Means, axle: str, radius: float) -> "_AxleSpeed":
        """Build the regression of an axle."""
        omega = 0.5 * (run.log[f"omega_{axle}l"] + run.log[f"omega_{axle}r"])
        omega = block_mean(omega, means.size)[means.places]
        v, late, a_x, shifts = means.v, means.late, means.a_x, list(means.shifts.values())
        each = [radius * _by_wheels(omega, x) for x in means.braked]
        noises = [_noise(np.hstack([A, late]), v, shifts) for A in each]
        wheels = each[int(np.argmin(noises))]
        noise = np.repeat([min(noises), means.a_x_noise], v.size)
        columns = np.block([[wheels, 0.0 * a_x, late], [0.0 * wheels, a_x, late]])
        brakes = np.array([1.0, 1.0] if run.alone is None else [0.0, _ROLLS])
        return cls(means, columns, radius, noise, brakes)

    def fits(self, beliefs: Sequence[_Belief]) -> list[_Fit]:
        """Posterior of the unknowns under each belief."""
        mean, sigma = np.stack([self._prior(belief) for belief in beliefs], axis=1)
        shifts = np.stack([self.means.shifts[belief.delay, belief.rate] for belief in beliefs])
        rows = self.columns / self.noise[:, None]
        r = np.tile(self.means.v - shifts, 2) / self.noise - mean @ rows.T
        side = r @ rows
        x, covariances, evidence = posterior(rows.T @ rows, side, sigma)
        squares = (r - x @ rows.T) ** 2
        # r @ r - side @ x would lose the digits that decide
        misfit_and_prior = np.sum(squares, axis=1) + np.sum((x / sigma) ** 2, axis=1)
        logs = evidence - 0.5 * np.sum(side * x, axis=1) - 0.5 * misfit_and_prior
        misfits = np.sum(squares[:, : self.means.v.size], axis=1)
        unknowns = mean + x
        unknowns[:, -1] += [belief.rate for belief in beliefs]
        return [
            _Fit(belief, belief.odds + float(log), *others)
            for belief, log, *others in zip(
                beliefs, logs, unknowns, covariances, misfits, strict=True
            )
        ]

    def _prior(self, belief: _Belief) -> Array:
        """Mean and sigma of the unknowns (2, 14); the rate is relative to that of the belief."""
        slip = self.brakes * np.array(_SLIPPERY if belief.slippery else SLIP)
        of_v = np.array([(0.0, _STEADY)])
        if belief.slips:
            slip, of_v = slip * (0.0, 1.0), slip[:1]
        others = np.concatenate([slip, _A_X, of_v, [(1.0, belief.scale), (0.0, _IN_TIME)]])
        ends = [(1.0, belief.radius), (0.0, belief.offset)], [(0.0, belief.rate_sigma)]
        return np.concatenate([ends[0], others, ends[1]]).T


def _by_wheels(omega: Array, z: Array) -> Array:
    """Columns of radius, offset and slip, over the radius (n, 7); ``z`` by the brakes [1]."""
    steep = z * (z / max(float(np.max(z, initial=0.0)), _GENTLE)) ** _STEEP
    slips = (z * omega, z**2 * omega, z**3 * omega, steep * omega, 1e-4 * omega**3)
    return np.stack([omega, -np.ones_like(omega), *slips], axis=1)


def _noise(A: Array, v: Array, shifts: list[Array]) -> float:
    """Standard deviation of v [m/s] about the best regression on ``A`` with one of ``shifts``."""
    changed = (v - np.array(shifts)).T
    squares = np.sum((changed - A @ np.linalg.lstsq(A, changed)[0]) ** 2, axis=0)
    square = float(np.min(squares)) / max(v.size - A.shape[1], 1)
    return math.sqrt(_LASTING * square) + _FINEST
