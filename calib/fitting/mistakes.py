"""Which mistake explains a ramp better than pads, tyres and car alone do.

The evidence of a hypothesis (`calib.fitting.hypotheses`) comes from two models of the ramp, and is
averaged over the sizes of the mistake:

    brakes = level N(pressure) (1 + discrepancy) + force of the mistake     the sum, (5), (17)
    tyres of the axles -> slips -> eta                                      the split, (13) to (22)

    ln odds = ln odds before + ln of the evidence of both, less that of no mistake

A mistake is named only where it explains more than other pads do. Where even the best hypothesis
explains badly, none is named. Two mistakes at once are not considered, and a wrong gain of p_mc
looks like other pads.
"""

import copy
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from calib.base.arrays import Array, Index
from calib.base.names import AXLE_NAMES
from calib.base.warning import Measured
from calib.car.balance import brake_forces, front_share
from calib.car.beliefs import CAR, STOP
from calib.car.vehicle import Vehicle
from calib.fitting.ensemble import Ensemble, spread_evenly
from calib.fitting.hypotheses import (
    DRAG,
    LATE,
    MOTOR,
    SCALE,
    USUAL_PADS,
    VALVE,
    Hypothesis,
    Size,
    hypotheses,
)
from calib.fitting.prior import DRAWN, draw_cars
from calib.fitting.regression import Regression, Solution
from calib.model.ramp import RampRun

SURE, CERTAIN = 3.0, 8.0
"""ln of the odds from which a mistake is named, and from which it is certain: 20 and 3,000 to 1.

A car near ideal balance, with tyres of an unusual form and no motor, had 6.4 for a motor."""

_EXPLAINED = 2.5
"""Mean square of the best residuals of eta, slip and sum over their errors, above which no
hypothesis explains the ramp."""

_MOSTLY = 8.0
"""The same where "nothing wrong" leaves 2.5 times as much: few draws fit exactly."""

_DRAWS = 512
_BROAD = 0.5  # standard deviation of ln of the pads' ratio of the draws: any pads
_POINTS = 14  # of the sum of forces of a ramp
_TREND = 0.05  # standard deviation of the change of the pads' level over a ramp [1]
_DEPARTS, _LENGTH = 0.015, 0.15
"""Discrepancy of pads from a constant friction [1], and its correlation length in z [1]."""
_ZERO = 0.002  # standard deviation of the zero of the sum of forces over the weight [1]

_LIKELY, _FIRST, _SCREENING_ERROR = 32, 64, 4.0
"""Draws by which mistakes are screened: the likeliest with other pads, and the first of all; and
how far the ln of the odds of a mistake is off by them, at most, where all draws hardly name it."""
_NEVER = -1e6  # ln of the odds of a hypothesis that no draw explains
_NEAR = 6.0  # ln of the odds against a mistake from which no further sizes are tried

_IN_WORDS = {
    MOTOR: "a motor that brakes the {axle} wheels by up to {size:.0f} N m, and is not logged",
    LATE: "wheel speeds of the {axle} axle that are late by {size:.3f} s",
}


@dataclass(frozen=True)
class Cause:
    """A hypothesis with its ``log_odds`` over "nothing wrong", and the likeliest ``size``.

    ``misfit`` mean square of its residuals over their errors [1].
    """

    hypothesis: Hypothesis
    log_odds: float
    size: Size
    misfit: float


def causes_of(car: Vehicle, runs: Sequence[RampRun], other_road: bool = False) -> tuple[Cause, ...]:
    """The hypotheses on ``runs`` in which both axles brake, most probable first.

    The runs are ramps, or stops on perhaps an ``other_road``. Raises ValueError where a run has no
    usable block.
    """
    evidence = _Evidence(car, runs, other_road)
    every = (Hypothesis("", 1.0), *hypotheses(car, runs))
    pads = [evidence.cause(h, -math.inf) for h in every if not h.code]
    screened, base = evidence.screened([h for h in every if h.code], pads), pads[0].log_odds
    least = _least(pads, screened, other_road)
    mistakes = (evidence.cause(c.hypothesis, base) if c.log_odds > least else c for c in screened)
    causes = (*pads, *mistakes)
    compared = (replace(cause, log_odds=cause.log_odds - base) for cause in causes)
    return tuple(sorted(compared, key=lambda cause: -cause.log_odds))


