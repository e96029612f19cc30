"""Whether pads and tyres that each log has of its own can be what an explanation leaves.

Pads repeat to 2 or 3 % from one run to the next, tyres too. Replays of ten seconds show 0.1 % of
the pads, so where they differ no common pads serve, and a cause that is missing is hard to see
beside them. They are asked for only where something is left without them, and count only where
nothing is left with them: they are many parameters.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calib.car.effects.effects import Effects
from calib.diagnosis.explanation.base import REFERENCE, Base, Ground
from calib.diagnosis.explanation.candidate import Candidate
from calib.diagnosis.explanation.fit import fit_base
from calib.diagnosis.explanation.predict import ObservedRun
from calib.diagnosis.explanation.problem import Problem
from calib.diagnosis.gates import GATES
from calib.diagnosis.search.decide import Decision
from calib.diagnosis.search.jointly import within_reach


def own_pads_of(problems: Sequence[Problem], base: Base, effects: Effects) -> dict[str, Ground]:
    """The factors on pads and tyre of each log with an explanation; none where they are common."""
    found: dict[str, Ground] = {}
    for problem in problems:
        if problem.own_pads is not None:
            names = [run.name for run in problem.runs]
            found |= zip(names, problem.grounds(base, effects), strict=True)
    return found


def with_own_pads(decision: Decision) -> Problem | None:
    """The problem of a decision with pads and tyres of each log; None if that explains too little.

    The logs are on one ground then: their own pads take the place of groups.
    """
    at = decision.best
    runs = tuple(replace(run, ground=REFERENCE) for run in at.problem.runs)
    own = replace(at.problem, runs=runs, free_radius=False, own_pads=(at.base, at.effects))
    return own if within_reach(fit_base(own)) else None


def follow_a_driver(at: Candidate) -> bool:
    """Whether the pads that the logs have of their own follow what acts in the logs.

    Pads that differ by chance do not. Those that follow the discs' temperature, the pressure or the
    speed from log to log have a cause that no effect explains, and names beside them stand for it.
    """
    if at.problem.own_pads is None:
        return False
    grounds = at.problem.grounds(at.base, at.effects)
    pairs = [
        (run, ground.logarithms)
        for run, ground in zip(at.problem.runs, grounds, strict=True)
        if _braked(run).any()
    ]
    if len(pairs) < GATES.own_pads_logs:
        return False
    return any(
        _follow([(run, own[i]) for run, own in pairs], driver)
        for i, temperature in enumerate(("temperature_f", "temperature_r"))
        for driver in (temperature, "p_mc", "v_smooth")
    )


def _follow(pads: list[tuple[ObservedRun, float]], driver: str) -> bool:
    """Whether the logarithms of the pads run along with the mean of a channel while braking."""
    from scipy.stats import pearsonr

    channels = [getattr(run, driver) for run, _ in pads]
    if any(channel is None for channel in channels):
        return False
    acting = [
        float(np.mean(channel[_braked(run)]))
        for channel, (run, _) in zip(channels, pads, strict=True)
    ]
    own = [size for _, size in pads]
    if np.ptp(own) == 0.0 or np.ptp(acting) == 0.0:
        return False
    return bool(pearsonr(acting, own).pvalue < GATES.own_pads_driven)


def _braked(run: ObservedRun) -> NDArray[np.bool_]:
    return run.p_mc > GATES.own_pads_pressure
