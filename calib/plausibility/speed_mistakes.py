"""Mistakes that make v and the wheel speeds disagree: an offset, or a wrong clock of v.

    v = R (omega - offset + slip and growth of the tyre) + late       slip and growth in [rad/s]
    v = v_0 - (scale of a_x) g int z dt + slope t + drift t^2/2 + slip of v + late
    late = g int z dt from (t - delay)/(1 + c) to t

late is what the car has lost since (t - delay)/(1 + c), the time whose speed v shows at t. Both
equations hold over coasting, lead-in and braking, until a wheel is at its limit. Each hypothesis is
a linear Gaussian model of both equations with its own prior of the unknowns, such as the radius R,
the offset and the rate error c of the clock of v. Slip is a cubic of z and a steep term near the
peak of the tyres. Where the pressure, scaled to z, leaves less noise, it replaces z in the slip,
since powers amplify the noise of z.
"""

import math
from collections.abc import Iterator, Sequence
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

_FEWEST, _LASTING = 20, 4.0  # fewest means; factor on the variance, since errors last [1]
_RADIUS_BY_FILE, _RADIUS, _OTHER_CAR, _OTHER_UNIT = 0.012, 0.08, 0.1, 3.0
"""Relative sigma of a radius [1]: known from the vehicle file; usual, without a file; with the file
of another car; with v in another unit."""
_STEEP, _GENTLE = 8, 0.1  # order in z of the steep term; least z to which it is scaled [1]
SLIP = ((0.04, 0.02), (0.01, 0.02), (0.0, 0.02), (0.0, 0.002), (0.0, 0.003))
"""Mean and sigma of the coefficients of slip: of z, its square, cube and steep term; and of the
growth of a tyre by the square of the wheel speed over 100 rad/s [1]."""
_SLIP_WET = ((0.12, 0.03), (0.1, 0.1), (0.4, 0.3), (0.03, 0.03), SLIP[-1])
"""The same on a wet road: a brush of stiffness K and peak m that brakes with z times its load slips
by (1 + z/(3 m) + 5 z^2/(27 m^2) ...) z/K. K is 8 to 18, m 0.35 to 0.6. No sigma of slip is above
its mean, or negative slip would imitate a clock of v that runs fast."""
_UNBRAKED_SLIP = 0.2  # sigma of the slip of an unbraked axle over that of a braked one [1]
_IN_TIME, _DELAYS = 0.05, (0.1, 0.2, 0.3, 0.4)  # sigma of a usual delay, delays of a late v [s]
_FINEST = 5e-3  # least error of v [m/s]
_ROAD, _SCALE = ((0.0, 100.0), (0.0, 0.3), (0.0, 0.02)), 0.015
"""Mean and sigma of v_0 [m/s], of slope and zero of a_x [m/s^2], of their drift [m/s^3]; sigma of
the scale of a_x [1]."""
_OFFSET, _WRONG_OFFSETS = 0.3, (3.0, 30.0)  # sigma of a usual offset, of mistakes [rad/s]
_RATE, _WRONG_RATE = 1e-3, 0.01  # sigma of the rate error of a correct clock, of a wrong one [1]
_WRONG_RATES = tuple(x / 100.0 for x in range(-10, 11, 2) if x)  # rate errors of a wrong clock [1]
_LOG_RARE, _LOG_MISTAKE = math.log(0.05), math.log(0.01)  # ln of prior odds: rare cause, mistake
_EXPLAINED = 1.4
"""Largest squared residual with a mistake over that of free coefficients [1]: true mistakes leave
0.4 to 1.0. A peak of the tyres that no hypothesis describes, taken for a mistake, left 1.6."""


class SpeedMistake(NamedTuple):
    """An offset of the wheel speeds, or a wrong clock of v."""

    kind: str  # OFFSET or CLOCK
    size: float  # offset [rad/s], or rate error [1]
    sigma: float
    log_odds: float  # ln of the odds against all hypotheses without a mistake
    radius: float  # of the wheels with the mistake [m]