def _least(pads: Sequence[Cause], screened: Sequence[Cause], other_road: bool) -> float:
    """ln of the odds from which a screened mistake may be a candidate.

    On an ``other_road`` there is none unless a mistake explains the run better than other pads do.
    """
    best = max(pads, key=lambda cause: cause.log_odds)
    most = max((cause.log_odds for cause in screened), default=_NEVER)
    if other_road and most < best.log_odds + SURE - _SCREENING_ERROR:
        return math.inf
    return max(best.log_odds, most) - SURE * max(best.misfit, 1.0) - _SCREENING_ERROR


def _candidates(causes: Sequence[Cause]) -> tuple[Cause, ...]:
    """Hypotheses that the ramps cannot tell apart, most probable first.

    None where "nothing wrong" is among them, or where no hypothesis explains the ramps.
    """
    best = causes[0]
    sure = SURE * max(best.misfit, 1.0)  # a larger misfit makes the odds as much less sure
    near = tuple(c for c in causes if c.log_odds > best.log_odds - sure)
    usual = (USUAL_PADS, USUAL_PADS)
    nothing = next(c.misfit for c in causes if not c.hypothesis.code and c.hypothesis.pads == usual)
    most = max(_EXPLAINED, min(_MOSTLY, nothing / 2.5))
    return near if best.misfit < most and best.log_odds > sure else ()


def named(causes: Sequence[Cause], beside_pads: bool = True) -> tuple[Cause, ...]:
    """The mistakes that explain the ramps, most probable first.

    ``beside_pads`` names them even where other pads explain the runs as well. That is for a ramp,
    whose pads are those of the file; those of a stop may be wet.
    """
    near = _candidates(causes)
    mistakes = tuple(c for c in near if c.hypothesis.code)
    return mistakes if beside_pads or len(mistakes) == len(near) else ()


def certain(causes: Sequence[Cause]) -> bool:
    """Whether it is certainly a mistake: no pads explain the ramps as well."""
    near = _candidates(causes)
    return bool(near) and near[0].log_odds > CERTAIN and all(c.hypothesis.code for c in near)


def other_than_pads(causes: Sequence[Cause]) -> str:
    """A mistake that explains the ramps nearly as well as other pads do, in words; or ""."""
    best = max(c.log_odds for c in causes if not c.hypothesis.code)
    near = (c for c in causes if c.hypothesis.code in _IN_WORDS and c.log_odds > best - SURE)
    for cause in near:
        axle = AXLE_NAMES[cause.hypothesis.axle]
        return _IN_WORDS[cause.hypothesis.code].format(axle=axle, size=cause.size[0])
    return ""


def measured(causes: Sequence[Cause], beside_pads: bool = True) -> Iterator[Measured]:
    """Yield the mistakes that are named, as figures of `rules.csv`."""
    for cause in named(causes, beside_pads):
        code, axle, size = cause.hypothesis.code, cause.hypothesis.axle, cause.size
        value, words = size[0], {"axle": AXLE_NAMES[axle], "channel": f"T_drive_{axle}"}
        if code == SCALE:
            words |= {"factor": f"{value:.3g}", "cause": _why(value)}
        elif code == DRAG:
            value /= 1e5
        elif code in (MOTOR, VALVE):
            words["bar"] = f"{size[code == MOTOR] / 1e5:.0f}"
        yield Measured(code, 1.0 if code == VALVE else value, words=words)


def _why(factor: float) -> str:
    """Likely reason for a factor on a torque at the wheels, in words."""
    if factor < 0.0:
        return "another sign: what slows the car is negative"
    if factor < 1.0:
        return "a torque that is asked for, not the one that acts"
    several = "one motor of several, where the torque of all is meant"
    shaft = "the torque at the shaft of a motor, where that at the wheels is meant"
    return several if factor < 3.5 else shaft


