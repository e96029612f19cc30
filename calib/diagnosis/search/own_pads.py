"""Whether pads and tyres that each log has of its own can be what an explanation leaves.

Pads repeat to 2 or 3 % from one run to the next, tyres too. Replays of ten seconds show 0.1 % of
the pads, so where they differ no common pads serve, and a cause that is missing is hard to see
beside them. They are asked for only where something is left without them, and count only where
nothing is left with them: they are many parameters.
"""

from dataclasses import replace

from calib.diagnosis.explanation.candidate import Problem, fit_base
from calib.diagnosis.explanation.predict import ObservedRun
from calib.diagnosis.search.decide import Decision
from calib.diagnosis.search.jointly import within_reach


def with_own_pads(decision: Decision) -> Problem | None:
    """The problem of a decision with pads and tyres of each log; None if that explains too little.

    The logs are on one ground then: their own pads take the place of groups.
    """
    at = decision.best
    runs = tuple(replace(run, ground=ObservedRun.ground) for run in at.problem.runs)
    own = replace(at.problem, runs=runs, own_pads=(at.base, at.effects))
    return own if within_reach(fit_base(own)) else None