def speed_mistakes(run: Run) -> dict[str, tuple[SpeedMistake, ...]]:
    """Mistakes that explain v, by axle, or by "" if both axles share them; most probable first."""
    car, means = run.vehicle, _Means.of_run(run)
    radii = (car.front.rolling_radius, car.rear.rolling_radius) if car else (None, None)
    by_axle = {a: _mistakes(run, means, a, radius) for a, radius in zip(AXLES, radii, strict=True)}
    likely = {axle: _likely(mistakes) for axle, mistakes in by_axle.items()}
    likely = {axle: mistakes for axle, mistakes in likely.items() if mistakes}
    if not likely:
        return {}
    likeliest = max(likely.values(), key=lambda mistakes: mistakes[0].log_odds)
    same = [m for mistakes in by_axle.values() for m in mistakes if m.kind == likeliest[0].kind]
    axles_differ = np.ptp([m.size for m in same]) > 3.0 * math.hypot(*(m.sigma for m in same))
    return likely if axles_differ else {"": likeliest}


def _likely(mistakes: list[SpeedMistake]) -> tuple[SpeedMistake, ...]:
    """The likely mistakes, most probable first, without those that are much less probable."""
    largest = max((m.log_odds for m in mistakes), default=0.0)
    least = max(LIKELY_LOG_ODDS, largest - LIKELY_LOG_ODDS)
    likely = (m for m in mistakes if m.log_odds > least)
    return tuple(sorted(likely, key=lambda m: m.log_odds, reverse=True))


def _mistakes(run: Run, means: "_Means", axle: str, radius: float | None) -> list[SpeedMistake]:
    """Offset and clock by the wheels of an axle, whose ``radius`` [m] may be unknown."""
    if run.alone == axle or means.v.size < _FEWEST:  # the slip of a single axle is unknown
        return []
    model = _AxleModel.of_axle(run, means, axle, radius or NOMINAL_RADIUS)
    fits = model.fits(list(_hypotheses(_RADIUS_BY_FILE if radius else _RADIUS)))
    log_without = np.logaddexp.reduce([fit.log for fit in fits if not fit.hypothesis.kind])
    mistakes = []
    for kind, place in ((OFFSET, 1), (CLOCK, -1)):  # place among the unknowns
        of_kind = [fit for fit in fits if fit.hypothesis.kind == kind]
        best = max(of_kind, key=lambda fit: fit.log)
        if _LASTING * best.misfit < _EXPLAINED * means.v.size:
            log_odds = float(np.logaddexp.reduce([fit.log for fit in of_kind]) - log_without)
            sigma = math.sqrt(best.covariance[place, place])
            size, factor = float(best.unknowns[place]), float(best.unknowns[0])
            mistakes.append(SpeedMistake(kind, size, sigma, log_odds, model.radius * factor))
    return mistakes


class _Hypothesis(NamedTuple):
    """What may be wrong, and the prior of the unknowns."""

    kind: str  # of the mistake, or ""
    log_odds: float  # ln of the prior odds
    radius_sigma: float  # of the radius over its mean [1]
    offset_sigma: float = _OFFSET  # [rad/s]
    delay: float = 0.0  # of v [s]
    rate: float = 0.0  # relative error of the clock of v [1]
    rate_sigma: float = _RATE
    slips: bool = False  # whether v is made of wheel speeds, and slips with them
    scale_sigma: float = _SCALE  # of the scale of a_x [1]
    slip: tuple[tuple[float, float], ...] = SLIP  # of the wheels