def _top(sizes: Sequence[Size], log: Array, best: int) -> float:
    """The first parameter of the best size, refined by a parabola through its neighbours."""
    first, *others = sizes[best]
    line = sorted(
        (size[0], each)
        for size, each in zip(sizes, log.tolist(), strict=True)
        if [*size[1:]] == others
    )
    middle = line.index((first, float(log[best])))
    near = np.array(line[max(middle - 1, 0) : middle + 2])
    if len(near) < 3:
        return first
    bend, slope, _ = np.polyfit(near[:, 0] - first, near[:, 1], 2)
    return float(first - 0.5 * slope / bend) if bend < 0.0 else first


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
        stiff = STOP.log_stiffness.mean[1] + 0.25 * (log_peak - math.log(0.9))
        softer = np.where(np.arange(e.size) % 2, np.exp(-stiff), 1.0)
        centre[:, :2] *= softer[:, None]
        root[:, :2] *= softer[:, None, None]
        e = replace(e, peak=np.exp(log_peak))
    return e, centre, root


def _log_mean(x: Array) -> float:
    """ln of the mean of exp ``x`` (n,)."""
    most = float(np.max(x))
    return most + math.log(np.mean(np.exp(x - most))) if math.isfinite(most) else most


class _Sum:
    """The sum of forces of a run, by means of groups of its braked blocks.

    brakes = level N(pressure) (1 + discrepancy + trend), from the zero on the lead-in.
    """

    def __init__(self, car: Vehicle, run: RampRun) -> None:
        b, self.car, self.run, self.braked = run.blocks, car, run, np.flatnonzero(run.braked)
        groups = np.array_split(self.braked, min(_POINTS, self.braked.size))
        self.sizes = np.array([g.size for g in groups])
        self.z, time, length = self._means(b.z), self._means(b.end), self.sizes * b.length
        along = (time - time.mean()) / max(float(np.ptp(time)), b.length)
        near = np.exp(-0.5 * ((self.z[:, None] - self.z) / _LENGTH) ** 2)
        self.relative = _DEPARTS**2 * near + np.outer(along, along) * _TREND**2
        self.absolute = np.diag(run.noise.z**2 / length) + _ZERO**2
        self._read_pressures(run)

    def _means(self, x: Array) -> Array:
        first = np.cumsum(self.sizes) - self.sizes
        return np.asarray(np.add.reduceat(x[self.braked], first) / self.sizes)

    def _read_pressures(self, run: RampRun) -> None:
        front, rear = brake_forces(self.car, run.blocks.p_f, run.blocks.p_r)
        N = self._means(front + rear) / self.car.weight
        root = np.linalg.cholesky(self.absolute + np.outer(N, N) * self.relative)
        self.white = np.linalg.inv(root)
        self.unit = self.white @ N
        self.log = -0.5 * math.log(self.unit @ self.unit) - float(np.log(np.diag(root)).sum())

    def evidence(self, run: RampRun) -> tuple[float, float, float]:
        """ln of the evidence of ``run``, ln of the pads' level, and the misfit."""
        own = self
        if run.blocks.p_r is not self.run.blocks.p_r:
            own = copy.copy(self)
            own._read_pressures(run)
        rolling = self.run.rolling
        zero = np.mean(run.brake_sum[rolling]) if rolling.size else 0.0
        forces = own.white @ ((self._means(run.brake_sum) - zero) / self.car.weight)
        level = float(own.unit @ forces / (own.unit @ own.unit))
        residual = forces - level * own.unit
        square = float(residual @ residual)
        return own.log - 0.5 * square, math.log(max(level, 1e-2)), square


