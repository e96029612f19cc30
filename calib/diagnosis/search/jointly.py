"""A fit of parameters together with states of single logs: their ground, the heat of their discs.

A state that is found beside parameters held still leans on them, so both are fitted at once. States
count only if nothing significant is left with them: they are many parameters, and a cause that is
in no catalogue must stay an unknown one.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.explanation.candidate import Candidate, candidate_of
from calib.diagnosis.explanation.problem import Problem
from calib.diagnosis.explanation.secant import least_squares
from calib.diagnosis.explanation.vector import bounds, prior_rows, unpack, widths
from calib.diagnosis.gates import GATES
from calib.diagnosis.search.decide import Decision, decided_anew, explains, quiet
from calib.diagnosis.search.together import left_by_all

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LogStates:
    """States (k,) of single logs: ``first`` values, bounds, and their usual change as a ``scale``.

    ``sigma`` of the prior about zero; ``driven`` the problem with the logs in given states.
    """

    first: Array
    low: Array
    high: Array
    scale: Array
    sigma: Array
    driven: Callable[[Array], Problem]


def fit_jointly(
    problem: Problem, names: tuple[str, ...], start: Array, states: LogStates
) -> Candidate:
    """Fit base and effects from ``start`` beside the states; the candidate's logs are in them."""
    known = start.size
    low, high = bounds(problem, names)
    low, high = np.concatenate([low, states.low]), np.concatenate([high, states.high])

    def rows(x: Array) -> Array:
        innovations = states.driven(x[known:]).flat(*unpack(problem, names, x[:known]))
        priors = prior_rows(problem, names, x[:known])
        return np.concatenate([innovations, priors, x[known:] / states.sigma])

    first = np.clip(np.concatenate([start, states.first]), low + 1e-6, high - 1e-6)
    scale = np.concatenate([widths(problem, known), states.scale])
    x, residuals, _ = least_squares(rows, first, low, high, scale, GATES.jointly_steps)
    priors = prior_rows(problem, names, x[:known]).size + states.sigma.size
    return candidate_of(states.driven(x[known:]), names, x[:known], residuals[:-priors])


def searched_beside(decision: Decision, at: Candidate) -> Decision:
    """The decision of a new search with the logs in the states of ``at`` if that explains them.

    Else the given one. Nothing is searched where the effects cannot explain what is left.
    """
    if not within_reach(at):
        return decision
    other = decided_anew(at)
    return other if explains(other) else decision


def within_reach(at: Candidate) -> bool:
    """Whether effects can explain what is left beside an explanation."""
    unexplained = at.reduced - quiet(at)
    if unexplained <= 0.0:
        return True
    return left_by_all(at) - quiet(at) <= GATES.beyond_reach * unexplained
