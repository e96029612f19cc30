"""How an explanation is fitted.

Base parameters are fitted again with every candidate: pads, mass and drag can replace each other in
part. The fit is least squares in the whitened channels of `calib.diagnosis.explanation.channels`.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calib.car.effects.effects import EmpiricalTerm
from calib.diagnosis.explanation.base import PEAK_PLACE
from calib.diagnosis.explanation.candidate import Candidate, candidate_of
from calib.diagnosis.explanation.problem import Problem
from calib.diagnosis.explanation.secant import least_squares
from calib.diagnosis.explanation.vector import bounds, prior_rows, unpack, widths, with_priors
from calib.diagnosis.gates import GATES

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FreeTerm:
    """An empirical term whose values at its knots are fitted.

    ``make`` builds it from its values, of which there are ``size``, each up to ``limit``.
    """

    make: Callable[[Array], EmpiricalTerm]
    size: int
    limit: float


def fit(
    problem: Problem,
    names: tuple[str, ...],
    start: Array,
    steps: int = 20,
    term: FreeTerm | None = None,
    jacobian: Array | None = None,
    rough: bool = False,
) -> Candidate:
    """Fit base and effects from ``start`` (a vector of `unpack`).

    With a ``term``, its values at the knots are the last ones of the vector. A ``jacobian`` (n, j)
    of the innovations by its first elements is that of an explanation which this one goes on from.
    A ``rough`` fit ends after a few steps.
    """
    low, high = bounds(problem, names)
    knots, limit = (term.size, term.limit) if term else (0, 0.0)
    low = np.concatenate([low, np.full(knots, -limit)])
    high = np.concatenate([high, np.full(knots, limit)])
    own = low.size - knots

    def objective(x: Array) -> Array:
        base, effects = unpack(problem, names, x[:own])
        present = replace(effects, terms=(term.make(x[own:]),)) if term else effects
        # a prior on the bends of a term: it stays straight where the data do not need a bend
        bent = np.diff(x[own:]) / 0.5
        rows = [problem.flat(base, present), prior_rows(problem, names, x[:own]), bent]
        return np.concatenate([*rows, x[own:] / 2.0])

    first = np.clip(start, low + 1e-6, high - 1e-6)
    scale = np.concatenate([widths(problem, own), np.full(knots, 0.1)])
    known = None if jacobian is None else with_priors(problem, names, jacobian, own)
    found = least_squares(objective, first, low, high, scale, steps, known, rough)
    priors = prior_rows(problem, names, found.x[:own]).size + (2 * knots - 1 if knots else 0)
    at = candidate_of(problem, names, found.x, found.residuals[:-priors])
    fall = float(found.residuals @ found.residuals) - found.promised
    return replace(at, promised=at.chi2 - fall)


def fit_base(problem: Problem) -> Candidate:
    """The model without effects, fitted from where it starts and once more from a higher peak.

    A tyre whose peak is below what a log asks of it is held there, and no small step of the peak
    explains that log better: a fit that comes from below can end at such a tyre. One from above
    counts where it explains clearly more.
    """
    usual = fit(problem, (), problem.start)
    start = usual.x.copy()
    start[PEAK_PLACE] += GATES.higher_peak
    above = fit(problem, (), start)
    return above if usual.chi2 - above.chi2 > GATES.pressed else usual


def fit_without(at: Candidate, name: str) -> Candidate:
    """An explanation fitted anew without one of its effects; once for each."""
    if name not in at.fewer:
        at.fewer[name] = _fitted_without(at, name)
    return at.fewer[name]


def _fitted_without(at: Candidate, name: str) -> Candidate:
    places = {n: own for n, own in at.problem.places(at.names).items() if n != name}
    kept = [at.x[: at.problem.base_size], *(at.x[own] for own in places.values())]
    return fit(at.problem, tuple(places), np.concatenate(kept))
