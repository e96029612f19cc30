"""The evidence of a hypothesis on ramps or stops: how well it predicts eta, slip and forces.

The evidence is the product of two likelihoods. The first is that of the brake force by a_x, (5) and
(17) of the paper, with the nominal brake force N:

    brake force = level N(pressure) (1 + discrepancy) + force of the mistake

The second is that of eta and slip by the wheel speeds, (13) to (22). `_SumOfForces` has the first,
`calib.fitting.regression` the second. `HypothesisEvidence` averages their product over draws of
pads and tyres and over sizes of the mistake. Times the prior odds this gives the odds of a `Cause`.
"""

import copy
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import NamedTuple

import numpy as np

from calib.base.arrays import Array, Index
from calib.car.balance import brake_forces, front_share
from calib.car.beliefs import CAR, DRY_PEAK, STIFFENING, STOP
from calib.car.vehicle import Vehicle
from calib.fitting.ensemble import Ensemble, spread_evenly
from calib.fitting.hypotheses import Hypothesis, Size
from calib.fitting.prior import DRAWN, draw_cars
from calib.fitting.regression import Regression, Solution
from calib.model.ramp import RampRun
from calib.run.filters import GroupMean

_DRAWS = 512  # draws of pads and tyres
_ANY_PADS = 0.5  # standard deviation of ln of the pads' ratio of the draws [1]
_POINTS = 14  # means of the sum of forces on a ramp, at most
_TREND = 0.05  # standard deviation of the change of the pads' level over a ramp [1]
_DISCREPANCY, _LENGTH = 0.015, 0.15  # of pads from a constant friction: sigma [1], length in z [1]
_ZERO = 0.002  # standard deviation of the zero of the sum of forces over the weight [1]

_LIKELY, _FIRST = 32, 64  # numbers of draws that screen mistakes: the likeliest, and the first
SCREENING_ERROR = 4.0  # error of ln of the odds by these draws, at most where the odds can decide
NEVER = -1e6  # ln of the odds of a hypothesis that no draw explains
_NEAR = 6.0  # a mistake more than this below "nothing wrong" in ln evidence gets no further sizes
_STEP = 0.05  # first step of the search of the best size, over the range of sizes [1]
_TRIES = 40  # largest number of sizes that the search tries
_CHANGE = 0.01  # change of ln of the evidence at which the search ends


@dataclass(frozen=True)
class Cause:
    """A hypothesis with its odds."""

    hypothesis: Hypothesis
    log_odds: float  # ln of prior odds times evidence, up to a common constant
    size: Size  # likeliest size of the mistake
    misfit: float  # mean square of the residuals over their errors with the best draw [1]


_BySize = dict[Size, tuple[float, float]]
"""By size of a mistake: ln of the evidence, and the `Cause.misfit`."""


class _Level(NamedTuple):
    """The pads' level by the sum of forces of one run or of several, with its evidence."""

    log_evidence: float  # a sum over the runs
    log_level: float  # ln of the pads' level, a mean over the runs [1]
    square: float  # sum of squared residuals over their errors [1]
    size: int  # number of these residuals


@cache
def _draws(other_road: bool) -> tuple[Ensemble, Array, Array]:
    """Return the cars, centre and root of `draw_cars` by the default prior, with pads of any ratio.

    With ``other_road`` every second draw is on another road, as a stop may be.
    """
    from scipy.special import ndtri

    x = ndtri(spread_evenly(_DRAWS, DRAWN + 1))
    e, centre, root = draw_cars(x[:, :DRAWN], ())
    e = replace(e, log_pad_ratio=_ANY_PADS * x[:, -1])
    if other_road:
        peaks, case = STOP.log_peak, STOP.log_peak.cases.index("other road")
        on_other = np.arange(e.size) % 2
        normal_peak = (np.log(e.peak) - CAR.peak.mean) / CAR.peak.sigma
        other_peak = peaks.mean[case] + peaks.sigma[case] * normal_peak
        log_peak = np.where(on_other, other_peak, np.log(e.peak))
        stiffer = STOP.log_stiffness.mean[case] + STIFFENING * (log_peak - math.log(DRY_PEAK))
        softer = np.where(on_other, np.exp(-stiffer), 1.0)  # factor of the compliances
        centre[:, :2] *= softer[:, None]
        root[:, :2] *= softer[:, None, None]
        e = replace(e, peak=np.exp(log_peak))
    return e, centre, root


def _log_mean(x: Array) -> float:
    """Return ln of the mean of exp ``x`` (n,)."""
    largest = float(x.max())
    if not math.isfinite(largest):
        return largest
    return largest + math.log(np.exp(x - largest).mean())


