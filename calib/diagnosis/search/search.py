"""Which effect would help: all effects are ranked, the best ones fitted.

All are those of the catalogue and the own ones of the vehicle.

Ranking takes one linear step: add the effect at its usual size, compute the change of the
innovations, project out the changes that base parameters can make, and project the present
innovations on the rest. That is cheap. The best ones are then fitted in full, since lag and
hysteresis are not linear.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.explanation.candidate import Candidate, fit, free, joined
from calib.diagnosis.gates import GATES
from calib.diagnosis.search.changes import (
    EffectChange,
    changes_by,
    further_changes,
    further_effects,
)
from calib.physics.effects.effects import Effects
from calib.physics.own_effects.own_effect import every_effect

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Hint:
    """Result of one step: the expected ``gain`` in chi-square, the vector ``start`` of a fit."""

    name: str
    gain: float
    start: Array


def _along(rest: Array, change: EffectChange) -> tuple[float, float]:
    """Gain in chi-square along a change of innovations, and the best factor on it.

    ``rest`` (n,) are innovations without what base and present effects can do.
    """
    length = float(change.own @ change.own)
    if length == 0.0:
        return 0.0, 0.0
    amount = -float(rest @ change.own) / length
    return amount * amount * length, amount


def hints(at: Candidate) -> list[Hint]:
    """One-step gains of every effect not yet in ``at``, best first."""
    found = [_hint(at, name, changes) for name, changes in further_changes(at).items()]
    return sorted(found, key=lambda hint: -hint.gain)


def _hint(at: Candidate, name: str, changes: Sequence[EffectChange]) -> Hint:
    """The best step along one effect."""
    parameters = at.problem.parameters_of(name)
    best = Hint(name, 0.0, np.concatenate([at.x, np.zeros(parameters)]))
    for change in changes:
        gain, amount = _along(at.rest, change)
        if amount > 0.0 and gain > best.gain:
            best = Hint(name, gain, np.concatenate([at.x, begun(change.trial, amount)]))
    return best


def begun(trial: Array, amount: float) -> Array:
    """Where a fit begins: a point of `trials`, its strength times ``amount`` within sense."""
    begin = trial.copy()
    begin[0] *= min(max(amount, 0.3), 4.0)
    return begin


def unresolved(at: Candidate, least: Mapping[str, float]) -> tuple[str, ...]:
    """Effects of usual size that these runs could not have shown.

    The gain in chi-square that such an effect would have, beyond that of base and present effects,
    is below ``least`` of it. Effects that the vehicle file has are known, and not among them.
    """
    faint, effects = [], every_effect(at.problem.vehicle.effects)
    for name in further_effects(at):
        if name in at.effects:
            continue
        usual = Effects({name: effects[name].card.usual})
        change = at.problem.flat(at.base, at.effects.with_(usual)) - joined(at.whitened)
        own = free(change, at.directions)
        if float(own @ own) < least[name]:
            faint.append(name)
    return tuple(faint)


def refine(at: Candidate, count: int = GATES.refined) -> list[Candidate]:
    """Fit the most promising effects on top of ``at``; best first."""
    problem = at.problem
    tried = [hint for hint in hints(at)[:count] if hint.gain > 0.0]
    alone = replace(at, problem=problem.alone)
    results = problem.mapped(partial(_fitted, alone, at.jacobian), tried)
    fitted = []
    for i in range(len(tried)):
        problem.tell(f"fitting the best, effect {i + 1} of {len(tried)}", i, len(tried))
        fitted.append(replace(next(results), problem=problem))
    return sorted(fitted, key=lambda candidate: candidate.chi2)


def added(at: Candidate, name: str) -> Candidate:
    """The explanation with one further effect, fitted."""
    return _fitted(at, at.jacobian, _hint(at, name, changes_by(at, name, at.directions)))


def _fitted(at: Candidate, jacobian: Array, hint: Hint) -> Candidate:
    """Fit an effect; once more from a full spread if the fit gains less than its hint promised.

    ``jacobian`` (n, k) is that before it. A hysteresis loop narrower than the noise of the pressure
    brings no gain, so a fit that starts there does not leave it.
    """
    problem, names = at.problem, (*at.names, hint.name)
    first = fit(problem, names, hint.start, jacobian=jacobian)
    if at.chi2 - first.chi2 > 0.5 * hint.gain:
        return first
    further = hint.start.copy()
    further[at.x.size] = np.copysign(1.0, further[at.x.size])
    other = fit(problem, names, further, jacobian=jacobian)
    return min(first, other, key=lambda candidate: candidate.chi2)
