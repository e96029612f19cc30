"""Whether pads and tyres that each log has of its own can be what an explanation leaves.

Pads repeat to 2 or 3 % from one run to the next, tyres too. Replays of ten seconds show 0.1 % of
the pads, so where they differ no common pads serve, and a cause that is missing is hard to see
beside them. They are asked for only where something is left without them, and count only where
nothing is left with them: they are many parameters.
"""

from collections.abc import Sequence
from dataclasses import replace

from calib.diagnosis.explanation.base import REFERENCE, Base, Ground
from calib.diagnosis.explanation.fit import fit_base
from calib.diagnosis.explanation.problem import Problem
from calib.diagnosis.search.decide import Decision
from calib.diagnosis.search.jointly import within_reach
from calib.physics.effects.effects import Effects


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
