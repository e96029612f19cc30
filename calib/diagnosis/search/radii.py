"""Rolling radii that are not those of the file: freed where that explains more with less.

    decision ──> does its explanation gain by other radii? ──> search with free radii ──> better?

A radius is known to some tenths of a percent, and a wheel that rolls 0.1 % faster than the file
says looks much like one that a small torque slows. So radii must be free where they are wrong.
Where they are right they must not: a moment on all wheels and a slope of the road differ by a slip
of 0.05 % alone. The logs decide between the two.
"""

from dataclasses import replace

import numpy as np

from calib.diagnosis.explanation.base import BASE
from calib.diagnosis.explanation.candidate import Candidate, covariance_of, free, shown, shown_with
from calib.diagnosis.explanation.fit import fit, fit_without
from calib.diagnosis.explanation.problem import joined
from calib.diagnosis.explanation.secant import DIFFERENCE
from calib.diagnosis.explanation.vector import unpack
from calib.diagnosis.gates import GATES
from calib.diagnosis.search.decide import Decision, decided_anew, explains, gain, simplest_first
from calib.diagnosis.search.search import refine


def with_free_radii(decision: Decision) -> Decision:
    """The decision with rolling radii as base parameters where that is better, else this one.

    It is better where fewer effects explain as much, or where as many explain clearly more.
    """
    if not _promising(decision):
        return decision
    freed = _freed(decision.best)
    if not _explain_something(decision, freed) and not _replace_an_effect(decision, freed):
        return decision
    other = decided_anew(freed)
    return other if _better(decision, other) else decision


def _promising(decision: Decision) -> bool:
    """Whether free radii may matter, by one linear step.

    They are not fitted where they do not gain half, and where each effect brings twice of what
    would be asked of them then.
    """
    at = decision.best
    problem, x = replace(at.problem, free_radius=True), np.insert(at.x, BASE, 0.0)
    other = x.copy()
    other[BASE] = DIFFERENCE
    change = problem.flat(*unpack(problem, at.names, other)) - joined(at.whitened)
    own = free(change, at.directions)
    fall = float(at.rest @ own) ** 2 / max(float(own @ own), 1e-12)
    if fall >= 0.5 * _least(decision):
        return True
    J = np.insert(at.jacobian, BASE, change / DIFFERENCE, axis=1)
    beside = shown_with(problem, at.names, x, covariance_of(problem, at.names, J))
    return any(
        beside[name] < 2.0 * max(GATES.confusable * at.count, GATES.radii_nearly * brings)
        for name, brings in shown(at).items()
    )


def _freed(at: Candidate) -> Candidate:
    """An explanation fitted anew with free radii."""
    problem = replace(at.problem, free_radius=True)
    return fit(problem, at.names, np.insert(at.x, BASE, 0.0))


def _explain_something(decision: Decision, freed: Candidate) -> bool:
    return decision.best.chi2 - freed.chi2 >= _least(decision)


def _least(decision: Decision) -> float:
    """Fall of the chi-square with which other radii explain something."""
    best = decision.best
    if explains(decision):
        return max(GATES.radii_least, GATES.confusable * best.count)
    return max(GATES.radii_least, GATES.radii_share * (best.chi2 - GATES.floor * best.count))


def _replace_an_effect(decision: Decision, freed: Candidate) -> bool:
    """Whether free radii do what an effect does, or nearly so.

    Two effects together can imitate radii, or radii and a third one.
    """
    best = decision.best
    for name in freed.names:
        lost = -gain(best, fit_without(freed, name))
        if lost < GATES.confusable or lost < -GATES.radii_nearly * gain(
            best, fit_without(best, name)
        ):
            return True
    return False


def _better(decision: Decision, other: Decision) -> bool:
    brought = gain(decision.best, other.best)
    if other.verdict == "unknown" and decision.verdict != "unknown":
        return False
    if len(other.best.names) < len(decision.best.names):
        return brought > -GATES.confusable
    if len(other.best.names) > len(decision.best.names) or brought <= GATES.confusable:
        return False
    return brought > _by_a_further_effect(decision)


def _by_a_further_effect(decision: Decision) -> float:
    """What one more effect would bring, with about as many parameters as other radii."""
    best = decision.best
    further = refine(best, GATES.radii_further)
    return gain(best, simplest_first(further)[0]) if further else 0.0