class _SumOfForces:
    """The brake force of a run by its deceleration, as means over k groups of its braked blocks.

    The mean force on the lead-in is subtracted; forces are over the weight. The level is free:

        brake force = level N(pressure) (1 + discrepancy + trend) + noise

    ``relative`` is the covariance (k, k) of discrepancy and trend, ``absolute`` that of noise and
    zero. ``white`` (k, k) whitens the force, ``unit`` (k,) is the whitened N, ``information`` its
    sum of squares, and ``log`` the part of ln of the evidence without the residuals.
    """

    def __init__(self, car: Vehicle, run: RampRun) -> None:
        self.car, self.run = car, run
        b, braked = run.blocks, np.flatnonzero(run.braked)
        self._mean = GroupMean(np.array_split(braked, min(_POINTS, braked.size)))
        z, time, length = self._mean(b.z), self._mean(b.end), self._mean.sizes * b.length
        along = (time - time.mean()) / max(float(np.ptp(time)), b.length)  # -1/2 to 1/2
        correlation = np.exp(-0.5 * ((z[:, None] - z) / _LENGTH) ** 2)
        self.relative = _DISCREPANCY**2 * correlation + np.outer(along, along) * _TREND**2
        self.absolute = np.diag(run.noise.z**2 / length) + _ZERO**2
        self._read_pressures(run)

    def _read_pressures(self, run: RampRun) -> None:
        """Compute the attributes that depend on the pressures."""
        front, rear = brake_forces(self.car, run.blocks.p_f, run.blocks.p_r)
        N = self._mean(front + rear) / self.car.weight
        root = np.linalg.cholesky(self.absolute + np.outer(N, N) * self.relative)
        self.white = np.linalg.inv(root)
        self.unit = self.white @ N
        self.information = float(self.unit @ self.unit)
        self.log = -0.5 * math.log(self.information) - float(np.log(np.diag(root)).sum())

    def read(self, run: RampRun) -> _Level:
        """Return the level by the forces of ``run``, a variant of the measured run."""
        sums = self
        if run.blocks.p_r is not self.run.blocks.p_r:
            sums = copy.copy(self)
            sums._read_pressures(run)
        rolling, brake = self.run.rolling, run.brake_sum
        zero = brake[rolling].mean() if rolling.size else 0.0
        forces = sums.white @ ((self._mean(brake) - zero) / self.car.weight)
        level = float(sums.unit @ forces) / sums.information
        residual = forces - level * sums.unit
        square = float(residual @ residual)
        return _Level(sums.log - 0.5 * square, math.log(max(level, 1e-2)), square, residual.size)