def _hypotheses(radius_sigma: float) -> Iterator[_Hypothesis]:
    """Yield all hypotheses; ``radius_sigma`` is that of the known radius [1]."""
    yield _Hypothesis("", 0.0, radius_sigma)
    yield _Hypothesis("", _LOG_RARE, radius_sigma, slips=True)
    yield _Hypothesis("", _LOG_RARE, radius_sigma, slip=_SLIP_WET)
    yield _Hypothesis("", _LOG_RARE, _OTHER_CAR)  # the vehicle file is that of another car
    yield _Hypothesis("", _LOG_RARE, _OTHER_CAR, scale_sigma=_OTHER_CAR)  # v is scaled, too
    yield _Hypothesis("", _LOG_RARE, _OTHER_UNIT, scale_sigma=_OTHER_UNIT)  # v in another unit
    for delay in _DELAYS:
        yield _Hypothesis("", _LOG_RARE - math.log(len(_DELAYS)), radius_sigma, delay=delay)
    log_odds = _LOG_MISTAKE - math.log(len(_WRONG_OFFSETS))
    for offset_sigma in _WRONG_OFFSETS:
        yield _Hypothesis(OFFSET, log_odds, radius_sigma, offset_sigma)
    log_odds = _LOG_MISTAKE - math.log(len(_WRONG_RATES))
    for rate in _WRONG_RATES:
        yield _Hypothesis(CLOCK, log_odds, radius_sigma, rate=rate, rate_sigma=_WRONG_RATE)


class _Fit(NamedTuple):
    """Posterior of a hypothesis."""

    hypothesis: _Hypothesis
    log: float  # ln of prior odds times evidence
    unknowns: Array  # mean (14,)
    covariance: Array  # (14, 14)
    misfit: float  # squared residuals of the first equation [1]


class _Means(NamedTuple):
    """Means over 0.1 s, where the car moves and no engine drives it: n of the m in a run."""

    is_used: Mask  # (m,)
    size: int  # samples of a mean
    v: Array  # (n,) [m/s]
    braked: list[Array]  # z (n,), and the pressure (n,) scaled to z
    late: dict[tuple[float, float], Array]  # `late` of the head (n,) by delay and rate error [m/s]
    by_late: Array  # columns (n, 2): change of `late` by delay and by rate error
    a_x: Array  # columns (n, 5) of the second equation: v_0, slope, its drift, slip of v, scale
    a_x_noise: float  # of v by the second equation [m/s]

    @classmethod
    def of_run(cls, run: Run) -> "_Means":
        d, size = run.driving, samples_in(SMOOTHING, run.driving.step)
        inside = d.moving & (d.z > -DRIVEN_Z) & (d.z < GREATEST_Z) & (d.time < run.first_slip)
        use = block_mean(np.where(inside, 1.0, 0.0), size) == 1.0
        time, lost = d.time - d.time[0], G * integral(d.time, d.z)
        cases = [(delay, 0.0) for delay in (0.0, *_DELAYS)] + [(0.0, c) for c in _WRONG_RATES]
        late = [lost - np.interp((time - delay) / (1.0 + c), time, lost) for delay, c in cases]
        signals = np.array([run.log["v"], d.z, time, lost, *late])
        v, z, time, lost, *late = block_mean(signals, size)[:, use]  # means (n,) from here on
        braked = [z]
        if d.pressure is not None:
            p = block_mean(d.pressure, size)[use]
            braked.append(p * float(z @ p) / max(float(p @ p), 1.0))
        by_late = np.stack([G * z, G * z * time], axis=1)
        a_x = np.stack([np.ones_like(v), time, 0.5 * time**2, -z * v, -lost], axis=1)
        noise = _noise(np.hstack([a_x, by_late]), v, late)
        return cls(use, size, v, braked, dict(zip(cases, late, strict=True)), by_late, a_x, noise)


