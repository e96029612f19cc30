"""What further effects promise, alone and together, by one linear model of all logs.

Every effect is a column for each point of its further parameters at which it is tried. The evidence
of any of them, of pairs, of triples, with logs that differ in any kinds, then is linear algebra of
some ten rows.
"""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain, combinations

import numpy as np
from numpy.typing import NDArray

from calib.base.arrays import Array
from calib.car.effects.effects import Effects
from calib.car.own_effects.own_effect import every_effect
from calib.diagnosis.explanation.explanation import Explanation, innovations
from calib.diagnosis.explanation.hypothesis import FADE, PRICE, Hypothesis, State, based
from calib.diagnosis.explanation.own import KINDS, sizes
from calib.diagnosis.explanation.vector import STRENGTH, elements_of


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


Names = NDArray[np.str_]

Further = tuple[list[Tried], list[Array]]


def promises(
    at: Explanation, further: Further, most: int = 3, other: bool = False
) -> list[Promise]:
    """Further effects, at ``most`` so many, and kinds beside those of ``at``; best first."""
    new = [k for k, one in enumerate(further[0]) if one.name not in at.names]
    tried, columns = [further[0][k] for k in new], [of_run[new] for of_run in further[1]]
    products, logs = at.products_with(columns), len(at.innovations)
    found: dict[object, Promise] = {}
    for kinds in _subsets(at) if other else [at.hypothesis.kinds]:
        model = at.marginal(products, sizes(kinds))
        log = model.evidence() - Hypothesis(at.names, kinds).price(logs)
        if kinds != at.hypothesis.kinds:
            _put(found, Promise(Hypothesis(at.names, kinds), log, at.state))
        for one in _ranked(*model.beyond(), [t.name for t in tried], most):
            names = (*at.names, *(tried[k].name for k in one.columns))
            begun = map(_begun, (tried[k].trial for k in one.columns), one.amounts)
            state = replace(at.state, x=np.concatenate([at.state.x, *begun]))
            wider = Hypothesis(names, kinds)
            gain = one.log_gain - wider.phases(logs) + Hypothesis(at.names).phases(logs)
            _put(found, Promise(wider, log + gain, state))
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


def further_columns(at: Explanation, names: Iterable[str] | None = None) -> Further:
    """Further effects at their trials, and how each changes the innovations of every log.

    Of these ``names``, or every one.
    """
    problem = at.problem
    every = every_effect(problem.vehicle.effects) if names is None else names
    names = [n for n in every if n not in at.names]
    alone = replace(at, problem=problem.alone)
    tried, rows = [], []
    found = problem.mapped(partial(_changes, alone), names)
    for done, (name, changes) in enumerate(zip(names, found, strict=True)):
        problem.tell(f"trying effects: {name.replace('_', ' ')}", done, len(names))
        for trial, change in zip(_trials(at, name), changes, strict=True):
            tried.append(Tried(name, trial))
            rows.append(change)
    return tried, [np.stack(of_run) for of_run in zip(*rows, strict=True)]


def _trials(at: Explanation, name: str) -> list[Array]:
    """Points at which an effect is tried, in spreads from where its parameters count.

    Full strength first, then the further parameters, with both signs where the card allows.
    """
    elements = elements_of(at.problem.vehicle.effects, name)

    def allowed(k: int, shift: float) -> bool:
        return elements[k].low <= shift <= elements[k].high

    further = range(1, len(elements))
    points = []
    for sign in (sign for sign in (1.0, -1.0) if allowed(0, sign)):
        shifts = [(k, shift) for k in further for shift in (-1.0, 1.0) if allowed(k, shift)]
        for k, shift in [(0, sign), *shifts]:
            point = np.zeros(len(elements))
            point[k] = shift
            point[0] = sign
            points.append(point)
    return points


def _changes(at: Explanation, name: str) -> list[list[Array]]:
    base, effects = based(at.problem, at.hypothesis, at.state)
    elements, out = elements_of(at.problem.vehicle.effects, name), []
    for trial in _trials(at, name):
        values = zip(elements, trial.tolist(), strict=True)
        more = effects.with_(Effects({name: {e.parameter.name: e.value(x) for e, x in values}}))
        of_runs = zip(at.runs, at.innovations, strict=True)
        out.append([innovations(at.problem, base, more, run) - r for run, r in of_runs])
    return out


_WIDE = 40
"""Pairs to which a third effect is added."""


@dataclass(frozen=True)
class _Subset:
    """Some ``columns``, their ``amounts`` and what ln of the evidence gains with them."""

    columns: tuple[int, ...]
    amounts: tuple[float, ...]
    log_gain: float


def _ranked(E: Array, g: Array, names: list[str], most: int) -> list[_Subset]:
    """Single columns, pairs and triples of other effects, the best of each names.

    ``E`` (c, c) and ``g`` (c,) as of `Marginal.beyond`. Amounts are positive: other signs are other
    columns.
    """
    A, of = E + np.eye(g.size) / STRENGTH**2, np.array(names)
    found = _beside(A, g, of, ())
    starts: list[tuple[int, ...]] = [(k,) for k in range(g.size)]
    for _ in range(1, most):
        best: dict[frozenset[str], _Subset] = {}
        wider = (one for start in starts for one in _beside(A, g, of, start))
        for one in sorted(wider, key=lambda one: -one.log_gain):
            best.setdefault(frozenset(of[list(one.columns)]), one)
        found += best.values()
        starts = [one.columns for one in list(best.values())[:_WIDE]]
    return found


def _beside(A: Array, g: Array, of: Names, columns: tuple[int, ...]) -> list[_Subset]:
    """Some columns with one further of each name, where all amounts are positive."""
    some = list(columns)
    inside, d = A[np.ix_(some, some)], np.diag(A)
    K = np.linalg.solve(inside, A[some])
    left = d - np.sum(A[some] * K, axis=0)
    use = (left > 1e-9 * d) & ~np.isin(of, of[some])
    own, left = g - g[some] @ K, np.where(use, left, 1.0)
    last, alone = own / left, np.linalg.solve(inside, g[some])
    first = alone[:, None] - K * last
    fall = g[some] @ alone + own * last
    determinant = np.linalg.slogdet(inside)[1] + np.log(left)
    spent = (len(some) + 1) * (math.log(STRENGTH) + PRICE)
    good = use & (last > 0.0) & np.all(first > 0.0, axis=0)
    gain = np.where(good, 0.5 * (fall - determinant) - spent, -np.inf)
    return [
        _Subset((*columns, k), (*first[:, k].tolist(), float(last[k])), float(gain[k]))
        for k in _firsts(gain, of)
    ]


def _firsts(gain: Array, names: Names) -> list[int]:
    """The best place of each name, the best first, of those with a finite gain."""
    own: dict[str, int] = {}
    for k in np.argsort(-gain).tolist():
        if np.isfinite(gain[k]):
            own.setdefault(str(names[k]), k)
    return list(own.values())
