"""Which effect would help: all effects are ranked, the best ones fitted.

All are those of the catalogue and the own ones of the vehicle.

Ranking takes one linear step: add the effect at its usual size, compute the change of the
innovations, project out the changes that base parameters can make, and project the present
innovations on the rest. That is cheap. The best ones are then fitted in full, since lag and
hysteresis are not linear.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial

import numpy as np
from numpy.typing import NDArray

from calib.car.effects.effects import Effects
from calib.car.own_effects.own_effect import every_effect
from calib.diagnosis.explanation.candidate import Candidate, free
from calib.diagnosis.explanation.fit import fit
from calib.diagnosis.explanation.problem import joined
from calib.diagnosis.gates import GATES
from calib.diagnosis.search.changes import (
    EffectChange,
    changes_by,
    further_changes,
    further_effects,
)

Array = NDArray[np.float64]


@dataclass(frozen=True)
class _Hint:
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


@lru_cache(maxsize=4)
def hints(at: Candidate) -> list[_Hint]:
    """One-step gains of every effect not yet in ``at``, best first."""
    found = [_hint(at, name, changes) for name, changes in further_changes(at).items()]
    return sorted(found, key=lambda hint: -hint.gain)


def _hint(at: Candidate, name: str, changes: Sequence[EffectChange]) -> _Hint:
    """The best step along one effect."""
    parameters = at.problem.parameters_of(name)
    best = _Hint(name, 0.0, np.concatenate([at.x, np.zeros(parameters)]))
    for change in changes:
        gain, amount = _along(at.rest, change)
        if amount > 0.0 and gain > best.gain:
            best = _Hint(name, gain, np.concatenate([at.x, begun(change.trial, amount)]))
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


def refine(
    at: Candidate, count: int = GATES.refined, below: float = math.inf, but: str = ""
) -> list[Candidate]:
    """Fit the most promising effects on top of ``at``, best first; all ``but`` one.

    Those alone that may come ``below`` a chi-square, or leave no more than noise. All are fitted
    roughly, then those to their end that may still do so and be the best.
    """
    noise = GATES.floor * at.count
    hopeful = [hint for hint in hints(at)[:count] if hint.gain > 0.0 and hint.name != but]
    tried = [hint for hint in hopeful if _in_reach(at.chi2 - hint.gain, max(below, noise))]
    _side_by_side(at, _roughly, [hint for hint in tried if hint.name not in at.further])
    least = min((at.further[hint.name].chi2 for hint in tried), default=0.0)
    best = max(noise, min(least, below))
    _side_by_side(at, _to_its_end, [hint for hint in tried if _is_open(at, hint, best)])
    return sorted((at.further[hint.name] for hint in tried), key=lambda found: found.chi2)


def _in_reach(promised: float, least: float) -> bool:
    """Whether an explanation to which this chi-square is ``promised`` may come below another one.

    The promise is that of one linear step.
    """
    return GATES.promise * promised < least


def added(at: Candidate, name: str) -> Candidate:
    """The explanation with one further effect, fitted."""
    hint = _hint(at, name, changes_by(at, name, at.directions))
    return _to_its_end(at, at.jacobian, (hint, _roughly(at, at.jacobian, (hint, None))))


_Item = tuple[_Hint, Candidate | None]
"""A hint, and the fit that was begun with it."""


def _side_by_side(
    at: Candidate, fitted: Callable[[Candidate, Array, _Item], Candidate], tried: Sequence[_Hint]
) -> None:
    """Fit what is ``tried``, and keep it as ``further`` of the explanation."""
    problem = at.problem
    alone = replace(at, problem=problem.alone)
    begun = (at.further.get(hint.name) for hint in tried)
    items = [
        (hint, found and replace(found, problem=alone.problem))
        for hint, found in zip(tried, begun, strict=True)
    ]
    results = problem.mapped(partial(fitted, alone, at.jacobian), items)
    for i, hint in enumerate(tried):
        problem.tell(f"fitting the best, effect {i + 1} of {len(tried)}", i, len(tried))
        at.further[hint.name] = replace(next(results), problem=problem)


def _roughly(at: Candidate, jacobian: Array, item: _Item) -> Candidate:
    """Fit an effect in a few steps; ``jacobian`` (n, k) is that before it."""
    hint, _ = item
    return fit(at.problem, (*at.names, hint.name), hint.start, jacobian=jacobian, rough=True)


def _is_open(at: Candidate, hint: _Hint, best: float) -> bool:
    """Whether more than a rough fit could matter beside the ``best`` chi-square of all."""
    found = at.further[hint.name]
    if _in_reach(found.promised, best) and not found.converged:
        return True
    return _in_reach(at.chi2 - hint.gain, best) and _short(at, hint, found)


def _short(at: Candidate, hint: _Hint, found: Candidate) -> bool:
    """Whether a fit gains clearly less than its hint promised."""
    return at.chi2 - found.chi2 <= 0.5 * hint.gain


def _to_its_end(at: Candidate, jacobian: Array, item: _Item) -> Candidate:
    """Go on from a rough fit; once more from a full spread if it gains too little.

    A hysteresis loop narrower than the noise of the pressure brings no gain, so a fit that starts
    there does not leave it.
    """
    hint, begun = item
    assert begun is not None
    first = begun if begun.converged else fit(at.problem, begun.names, begun.x)
    if not _short(at, hint, first):
        return first
    further = hint.start.copy()
    further[at.x.size] = np.copysign(1.0, further[at.x.size])
    other = fit(at.problem, begun.names, further, jacobian=jacobian)
    return min(first, other, key=lambda candidate: candidate.chi2)
