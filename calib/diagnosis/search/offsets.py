"""Whether each log has a road slope, or a zero of the accelerometer, of its own.

    each log, before it is braked --> dv/dt less a_x --> do logs differ? --> which explains them?

Before anything brakes, dv/dt and a_x differ by the slope of the road and by the zero of a_x, and by
nothing else that is as large: what slows the car is felt by both. One road driven in both
directions, or two roads, give each log a slope of its own. That is a state of a log and no effect.
A slope or a zero that all logs have in common is in these states, too, and is not searched for.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from calib.base.names import G
from calib.car.effects.effects import Effects
from calib.car.lag import integral
from calib.diagnosis.explanation.base import Base
from calib.diagnosis.explanation.candidate import Candidate
from calib.diagnosis.explanation.channels import (
    CHANNELS,
    DRIFT,
    LONG,
    ChannelNoise,
    thinned,
    unbraked_length,
)
from calib.diagnosis.explanation.fit import fit, fit_base
from calib.diagnosis.explanation.offsets import GRADE, PARAMETERS, ZERO
from calib.diagnosis.explanation.predict import ObservedRun
from calib.diagnosis.explanation.problem import Problem
from calib.diagnosis.gates import GATES
from calib.diagnosis.search.decide import Decision, decide, explains


@dataclass(frozen=True)
class LogOffsets:
    """The size that an ``effect`` has in each log: ``values`` of its ``parameter`` by log."""

    effect: str
    parameter: str
    unit: str
    values: Mapping[str, float]


def decided_with_offsets(problem: Problem, holdout: Sequence[ObservedRun]) -> Decision:
    """The decision on a problem; each log has an offset in it where the logs differ by that.

    Slopes are tried and zeros, that first whose offsets over whole logs are those before anything
    brakes: a missing effect tells of itself under braking alone. The other one is tried where the
    explanation of the first would be better with it, or where there is none and the other agrees
    nearly as well. The hold-outs are asked before they are braked, too: a slope that they have
    would be left there.
    """
    known = problem.vehicle.effects
    kinds = [name for name in (GRADE, ZERO) if name not in known]
    if not kinds or not differ([*problem.runs, *holdout], problem.noise):
        return decide(fit_base(problem))
    bases = [fit_base(replace(problem, offset=name)) for name in kinds]
    (unlike, first), *others = sorted(((_unlike(at), at) for at in bases), key=lambda one: one[0])
    found = [decide(first)]
    best = found[0].best
    for apart, other in others:
        if explains(found[0]):
            changed = fit(replace(best.problem, offset=other.problem.offset), best.names, best.x)
            asked = changed.chi2 < best.chi2
        else:
            asked = apart < GATES.offsets_unlike * unlike
        if asked:
            found.append(decide(other))
    return min(found, key=lambda decision: (not explains(decision), decision.best.reduced))


def offsets_of(problems: Sequence[Problem], base: Base, effects: Effects) -> LogOffsets | None:
    """The offsets of the runs of ``problems`` with an explanation; None where they have none."""
    effect = problems[0].offset
    if not effect:
        return None
    values: dict[str, float] = {}
    for problem in problems:
        names = [run.name for run in problem.runs]
        values |= zip(names, problem.offsets(base, effects), strict=True)
    return LogOffsets(effect, *PARAMETERS[effect], values)


def differ(runs: Sequence[ObservedRun], noise: ChannelNoise) -> bool:
    """Whether dv/dt less a_x of the unbraked parts differs between runs by more than its errors."""
    shown = [part for run in runs if (part := _disagreement(run, noise)) is not None]
    if len(shown) < 2:
        return False
    value, sigma = np.array(shown).T
    weight = 1.0 / (sigma**2 + GATES.offsets_alike**2)
    mean = float(weight @ value / np.sum(weight))
    off = float(weight @ (value - mean) ** 2)
    free = len(shown) - 1
    return off > free + GATES.offsets_sure * math.sqrt(2.0 * free)


def _unlike(base: Candidate) -> float:
    """Mean square [(m/s^2)^2] by which offsets over whole runs are not those before the braking.

    What all runs have in common does not count.
    """
    problem = base.problem
    unit = G if problem.offset == GRADE else 1.0
    pairs = zip(problem.runs, problem.offsets(base.base, base.effects), strict=True)
    shown = [(_disagreement(run, problem.noise), unit * offset) for run, offset in pairs]
    apart = [before[0] + offset for before, offset in shown if before is not None]
    return float(np.var(apart)) if apart else 0.0


def _disagreement(run: ObservedRun, noise: ChannelNoise) -> tuple[float, float] | None:
    """dv/dt less a_x [m/s^2] before the first braking, and its standard deviation; None if short.

    The noise of v is white, that of a_x has the mean of its AR process.
    """
    n = unbraked_length(run)
    if n < LONG:
        return None
    time = thinned(run, run.time)[:n]
    apart = thinned(run, run.v - integral(run.time, run.a_x))[:n]
    t = time - np.mean(time)
    slope = float(t @ apart / (t @ t))
    a_x = CHANNELS.index("a_x")
    mean = noise.sigma[a_x] / (1.0 - np.sum(noise.coefficients[a_x])) / np.sqrt(n)
    return slope, float(np.hypot(mean, noise.sigma[DRIFT] / np.sqrt(t @ t)))
