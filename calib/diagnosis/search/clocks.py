"""Channels that are late against each other: all at once, where nothing explains the logs without.

    explanations of the first search --> delays beside each --> the best: fit --> search --> better?

Every channel of a car comes over a message of its own. One that is late is an effect as any other,
found one at a time (`calib.diagnosis.search.search`). Where several are, each hides the next: a_x
that is late against p_mc, and v against the wheels, leave the same error at every bite, and no
single one of them takes most of it away. So all are fitted together, and those that bring nothing
are left out again. Then they are known, as if the vehicle file had them, and the search begins
anew.
"""

from dataclasses import replace

import numpy as np

from calib.car.effects.effects import Effects
from calib.diagnosis.explanation.candidate import Candidate, shown
from calib.diagnosis.explanation.fit import fit, fit_without
from calib.diagnosis.explanation.problem import Problem
from calib.diagnosis.explanation.vector import vector_of
from calib.diagnosis.gates import GATES
from calib.diagnosis.search.decide import (
    Decision,
    confusable,
    decide,
    explains,
    gain,
    quiet,
    simplest_first,
    spared,
    standing,
)
from calib.diagnosis.search.jointly import within_reach
from calib.diagnosis.search.search import refine
from calib.diagnosis.search.together import left_by

DELAYS = ("hydraulic_delay", "accelerometer_lag", "wheel_speed_delay", "speed_delay")
"""Effects by which p_mc, a_x, wheel speeds and v are late against each other."""


def with_clocks(decision: Decision) -> Decision:
    """The decision with delays of several channels where these explain the logs, and it does not.

    Or explain them better than it does, each parameter at its price: a brake line that swings is
    much like two delays.
    """
    present = decision if decision.faint is None or explains(decision) else decision.faint
    if present.verdict == "no_gap":
        return decision
    named = [c for c in (present.best, *present.rivals) if c.names]
    starts = [*named[: 1 if explains(decision) else GATES.clocks_beside - 1], decision.base]
    at, left = min(((c, _left(c)) for c in starts), key=lambda found: found[1])
    if not _worth_fitting(decision, at, left):
        return decision
    late = _spared(_with_delays(at)) if _missing(at) else at
    if not _delays_of(late) or not _worth_searching(at, late):
        return decision
    found = _beside(decision, late)
    least = GATES.confusable if explains(decision) else -GATES.confusable
    stands = found.verdict != "unknown" and _net_gain(present.best, found.best) > least
    return found if stands else decision


def _delays_of(at: Candidate) -> tuple[str, ...]:
    return tuple(name for name in at.names if name in DELAYS)


def _missing(at: Candidate) -> tuple[str, ...]:
    """The delays that an explanation does not have."""
    known = at.problem.vehicle.effects
    return tuple(name for name in DELAYS if name not in at.names and name not in known)


def _left(at: Candidate) -> float:
    """Mean squared innovation that delays would leave beside an explanation, in one step."""
    return left_by(at, _missing(at))


def _worth_fitting(decision: Decision, at: Candidate, left: float) -> bool:
    """Whether delays beside an explanation can be the matter: they leave so much in one step."""
    if explains(decision):
        return left < decision.best.reduced - GATES.confusable
    explained = at.reduced - left > GATES.clocks_share * (at.reduced - GATES.floor)
    return explained or bool(_delays_of(at))


def _worth_searching(at: Candidate, late: Candidate) -> bool:
    """Whether a search beside the fitted delays can end well."""
    most = GATES.floor + (1.0 - GATES.clocks_share) * (at.reduced - GATES.floor)
    return late.reduced <= quiet(late) or (late.reduced < most and within_reach(late))


def _with_delays(at: Candidate) -> Candidate:
    """An explanation with all delays, each from half a spread."""
    missing = _missing(at)
    start = np.zeros(sum(map(at.problem.parameters_of, missing)))
    start[[own.start - at.problem.base_size for own in at.problem.places(missing).values()]] = 0.5
    return fit(at.problem, (*at.names, *missing), np.append(at.x, start))


def _spared(at: Candidate) -> Candidate:
    """An explanation without the delays that bring nothing, the one that brings least first.

    Many are left out one after the other, so what each brings is asked of one linear step.
    """
    brings = {name: size for name, size in shown(at).items() if name in DELAYS}
    least = min(brings, key=lambda name: brings[name], default="")
    if not least or brings[least] > GATES.faint_second * at.count:
        return at
    return _spared(fit_without(at, least))


def _beside(decision: Decision, late: Candidate) -> Decision:
    """The decision of a search in which the delays of an explanation are known, on its problem."""
    delays = late.effects.only(*_delays_of(late))
    vehicle = late.problem.vehicle
    known = replace(vehicle, effects=vehicle.effects.with_(delays))
    start = late.x[: late.problem.base_size]
    beside = decide(fit(replace(late.problem, vehicle=known), (), start))
    problem = replace(beside.base.problem, vehicle=vehicle)
    present = (beside.best, *confusable(beside.best, beside.rivals))
    found = [_together(problem, delays, c) for c in present if c.names]
    found.append(fit(problem, late.names, late.x))
    best = spared(simplest_first(found)[0])
    for name in _delays_of(best):
        found += refine(fit_without(best, name), GATES.clocks_rivals)
    rivals = simplest_first([c for c in found if set(c.names) != set(best.names)])
    base = fit(problem, (), decision.base.x[: problem.base_size])
    verdict = standing(base, best, rivals)
    return Decision(verdict, base, best, tuple(rivals), chance=decision.chance)


def _together(problem: Problem, delays: Effects, at: Candidate) -> Candidate:
    """An explanation beside known ``delays``, fitted with them."""
    effects = at.effects.only(*delays.names, *at.names)
    return fit(problem, effects.names, vector_of(problem, at.x[: problem.base_size], effects))


def _net_gain(at: Candidate, other: Candidate) -> float:
    """Fall of the mean squared innovation from one explanation to another, less its price."""
    return gain(at, other) - GATES.parameter * (other.parameters - at.parameters)
