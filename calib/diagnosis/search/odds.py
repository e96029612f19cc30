"""How probable explanations make logs: those held out, and logs that are alike."""

from dataclasses import replace

import numpy as np

from calib.diagnosis.explanation.columns import seen
from calib.diagnosis.explanation.explanation import Explanation
from calib.diagnosis.explanation.fit import ALMOST, fit
from calib.diagnosis.explanation.own import SCATTERED
from calib.diagnosis.explanation.problem import Problem


def with_alike(at: Explanation) -> Explanation:
    """The explanation with logs that are alike in what they usually differ in, where that is more
    probable.
    """
    some = (frozenset(one) for one in ((), SCATTERED, *((kind,) for kind in SCATTERED)))
    options = [replace(at.hypothesis, alike=alike - at.hypothesis.kinds) for alike in some]
    best = max(options, key=lambda one: at.marginal(sizes=one.sizes).evidence())
    return fit(at.problem, best, at.state, at.columns, ALMOST)


def density(at: Explanation, held: Problem) -> float:
    """ln of the density of other logs given those of an explanation, by one linear model of both.

    But for a constant of the rows.
    """
    own = np.zeros((len(held.runs), at.state.own.shape[1]))
    other = seen(held, at.hypothesis, replace(at.state, own=own))
    together = replace(
        at,
        problem=replace(at.problem, runs=(*at.problem.runs, *held.runs)),
        state=replace(at.state, own=np.vstack([at.state.own, own])),
        innovations=[*at.innovations, *other.innovations],
        columns=[*at.columns, *other.columns],
        rest=[*at.rest, *other.rest],
    )
    more = together.marginal().evidence() - at.marginal().evidence()
    return more - at.hypothesis.phases(len(held.runs))