class _Evidence:
    """Evidence of hypotheses on the ramps of a car."""

    def __init__(self, car: Vehicle, runs: Sequence[RampRun], other_road: bool) -> None:
        self.car, self.runs, self.draws = car, runs, _draws(other_road)
        self.regression, self.share = Regression(car, list(runs)), front_share(car, 0.0)
        self.loaded = self.regression.loaded(self.draws[0])
        self.sums = [_Sum(car, run) for run in runs]
        self.as_read = self._evidence(runs)  # the same whatever the pads

    def screened(self, mistakes: Sequence[Hypothesis], pads: Sequence[Cause]) -> list[Cause]:
        """Mistakes by a part of the draws, by which the best ``pads`` have the odds of all draws.

        The part are the draws by which other pads explain the runs best, and the first of all.
        """
        level = float(np.mean([level for _, level, _ in self.as_read[0]]))
        priors = [self._prior(level, self.draws[0].log_pad_ratio, c.hypothesis.pads) for c in pads]
        likely = np.argsort(-self.as_read[1].log_evidence - np.max(priors, axis=0), kind="stable")
        part = self._by(np.union1d(likely[:_LIKELY], np.arange(_FIRST)))
        nothing, *others = (part.cause(c.hypothesis, -math.inf).log_odds for c in pads)
        more = max(c.log_odds for c in pads) - max(nothing, *others)
        causes = (part.cause(h, nothing - _SCREENING_ERROR) for h in mistakes)
        return [replace(cause, log_odds=cause.log_odds + more) for cause in causes]

    def _by(self, draws: Index) -> "_Evidence":
        """The evidence by some of the draws alone."""
        other, (e, centre, root) = copy.copy(self), self.draws
        other.draws = e.take(draws), centre[draws], root[draws]
        other.loaded = [tyres.take(draws) for tyres in self.loaded]
        other.as_read = self.as_read[0], self.as_read[1].take(draws)
        return other

    def cause(self, h: Hypothesis, nothing: float) -> Cause:
        """The hypothesis with ln of (odds times evidence), and its best size.

        ``nothing`` ln of the evidence of "nothing wrong".
        """
        fits = {size: self._size_evidence(h, size) for size in h.first}
        if h.sizes != h.first and max(fits.values())[0] > nothing - _NEAR:
            fits = {size: fits.get(size) or self._size_evidence(h, size) for size in h.sizes}
        sizes, each = tuple(fits), np.array([log for log, _ in fits.values()])
        best = int(np.argmax(each))
        log = _log_mean(each) + math.log(h.odds)
        size = (_top(sizes, each, best), *sizes[best][1:]) if sizes[best] else ()
        log = max(log, _NEVER)  # of what no draw explains
        return Cause(h, log, size, fits[sizes[best]][1])

    def _size_evidence(self, h: Hypothesis, size: Size) -> tuple[float, float]:
        """ln of the evidence of one size, and the mean square residual of its best draw."""
        undo = h.undo
        sums, split = self._evidence([undo(r, size) for r in self.runs]) if undo else self.as_read
        level = float(np.mean([level for _, level, _ in sums]))
        each = split.log_evidence + self._prior(level, self.draws[0].log_pad_ratio, h.pads)
        residual = split.residual(int(np.argmax(each)))
        square = sum(square for _, _, square in sums) + float(residual @ residual)
        log = _log_mean(each) + sum(log for log, _, _ in sums)
        return log, square / (residual.size + _POINTS * len(self.runs))

    def _evidence(
        self, runs: Sequence[RampRun]
    ) -> tuple[list[tuple[float, float, float]], Solution]:
        """`_Sum.evidence` of each run, and the split of all by the draws."""
        regression = self.regression.with_forces_of(runs)
        sums = [of_run.evidence(run) for of_run, run in zip(self.sums, runs, strict=True)]
        return sums, regression.solve(*self.draws, self.loaded)

    def _prior(self, level: float, ratio: Array, pads: tuple[float, float]) -> Array:
        """ln of the density of pads with this ``level`` and ``ratio`` (n,) over the draws'."""
        front = (level + (1.0 - self.share) * ratio) / pads[0]
        rear = (level - self.share * ratio) / pads[1]
        less = 0.5 * (ratio / _BROAD) ** 2 + math.log(_BROAD)
        return np.asarray(less - 0.5 * (front**2 + rear**2) - math.log(pads[0] * pads[1]))