class _AxleModel(NamedTuple):
    """How the wheels of an axle and a_x explain v."""

    means: _Means
    columns: Array  # (2 n, 14) of both equations: radius, offset, slip (5), a_x (5), by_late (2)
    radius: float  # that the first unknown multiplies [m]
    noise: Array  # of v (2 n,) [m/s]
    slip_factors: Array  # on mean and sigma of the slip (2,) [1]

    @classmethod
    def of_axle(cls, run: Run, means: _Means, axle: str, radius: float) -> "_AxleModel":
        omega = 0.5 * (run.log[f"omega_{axle}l"] + run.log[f"omega_{axle}r"])
        omega = block_mean(omega, means.size)[means.is_used]
        v, a_x, by_late = means.v, means.a_x, means.by_late
        candidates = [radius * _by_wheels(omega, x) for x in means.braked]
        noises = [_noise(np.hstack([A, by_late]), v, list(means.late.values())) for A in candidates]
        wheels = candidates[int(np.argmin(noises))]
        noise = np.repeat([min(noises), means.a_x_noise], v.size)
        columns = np.block([[wheels, 0.0 * a_x, by_late], [0.0 * wheels, a_x, by_late]])
        # an axle beside one that brakes alone hardly slips
        slip_factors = np.array([1.0, 1.0] if run.alone is None else [0.0, _UNBRAKED_SLIP])
        return cls(means, columns, radius, noise, slip_factors)

    def fits(self, hypotheses: Sequence[_Hypothesis]) -> list[_Fit]:
        """Posterior of the unknowns under each of the h hypotheses."""
        mean, sigma = np.stack([self._prior(case) for case in hypotheses], axis=1)  # (h, 14)
        late = np.stack([self.means.late[case.delay, case.rate] for case in hypotheses])  # (h, n)
        rows = self.columns / self.noise[:, None]
        residual = np.tile(self.means.v - late, 2) / self.noise - mean @ rows.T  # (h, 2 n)
        side = residual @ rows
        x, covariances, evidence = posterior(rows.T @ rows, side, sigma)
        squares = (residual - x @ rows.T) ** 2
        # The misfit is summed directly: residual @ residual - side @ x would lose the digits that
        # decide. The evidence of `posterior` contains side @ x/2 in its place, which is taken out.
        misfit_and_prior = np.sum(squares, axis=1) + np.sum((x / sigma) ** 2, axis=1)
        logs = evidence - 0.5 * np.sum(side * x, axis=1) - 0.5 * misfit_and_prior
        misfits = np.sum(squares[:, : self.means.v.size], axis=1)
        unknowns = mean + x
        unknowns[:, -1] += [hypothesis.rate for hypothesis in hypotheses]
        logs += [hypothesis.log_odds for hypothesis in hypotheses]
        results = zip(hypotheses, logs.tolist(), unknowns, covariances, misfits, strict=True)
        return [_Fit(*result) for result in results]

    def _prior(self, x: _Hypothesis) -> Array:
        """Mean and sigma of the unknowns (2, 14); the last is the rate error less that of ``x``."""
        slip = self.slip_factors * np.array(x.slip)  # (5, 2)
        slip_of_v = np.array((0.0, 1e-3))  # practically none
        if x.slips:  # v and the wheels slip alike
            slip, slip_of_v = slip * (0.0, 1.0), slip[0]
        prior = [(1.0, x.radius_sigma), (0.0, x.offset_sigma), *slip, *_ROAD, slip_of_v]
        prior += [(1.0, x.scale_sigma), (0.0, _IN_TIME), (0.0, x.rate_sigma)]
        return np.array(prior).T


def _by_wheels(omega: Array, z: Array) -> Array:
    """Columns (n, 7) of radius, offset and slip, over the radius; ``z`` (n,) by a_x or pressure."""
    steep = z * (z / max(float(np.max(z, initial=0.0)), _GENTLE)) ** _STEEP
    slips = (z * omega, z**2 * omega, z**3 * omega, steep * omega, 1e-4 * omega**3)
    return np.stack([omega, -np.ones_like(omega), *slips], axis=1)


def _noise(A: Array, v: Array, late: list[Array]) -> float:
    """Standard deviation [m/s] of v less one of ``late`` about its best regression on ``A``."""
    shifted = (v - np.array(late)).T
    squares = np.sum((shifted - A @ np.linalg.lstsq(A, shifted)[0]) ** 2, axis=0)
    square = float(np.min(squares)) / max(v.size - A.shape[1], 1)
    return math.sqrt(_LASTING * square) + _FINEST
