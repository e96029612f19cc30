"""The evidence of a hypothesis on ramps or stops: how well it predicts eta, slip and forces.

    brakes = level N(pressure) (1 + discrepancy) + force of the mistake     the sum, (5), (17)
    tyres of the axles -> slips -> eta                                      the split, (13) to (22)

Both are multiplied, averaged over draws of pads and tyres and over sizes of the mistake, and
multiplied by its prior odds.
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

_DRAWS = 512
_BROAD = 0.5  # standard deviation of ln of the pads' ratio of the draws: any pads
_POINTS = 14  # of the sum of forces of a ramp
_TREND = 0.05  # standard deviation of the change of the pads' level over a ramp [1]
_DISCREPANCY, _LENGTH = 0.015, 0.15
"""Discrepancy of pads from a constant friction [1], and its correlation length in z [1]."""
_ZERO = 0.002  # standard deviation of the zero of the sum of forces over the weight [1]

_LIKELY, _FIRST = 32, 64  # draws that screen mistakes: the likeliest with other pads, the first
SCREENING_ERROR = 4.0  # largest error of ln of the odds by these draws, near those that count
NEVER = -1e6  # ln of the odds of a hypothesis that no draw explains
_NEAR = 6.0  # ln of the odds against a mistake from which no further sizes are tried
_STEP, _TRIALS, _CHANGE = 0.05, 40, 0.01
"""First step from the best of these sizes, over their range [1], most further sizes, and change of
ln of the evidence at which they end."""


@dataclass(frozen=True)
class Cause:
    """A hypothesis with its ``log_odds`` over "nothing wrong", and the likeliest ``size``.

    ``misfit`` mean square of its residuals over their errors [1].
    """

    hypothesis: Hypothesis
    log_odds: float
    size: Size
    misfit: float


_BySize = dict[Size, tuple[float, float]]
"""ln of the evidence by size of a mistake, and the mean square residual of the best draw."""


@cache
def _draws(other_road: bool) -> tuple[Ensemble, Array, Array]:
    """Draws of the default prior, with any pads' ratio; see `draw_cars`.

    With ``other_road`` every second one is on another road, as a stop may be.
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


