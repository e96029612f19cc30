"""The evidence of a hypothesis on ramps or stops: how well it predicts eta, slip and forces.

It has two factors, with the nominal brake force N:

    brake force = level N(pressure) (1 + discrepancy) + force of the mistake     by a_x, (5), (17)
    forces of the axles --tyres--> slips -> eta                            by the wheels, (13)-(22)

Their product is averaged over draws of pads and tyres and over sizes of the mistake. Evidence times
prior odds gives the odds of a hypothesis, see `Cause`.
"""

import copy
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache

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

_DRAWS = 512  # number of draws of pads and tyres
_BROAD = 0.5  # standard deviation of ln of the pads' ratio of the draws: any pads
_POINTS = 14  # means of the sum of forces on a ramp
_TREND = 0.05  # standard deviation of the change of the pads' level over a ramp [1]
_DISCREPANCY, _LENGTH = 0.015, 0.15
"""Discrepancy of pads from a constant friction [1], and its correlation length in z [1]."""
_ZERO = 0.002  # standard deviation of the zero of the sum of forces over the weight [1]

_LIKELY, _FIRST = 32, 64
"""Draws that screen mistakes: so many of the likeliest with other pads, so many of the first."""
SCREENING_ERROR = 4.0
"""Largest error of ln of the odds by the screening draws, for odds that may decide."""
NEVER = -1e6
"""ln of the odds of a hypothesis that no draw explains."""
_NEAR = 6.0  # ln of the odds against a mistake from which on only its first sizes are tried
_STEP, _TRIALS, _CHANGE = 0.05, 40, 0.01
"""Search of the best size: first step over the range of sizes [1], largest number of trials, and
change of ln of the evidence at which it ends."""


@dataclass(frozen=True)
class Cause:
    """A hypothesis with its ``log_odds`` and the likeliest ``size`` of its mistake.

    ``log_odds`` is ln of prior odds times evidence, up to a common constant; ``misfit`` the mean
    square of the residuals over their errors with the best draw [1].
    """

    hypothesis: Hypothesis
    log_odds: float
    size: Size
    misfit: float


_BySize = dict[Size, tuple[float, float]]
"""By size of a mistake: ln of the evidence, and mean square residual of the best draw."""


@cache
def _draws(other_road: bool) -> tuple[Ensemble, Array, Array]:
    """Draws of the default prior, as by `draw_cars`, but with any pads' ratio.

    With ``other_road`` every second draw is on another road, as a stop may be.
    """
    from scipy.special import ndtri

    x = ndtri(spread_evenly(_DRAWS, DRAWN + 1))
    e, centre, root = draw_cars(x[:, :DRAWN], ())
    e = replace(e, log_pad_ratio=_BROAD * x[:, -1])
    if other_road:
        (_, mean), (_, sigma) = STOP.log_peak.mean, STOP.log_peak.sigma
        place = (np.log(e.peak) - CAR.peak.mean) / CAR.peak.sigma
        log_peak = np.where(np.arange(e.size) % 2, mean + sigma * place, np.log(e.peak))
        stiff = STOP.log_stiffness.mean[1] + STIFFENING * (log_peak - math.log(DRY_PEAK))
        softer = np.where(np.arange(e.size) % 2, np.exp(-stiff), 1.0)
        centre[:, :2] *= softer[:, None]
        root[:, :2] *= softer[:, None, None]
        e = replace(e, peak=np.exp(log_peak))
    return e, centre, root


def _log_mean(x: Array) -> float:
    """ln of the mean of exp ``x`` (n,)."""
    most = float(x.max())
    return most + math.log(np.exp(x - most).mean()) if math.isfinite(most) else most