class HypothesisEvidence:
    """Evidence of hypotheses on ramps of a car, or on stops that may be on an ``other_road``."""

    def __init__(self, car: Vehicle, runs: Sequence[RampRun], other_road: bool) -> None:
        self._runs, self._draws = runs, _draws(other_road)
        self._regression, self._share = Regression(car, list(runs)), front_share(car, 0.0)
        self._loaded = self._regression.loaded(self._draws[0])
        self._sums = [_SumOfForces(car, run) for run in runs]
        # level and solution of the runs as they were measured
        self._level = self._level_of(runs)
        self._solution = self._regression.solve(*self._draws, self._loaded)

    def screened(self, mistakes: Sequence[Hypothesis], pads: Sequence[Cause]) -> list[Cause]:
        """Return the causes of ``mistakes`` by few draws.

        ``pads`` are the causes of the hypotheses on pads by all draws, "nothing wrong" first. All
        odds by few draws get one factor, which gives the best of ``pads`` its odds by all draws.
        """
        priors = [self._log_prior(self._level.log_level, c.hypothesis.pads) for c in pads]
        by_draw = self._solution.log_evidence + np.max(priors, axis=0)
        likely = np.argsort(-by_draw, kind="stable")[:_LIKELY]
        screening = self._with_draws(np.union1d(likely, np.arange(_FIRST)))
        by_pads = [screening.cause_of_pads(c.hypothesis).log_odds for c in pads]
        nothing, best = by_pads[0], max(by_pads)
        correction = max(c.log_odds for c in pads) - best
        # a mistake less likely than halfway between these two is not searched between listed sizes
        search_from = 0.5 * (nothing + best)
        causes = screening.causes_of(mistakes, nothing - SCREENING_ERROR, search_from)
        return [replace(cause, log_odds=cause.log_odds + correction) for cause in causes]

    def _with_draws(self, rows: Index) -> "HypothesisEvidence":
        """Return the evidence by these ``rows`` of the draws."""
        evidence, (e, centre, root) = copy.copy(self), self._draws
        evidence._draws = e.take(rows), centre[rows], root[rows]
        evidence._loaded = [tyres.take(rows) for tyres in self._loaded]
        evidence._solution = self._solution.take(rows)
        return evidence

    def cause_of_pads(self, h: Hypothesis) -> Cause:
        """Return the cause of a hypothesis on the pads alone."""
        return self._cause(h, {(): self._weighed(h, self._level, self._solution)})

    def causes_of(
        self, mistakes: Sequence[Hypothesis], nothing: float, search_from: float
    ) -> list[Cause]:
        """Return the causes of ``mistakes``.

        ``nothing`` is ln of the odds of "nothing wrong", less their error; see `_NEAR`. The best
        size is searched for between the listed sizes if ln of its odds is above ``search_from``.
        """
        by_size = self._by_size([(h, size) for h in mistakes for size in h.first])
        likely = [h for h in mistakes if max(by_size[h].values())[0] > nothing - _NEAR]
        pairs = [(h, size) for h in likely for size in h.sizes if size not in by_size[h]]
        for h, further in self._by_size(pairs).items():
            tried = by_size[h] | further
            by_size[h] = {size: tried[size] for size in h.sizes}  # not first sizes beyond the list
        return [self._cause(h, sizes, search_from) for h, sizes in by_size.items()]

    def _cause(self, h: Hypothesis, by_size: _BySize, search_from: float = math.inf) -> Cause:
        """Return the cause of a hypothesis: the mean of its evidence over sizes, the best size."""
        size = max(by_size, key=lambda size: by_size[size][0])
        if by_size[size][0] + math.log(h.odds) > search_from:
            del by_size[size]  # the better size nearby takes its place in the mean
            size = self._best_near(h, size)
            by_size |= self._by_size([(h, size)])[h]
        logs = np.array([log for log, _ in by_size.values()])
        log_odds = _log_mean(logs) + math.log(h.odds)  # -inf if no draw explains the mistake
        return Cause(h, max(log_odds, NEVER), size, by_size[size][1])

    def _best_near(self, h: Hypothesis, size: Size) -> Size:
        """Return the most probable size near ``size``, within the range of all sizes.

        Probable sizes of two numbers lie on a narrow ridge between the listed sizes.
        """
        from scipy.optimize import minimize

        start, low, high = np.array(size), np.min(h.sizes, axis=0), np.max(h.sizes, axis=0)

        def minus_log_evidence(x: Array) -> float:
            if np.any((x < low) | (x > high)):
                return math.inf
            tried = tuple(x.tolist())
            return -self._by_size([(h, tried)])[h][tried][0]

        inward = np.where(start > 0.5 * (low + high), -_STEP, _STEP) * (high - low)
        simplex = np.vstack([start, start + np.diag(inward)])
        limits = {"maxfev": _TRIES, "fatol": _CHANGE, "xatol": math.inf, "initial_simplex": simplex}
        best = minimize(minus_log_evidence, start, method="Nelder-Mead", options=limits)
        return tuple(best.x.tolist())

    def _by_size(self, pairs: Sequence[tuple[Hypothesis, Size]]) -> "dict[Hypothesis, _BySize]":
        """Return `_BySize` of each hypothesis in ``pairs`` of hypothesis and size."""
        if not pairs:
            return {}
        undone = [[h.undo(run, size) for run in self._runs] for h, size in pairs]
        solutions = self._regression.with_forces_of(undone).solve(*self._draws, self._loaded)
        by_size: dict[Hypothesis, _BySize] = {h: {} for h, _ in pairs}
        for i, (h, size) in enumerate(pairs):
            by_size[h][size] = self._weighed(h, self._level_of(undone[i]), solutions.take(i))
        return by_size

    def _weighed(self, h: Hypothesis, level: _Level, solution: Solution) -> tuple[float, float]:
        """Return ln of the evidence of one size, a mean over the draws, and the `Cause.misfit`."""
        by_draw = solution.log_evidence + self._log_prior(level.log_level, h.pads)
        residual = solution.residual(int(np.argmax(by_draw)))
        square = level.square + float(residual @ residual)
        misfit = square / (residual.size + level.size)
        return _log_mean(by_draw) + level.log_evidence, misfit

    def _level_of(self, runs: Sequence[RampRun]) -> _Level:
        """Return the level by the forces of all ``runs``."""
        by_run = [forces.read(run) for forces, run in zip(self._sums, runs, strict=True)]
        log, level, square, size = zip(*by_run, strict=True)
        return _Level(sum(log), float(np.mean(level)), sum(square), sum(size))

    def _log_prior(self, log_level: float, pads: tuple[float, float]) -> Array:
        """Return ln of the prior density of level and ratio (n,), over that of the draws.

        ``pads`` as in `Hypothesis`. Level and ratio give ln of the friction of each axle's pads.
        """
        log_ratio = self._draws[0].log_pad_ratio
        front = (log_level + (1.0 - self._share) * log_ratio) / pads[0]
        rear = (log_level - self._share * log_ratio) / pads[1]
        by_draws = -0.5 * (log_ratio / _ANY_PADS) ** 2 - math.log(_ANY_PADS)
        return np.asarray(-by_draws - 0.5 * (front**2 + rear**2) - math.log(pads[0] * pads[1]))
