"""What further effects promise, alone and together, by one linear model of all logs.

Every effect is a column for each point of its further parameters at which it is tried. The evidence
of any of them, of pairs, of triples, with logs that differ in any kinds, then is linear algebra of
some ten rows.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain, combinations

import numpy as np

from calib.base.arrays import Array
from calib.car.effects.effects import Effects
from calib.car.own_effects.own_effect import definition, every_effect
from calib.diagnosis.explanation.explanation import (
    FADE,
    PRICE,
    STRENGTH,
    Explanation,
    Hypothesis,
    State,
    based,
    innovations,
    marginal,
)
from calib.diagnosis.explanation.own import KINDS
from calib.diagnosis.explanation.problem import Problem
from calib.diagnosis.explanation.vector import origins, unpack


@dataclass(frozen=True)
class Promise:
    """A hypothesis, its evidence by the linear model, and the state from which it is fitted."""

    hypothesis: Hypothesis
    log_evidence: float
    state: State


@dataclass(frozen=True)
class Tried:
    """An effect by its ``name`` at one of its `_trials`, in spreads of its card."""

    name: str
    trial: Array


Further = tuple[list[Tried], list[Array]]


def promises(
    at: Explanation, further: Further, most: int = 3, other: bool = False
) -> list[Promise]:
    """Further effects, at ``most`` so many, and kinds beside those of ``at``; best first."""
    tried, columns = further
    products = [at.products_of(i, of_run) for i, of_run in enumerate(columns)]
    found: dict[object, Promise] = {}
    for kinds in _subsets(at) if other else [at.hypothesis.kinds]:
        model = marginal(at, products, kinds)
        alone = marginal(at, [p.first(model.off.size) for p in products], kinds)
        log = alone.evidence() - Hypothesis(at.names, kinds).price
        if kinds != at.hypothesis.kinds:
            _put(found, Promise(Hypothesis(at.names, kinds), log, at.state))
        for gain, which, amounts in _ranked(*model.beyond(), [t.name for t in tried], most):
            names = (*at.names, *(tried[k].name for k in which))
            begun = [_begun(tried[k].trial, a) for k, a in zip(which, amounts, strict=True)]
            state = replace(at.state, x=np.concatenate([at.state.x, *begun]))
            _put(found, Promise(Hypothesis(names, kinds), log + gain, state))
    return sorted(found.values(), key=lambda p: -p.log_evidence)


def _put(found: dict[object, Promise], one: Promise) -> None:
    key = one.hypothesis.key
    if key not in found or found[key].log_evidence < one.log_evidence:
        found[key] = one


def _begun(trial: Array, amount: float) -> Array:
    begin = trial.copy()
    begin[0] *= min(max(amount, 0.3), 4.0)
    return begin


def _subsets(at: Explanation) -> Iterator[frozenset[str]]:
    """The kinds of ``at`` with any others; discs begin with a heat of their own where pads fade."""
    other = [k for k in KINDS if k not in at.hypothesis.kinds and (k != "heat" or FADE in at.names)]
    every = chain.from_iterable(combinations(other, k) for k in range(len(other) + 1))
    return (at.hypothesis.kinds | frozenset(some) for some in every)


def further_columns(at: Explanation) -> Further:
    """Every further effect at its trials, and how each changes the innovations of every log."""
    problem = at.problem
    names = [n for n in every_effect(problem.vehicle.effects) if n not in at.names]
    alone = replace(at, problem=problem.alone)
    tried, rows = [], []
    for name, changes in zip(names, problem.mapped(partial(_changes, alone), names), strict=True):
        for trial, change in zip(_trials(at, name), changes, strict=True):
            tried.append(Tried(name, trial))
            rows.append(change)
    return tried, [np.stack(of_run) for of_run in zip(*rows, strict=True)]


def _trials(at: Explanation, name: str) -> list[Array]:
    """Points at which an effect is tried, in spreads from where its parameters count.

    Full strength first, then the further parameters, with both signs where the card allows.
    """
    known = at.problem.vehicle.effects
    card = definition(known, name).card
    origin = origins(known, card)

    def allowed(k: int, shift: float) -> bool:
        p = card.parameters[k]
        return p.low <= origin[k] + shift * p.spread <= p.high

    further = range(1, len(card.parameters))
    points = []
    for sign in (sign for sign in (1.0, -1.0) if allowed(0, sign)):
        shifts = [(k, shift) for k in further for shift in (-1.0, 1.0) if allowed(k, shift)]
        for k, shift in [(0, sign), *shifts]:
            point = np.zeros(len(card.parameters))
            point[k] = shift
            point[0] = sign
            points.append(point)
    return points


def _tried_at(problem: Problem, name: str, trial: Array) -> Effects:
    """One effect alone, at one of its `_trials`."""
    x = np.concatenate([np.zeros(problem.base_size), trial])
    return unpack(problem, (name,), x)[1].only(name)


def _changes(at: Explanation, name: str) -> list[list[Array]]:
    base, effects = based(at.problem, at.hypothesis, at.state)
    out = []
    for trial in _trials(at, name):
        more = effects.with_(_tried_at(at.problem, name, trial))
        of_runs = zip(at.runs, at.innovations, strict=True)
        out.append([innovations(at.problem, base, more, run) - r for run, r in of_runs])
    return out


_Ranked = tuple[float, tuple[int, ...], tuple[float, ...]]
_WIDE = 40


def _ranked(E: Array, g: Array, names: list[str], most: int) -> list[_Ranked]:
    """Gain of evidence, columns and their amounts, of single columns, pairs and triples.

    Amounts are positive: other signs are other columns.
    """
    names_ = np.array(names)
    A = E + np.eye(g.size) / STRENGTH**2
    d, s = np.diag(A), 2.0 * np.log(STRENGTH)
    found: list[_Ranked] = []
    a = g / d
    gain = np.where(a > 0.0, 0.5 * (g * a - np.log(d) - s) - PRICE, -np.inf)
    singles = _best(gain[:, None], [names_], names_.size)
    found += [(float(gain[i]), (i,), (float(a[i]),)) for (i,) in singles]
    if most < 2:
        return found
    i, j = np.triu_indices(g.size, 1)
    apart = names_[i] != names_[j]
    i, j = i[apart], j[apart]
    det = np.maximum(d[i] * d[j] - A[i, j] ** 2, 1e-12 * d[i] * d[j])
    a_i, a_j = (g[i] * d[j] - g[j] * A[i, j]) / det, (g[j] * d[i] - g[i] * A[i, j]) / det
    value = 0.5 * (g[i] * a_i + g[j] * a_j - np.log(det) - 2.0 * s) - 2.0 * PRICE
    value = np.where((a_i > 0.0) & (a_j > 0.0), value, -np.inf)
    order = np.argsort(-value)
    pairs, seen = [], set()
    for k in order:
        if not np.isfinite(value[k]) or len(pairs) == _WIDE:
            break
        key = frozenset((names[i[k]], names[j[k]]))
        if key not in seen:
            seen.add(key)
            pairs.append(k)
    found += [
        (float(value[k]), (int(i[k]), int(j[k])), (float(a_i[k]), float(a_j[k]))) for k in pairs
    ]
    if most < 3:
        return found
    for k in pairs:
        pair = [int(i[k]), int(j[k])]
        inside = A[np.ix_(pair, pair)]
        K = np.linalg.solve(inside, A[pair])  # (2, c)
        left = d - np.sum(A[pair] * K, axis=0)
        own = g - g[pair] @ K
        use = (left > 1e-9 * d) & ~np.isin(names_, names_[pair])
        left = np.where(use, left, 1.0)
        a_3 = own / left
        two = np.linalg.solve(inside, g[pair])[:, None] - K * a_3
        more = 0.5 * (own * a_3 - np.log(left) - s) - PRICE
        good = use & (a_3 > 0.0) & np.all(two > 0.0, axis=0)
        more = np.where(good, more, -np.inf)
        best = int(np.argmax(more))
        if np.isfinite(more[best]):
            amounts = (*two[:, best].tolist(), float(a_3[best]))
            found.append((float(value[k] + more[best]), (*pair, best), amounts))
    return found


def _best(gain: Array, names: list[Array], count: int) -> list[tuple[int, ...]]:
    """The best column of each name."""
    own: dict[str, int] = {}
    for k in np.argsort(-gain[:, 0]):
        if np.isfinite(gain[k, 0]):
            own.setdefault(str(names[0][k]), int(k))
    return [(k,) for k in own.values()][:count]
