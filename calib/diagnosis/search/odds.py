"""How probable explanations make logs: those held out, and logs that are alike."""

from dataclasses import replace

import numpy as np

from calib.diagnosis.explanation.columns import columns_by_form, columns_by_heat, columns_by_x
from calib.diagnosis.explanation.explanation import Explanation, marginal, of_all
from calib.diagnosis.explanation.fit import ALMOST, fit
from calib.diagnosis.explanation.hypothesis import Columns
from calib.diagnosis.explanation.own import SCATTERED
from calib.diagnosis.explanation.problem import Problem


def with_alike(at: Explanation) -> Explanation:
    """The explanation with logs that are alike in what they usually differ in, where that is more
    probable.
    """
    some = (frozenset(one) for one in ((), SCATTERED, *((kind,) for kind in SCATTERED)))
    options = [replace(at.hypothesis, alike=alike - at.hypothesis.kinds) for alike in some]
    best = max(options, key=lambda one: marginal(at, at.products, one.sizes).evidence())
    return fit(at.problem, best, at.state, at.columns, ALMOST)


def density(at: Explanation, held: Problem) -> float:
    """ln of the density of other logs given those of an explanation, by one linear model of both.

    But for a constant of the rows.
    """
    own = np.zeros((len(held.runs), at.state.own.shape[1]))
    state = replace(at.state, own=own)
    r = of_all(held, at.hypothesis, state)
    J = columns_by_x(held, at.hypothesis, state, r, 0)
    F = columns_by_form(held, at.hypothesis, state)
    T = columns_by_heat(held, at.hypothesis, state, r)
    known = at.columns
    together = Explanation(
        replace(at.problem, runs=(*at.problem.runs, *held.runs)),
        at.hypothesis,
        replace(state, own=np.vstack([at.state.own, own])),
        [*at.innovations, *r],
        Columns([*known.x, *J], [*known.form, *F], [*known.heat, *T]),
    )
    more = together.marginal().evidence() - at.marginal().evidence()
    return more - at.hypothesis.phases(len(held.runs))