class _SumOfForces:
    """The brake force of a run by its deceleration, as means over groups of its braked blocks.

    Model, with the force less its zero on the lead-in and any ``level``:

        brake force = level N(pressure) (1 + discrepancy + trend) + noise

    ``relative`` covariance of discrepancy and trend, ``absolute`` that of noise and zero, both of
    the force over the weight; ``white`` whitens, ``unit`` is the whitened N.
    """

    def __init__(self, car: Vehicle, run: RampRun) -> None:
        b, self.car, self.run, braked = run.blocks, car, run, np.flatnonzero(run.braked)
        self._mean = GroupMean(np.array_split(braked, min(_POINTS, braked.size)))
        self.z, time, length = self._mean(b.z), self._mean(b.end), self._mean.sizes * b.length
        along = (time - time.mean()) / max(float(np.ptp(time)), b.length)
        near = np.exp(-0.5 * ((self.z[:, None] - self.z) / _LENGTH) ** 2)
        self.relative = _DISCREPANCY**2 * near + np.outer(along, along) * _TREND**2
        self.absolute = np.diag(run.noise.z**2 / length) + _ZERO**2
        self._read_pressures(run)

    def _read_pressures(self, run: RampRun) -> None:
        """Compute all that depends on the pressures."""
        front, rear = brake_forces(self.car, run.blocks.p_f, run.blocks.p_r)
        N = self._mean(front + rear) / self.car.weight
        root = np.linalg.cholesky(self.absolute + np.outer(N, N) * self.relative)
        self.white = np.linalg.inv(root)
        self.unit = self.white @ N
        self.information = float(self.unit @ self.unit)
        self.log = -0.5 * math.log(self.information) - float(np.log(np.diag(root)).sum())

    def evidence(self, run: RampRun) -> tuple[float, float, float]:
        """ln of the evidence of ``run``, ln of the pads' level, sum of squared residuals."""
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
        return sums.log - 0.5 * square, math.log(max(level, 1e-2)), square