class _Sum:
    """The sum of forces of a run, by means of groups of its braked blocks.

    brakes = level N(pressure) (1 + discrepancy + trend), from the zero on the lead-in.
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
        front, rear = brake_forces(self.car, run.blocks.p_f, run.blocks.p_r)
        N = self._mean(front + rear) / self.car.weight
        root = np.linalg.cholesky(self.absolute + np.outer(N, N) * self.relative)
        self.white = np.linalg.inv(root)
        self.unit = self.white @ N
        self.information = float(self.unit @ self.unit)
        self.log = -0.5 * math.log(self.information) - float(np.log(np.diag(root)).sum())

    def evidence(self, run: RampRun) -> tuple[float, float, float]:
        """ln of the evidence of ``run``, ln of the pads' level, and the misfit."""
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
    """Evidence of hypotheses on the ramps of a car."""

    def __init__(self, car: Vehicle, runs: Sequence[RampRun], other_road: bool) -> None:
        self.car, self.runs, self.draws = car, runs, _draws(other_road)
        self.regression, self.share = Regression(car, list(runs)), front_share(car, 0.0)
        self.loaded = self.regression.loaded(self.draws[0])
        self.sums = [_Sum(car, run) for run in runs]
        self.sums_as_read = self._of_sums(runs)
        self.as_read = self.regression.solve(*self.draws, self.loaded)

    def screened(self, mistakes: Sequence[Hypothesis], pads: Sequence[Cause]) -> list[Cause]:
        """Odds of mistakes by some draws, scaled so that the best ``pads`` have those of all draws.

        These are the likeliest draws with other pads, and the first of all.
        """
        _, level, _ = self.sums_as_read
        priors = [self._prior(level, self.draws[0].log_pad_ratio, c.hypothesis.pads) for c in pads]
        likely = np.argsort(-self.as_read.log_evidence - np.max(priors, axis=0), kind="stable")
        part = self._by(np.union1d(likely[:_LIKELY], np.arange(_FIRST)))
        by_pads = [part.of_pads(c.hypothesis).log_odds for c in pads]
        nothing, best = by_pads[0], max(by_pads)
        correction = max(c.log_odds for c in pads) - best
        # what explains less than half of what other pads do is no better between its sizes
        least = 0.5 * (nothing + best)
        causes = part.of_mistakes(mistakes, nothing - SCREENING_ERROR, least)
        return [replace(cause, log_odds=cause.log_odds + correction) for cause in causes]

    def _by(self, draws: Index) -> "Evidence":
        other, (e, centre, root) = copy.copy(self), self.draws
        other.draws = e.take(draws), centre[draws], root[draws]
        other.loaded = [tyres.take(draws) for tyres in self.loaded]
        other.as_read = self.as_read.take(draws)
        return other

    def of_pads(self, h: Hypothesis) -> Cause:
        """A hypothesis on the pads alone, with ln of (odds times evidence)."""
        return self._cause(h, {(): self._weighed(h, self.sums_as_read, self.as_read)})

    def of_mistakes(
        self, mistakes: Sequence[Hypothesis], nothing: float, least: float
    ) -> list[Cause]:
        """The mistakes with ln of (odds times evidence), and the best size of each.

        ``nothing`` ln of the evidence of "nothing wrong"; ``least`` that from which the size of a
        mistake is searched for between those that are listed.
        """
        by_size = self._by_size([(h, size) for h in mistakes for size in h.first])
        likely = [h for h in mistakes if max(by_size[h].values())[0] > nothing - _NEAR]
        pairs = [(h, size) for h in likely for size in h.sizes if size not in by_size[h]]
        for h, more in self._by_size(pairs).items():
            every = by_size[h] | more
            by_size[h] = {size: every[size] for size in h.sizes}
        return [self._cause(h, of_h, least) for h, of_h in by_size.items()]

    def _cause(self, h: Hypothesis, by_size: _BySize, least: float = math.inf) -> Cause:
        size = max(by_size, key=lambda size: by_size[size][0])
        if by_size[size][0] + math.log(h.odds) > least:
            del by_size[size]  # its cell is as probable as the best size there
            size = self._best_near(h, size)
            by_size |= self._by_size([(h, size)])[h]
        log = _log_mean(np.array([log for log, _ in by_size.values()])) + math.log(h.odds)
        return Cause(h, max(log, NEVER), size, by_size[size][1])  # no draw may explain it

    def _best_near(self, h: Hypothesis, size: Size) -> Size:
        """The most probable size near ``size``, in the range of all: a ridge of two is narrow."""
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
        """ln of the evidence of each size, and the mean square residual of its best draw."""
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
        """ln of the evidence of one size, and the mean square residual of its best draw."""
        log, level, square = sums
        each = split.log_evidence + self._prior(level, self.draws[0].log_pad_ratio, h.pads)
        residual = split.residual(int(np.argmax(each)))
        square += float(residual @ residual)
        return _log_mean(each) + log, square / (residual.size + _POINTS * len(self.runs))

    def _of_sums(self, runs: Sequence[RampRun]) -> tuple[float, float, float]:
        """`_Sum.evidence` of all ``runs``: sums of ln and of squares, mean of the level."""
        each = [of_run.evidence(run) for of_run, run in zip(self.sums, runs, strict=True)]
        log, level, square = zip(*each, strict=True)
        return sum(log), float(np.mean(level)), sum(square)

    def _prior(self, level: float, ratio: Array, pads: tuple[float, float]) -> Array:
        """ln of the prior density of this ``level`` and ``ratio`` (n,) over that of the draws."""
        front = (level + (1.0 - self.share) * ratio) / pads[0]
        rear = (level - self.share * ratio) / pads[1]
        by_draws = -0.5 * (ratio / _BROAD) ** 2 - math.log(_BROAD)
        return np.asarray(-by_draws - 0.5 * (front**2 + rear**2) - math.log(pads[0] * pads[1]))