class Evidence:
    """Evidence of hypotheses on the ramps of a car, or on stops that may be on an ``other_road``.

    ``draws`` of pads and tyres, ``loaded`` their tyres; ``regression`` by the wheels, ``sums`` of
    forces of each run; ``sums_as_read`` and ``as_read`` the evidence of both without a mistake.
    """

    def __init__(self, car: Vehicle, runs: Sequence[RampRun], other_road: bool) -> None:
        self.car, self.runs, self.draws = car, runs, _draws(other_road)
        self.regression, self.share = Regression(car, list(runs)), front_share(car, 0.0)
        self.loaded = self.regression.loaded(self.draws[0])
        self.sums = [_SumOfForces(car, run) for run in runs]
        self.sums_as_read = self._of_sums(runs)
        self.as_read = self.regression.solve(*self.draws, self.loaded)

    def screened(self, mistakes: Sequence[Hypothesis], pads: Sequence[Cause]) -> list[Cause]:
        """Odds of ``mistakes`` by some of the draws.

        These draws are the likeliest with other pads, and the first of all. ``pads`` are the
        hypotheses on pads by all draws, "nothing wrong" first. The odds are scaled so that the best
        of ``pads`` keeps its odds.
        """
        _, level, _ = self.sums_as_read
        priors = [self._prior(level, self.draws[0].log_pad_ratio, c.hypothesis.pads) for c in pads]
        likely = np.argsort(-self.as_read.log_evidence - np.max(priors, axis=0), kind="stable")
        part = self._by(np.union1d(likely[:_LIKELY], np.arange(_FIRST)))
        by_pads = [part.of_pads(c.hypothesis).log_odds for c in pads]
        nothing, best = by_pads[0], max(by_pads)
        correction = max(c.log_odds for c in pads) - best
        # a mistake far worse than other pads at the listed sizes is not searched between them
        least = 0.5 * (nothing + best)
        causes = part.of_mistakes(mistakes, nothing - SCREENING_ERROR, least)
        return [replace(cause, log_odds=cause.log_odds + correction) for cause in causes]

    def _by(self, draws: Index) -> "Evidence":
        """The same evidence by some of the ``draws``."""
        other, (e, centre, root) = copy.copy(self), self.draws
        other.draws = e.take(draws), centre[draws], root[draws]
        other.loaded = [tyres.take(draws) for tyres in self.loaded]
        other.as_read = self.as_read.take(draws)
        return other

    def of_pads(self, h: Hypothesis) -> Cause:
        """The cause of a hypothesis on the pads alone."""
        return self._cause(h, {(): self._weighed(h, self.sums_as_read, self.as_read)})

    def of_mistakes(
        self, mistakes: Sequence[Hypothesis], nothing: float, least: float
    ) -> list[Cause]:
        """The causes of ``mistakes``.

        ``nothing`` is ln of the evidence of "nothing wrong". From ln of the odds ``least`` on, the
        size of a mistake is searched for between the listed sizes.
        """
        by_size = self._by_size([(h, size) for h in mistakes for size in h.first])
        likely = [h for h in mistakes if max(by_size[h].values())[0] > nothing - _NEAR]
        pairs = [(h, size) for h in likely for size in h.sizes if size not in by_size[h]]
        for h, further in self._by_size(pairs).items():
            tried = by_size[h] | further
            by_size[h] = {size: tried[size] for size in h.sizes}
        return [self._cause(h, of_h, least) for h, of_h in by_size.items()]

    def _cause(self, h: Hypothesis, by_size: _BySize, least: float = math.inf) -> Cause:
        """The cause of a hypothesis: the mean of its evidence over sizes, and the best size."""
        size = max(by_size, key=lambda size: by_size[size][0])
        if by_size[size][0] + math.log(h.odds) > least:
            del by_size[size]  # the better size near it takes its place in the mean
            size = self._best_near(h, size)
            by_size |= self._by_size([(h, size)])[h]
        log = _log_mean(np.array([log for log, _ in by_size.values()])) + math.log(h.odds)
        return Cause(h, max(log, NEVER), size, by_size[size][1])  # no draw may explain it

    def _best_near(self, h: Hypothesis, size: Size) -> Size:
        """The most probable size near ``size``, within the range of all sizes.

        Where a size has two numbers, probable ones lie on a narrow ridge between the listed ones.
        """
        from scipy.optimize import minimize

        start, low, high = np.array(size), np.min(h.sizes, axis=0), np.max(h.sizes, axis=0)

        def unlikely(x: Array) -> float:
            inside = np.all((x >= low) & (x <= high))
            tried = tuple(x.tolist())
            return -self._by_size([(h, tried)])[h][tried][0] if inside else math.inf

        inward = np.where(start > 0.5 * (low + high), -_STEP, _STEP) * (high - low)
        first = np.vstack([start, start + np.diag(inward)])
        ends = {"maxfev": _TRIALS, "fatol": _CHANGE, "xatol": math.inf}
        nearest = minimize(
            unlikely, start, method="Nelder-Mead", options={"initial_simplex": first, **ends}
        )
        return tuple(nearest.x.tolist())

    def _by_size(self, pairs: Sequence[tuple[Hypothesis, Size]]) -> "dict[Hypothesis, _BySize]":
        """`_BySize` of each hypothesis in ``pairs`` of a hypothesis and a size."""
        undone = [[h.undo(run, size) for run in self.runs] for h, size in pairs if h.undo]
        if not undone:
            return {}
        split = self.regression.with_forces_of(undone).solve(*self.draws, self.loaded)
        by_size: dict[Hypothesis, _BySize] = {h: {} for h, _ in pairs}
        for i, (h, size) in enumerate(pairs):
            by_size[h][size] = self._weighed(h, self._of_sums(undone[i]), split.take(i))
        return by_size

    def _weighed(
        self, h: Hypothesis, sums: tuple[float, float, float], split: Solution
    ) -> tuple[float, float]:
        """ln of the evidence of one size, and the mean square residual of its best draw.

        ``sums`` as by `_of_sums`; ``split`` the solution of the regression.
        """
        log, level, square = sums
        each = split.log_evidence + self._prior(level, self.draws[0].log_pad_ratio, h.pads)
        residual = split.residual(int(np.argmax(each)))
        square += float(residual @ residual)
        return _log_mean(each) + log, square / (residual.size + _POINTS * len(self.runs))

    def _of_sums(self, runs: Sequence[RampRun]) -> tuple[float, float, float]:
        """`_SumOfForces.evidence` of all ``runs``: sum of ln, mean of the level, sum of squares."""
        each = [forces.evidence(run) for forces, run in zip(self.sums, runs, strict=True)]
        log, level, square = zip(*each, strict=True)
        return sum(log), float(np.mean(level)), sum(square)

    def _prior(self, level: float, ratio: Array, pads: tuple[float, float]) -> Array:
        """ln of the prior density of ``level`` and ``ratio`` (n,), over that of the draws.

        ``pads`` as in `Hypothesis`. Level and ratio give ln of the friction of each axle's pads.
        """
        front = (level + (1.0 - self.share) * ratio) / pads[0]
        rear = (level - self.share * ratio) / pads[1]
        by_draws = -0.5 * (ratio / _BROAD) ** 2 - math.log(_BROAD)
        return np.asarray(-by_draws - 0.5 * (front**2 + rear**2) - math.log(pads[0] * pads[1]))
