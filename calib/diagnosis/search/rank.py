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
from calib.car.own_effects.own_effect import every_effect
from calib.diagnosis.explanation.explanation import Explanation, of_all
from calib.diagnosis.explanation.gaussian import Products
from calib.diagnosis.explanation.hypothesis import FADE, STRENGTH, Hypothesis, State, elements_of
from calib.diagnosis.explanation.own import KINDS, sizes

Names = NDArray[np.str_]


@dataclass(frozen=True)
class Promise:
    """A hypothesis, its evidence by the linear model, and the state from which it is fitted."""

    hypothesis: Hypothesis
    log_evidence: float
    state: State


@dataclass(frozen=True)
class Further:
    """Effects by ``names`` (c,) at points ``tried`` (c) in spreads of their cards.

    And ``columns`` (c, n) of each log: how they change its innovations.
    """

    names: Names
    tried: list[Array]
    columns: list[Array]

    def without(self, names: Iterable[str]) -> "Further":
        """The columns of other effects than these."""
        (keep,) = np.nonzero(~np.isin(self.names, list(names)))
        tried = [self.tried[k] for k in keep]
        return Further(self.names[keep], tried, [of_run[keep] for of_run in self.columns])

    def joined(self, other: "Further") -> "Further":
        """These columns and others behind them."""
        pairs = zip(self.columns, other.columns, strict=True)
        columns = [np.vstack(pair) for pair in pairs]
        return Further(np.append(self.names, other.names), self.tried + other.tried, columns)


def further_columns(at: Explanation, names: Iterable[str] | None = None) -> Further:
    """Further effects, of these ``names`` or every one, beside an explanation."""
    problem, every = at.problem, every_effect(at.problem.vehicle.effects)
    new = [n for n in (every if names is None else names) if n not in at.names]
    told, points, rows = list[str](), list[Array](), list[list[Array]]()
    found = problem.mapped(partial(_changes, replace(at, problem=problem.alone)), new)
    for done, (name, changes) in enumerate(zip(new, found, strict=True)):
        problem.tell(f"trying effects: {name.replace('_', ' ')}", done, len(new))
        points += _trials(at, name)
        told += [name] * len(changes)
        rows += changes
    return Further(np.array(told), points, [np.stack(of_run) for of_run in zip(*rows, strict=True)])


def _trials(at: Explanation, name: str) -> list[Array]:
    """Points at which an effect is tried, in spreads from where its parameters count.

    Full strength first, then the further parameters, with both signs where the card allows.
    """
    elements, points = elements_of(at.problem.vehicle.effects, name), []
    further = range(1, len(elements))
    for sign in (1.0, -1.0):
        for k, shift in [(0, sign), *((k, s) for k in further for s in (-1.0, 1.0))]:
            point = np.zeros(len(elements))
            point[0], point[k] = sign, shift
            tried = zip(elements, point, strict=True)
            points += [point] if all(e.low <= x <= e.high for e, x in tried) else []
    return points


def _changes(at: Explanation, name: str) -> list[list[Array]]:
    """Changes (n,) of the innovations of each log, at each point at which an effect is tried."""
    wider, out = replace(at.hypothesis, names=(*at.names, name)), []
    for trial in _trials(at, name):
        state = replace(at.state, x=np.append(at.state.x, trial))
        moved = of_all(at.problem, wider, state)
        out.append([a - b for a, b in zip(moved, at.innovations, strict=True)])
    return out


def promises(
    at: Explanation, further: Further, most: int = 3, other: bool = False
) -> list[Promise]:
    """Further effects, at ``most`` so many, and kinds beside those of ``at``; best first."""
    new = further.without(at.names)
    products = at.products_with(new.columns)
    found = [*chain(*(_promised(at, new, products, k, most) for k in _kinds(at, other)))]
    best: dict[object, Promise] = {}
    for one in sorted(found, key=lambda p: -p.log_evidence):
        best.setdefault(one.hypothesis.key, one)
    return list(best.values())


def _promised(
    at: Explanation, new: Further, products: list[Products], kinds: frozenset[str], most: int
) -> Iterator[Promise]:
    """What logs that differ in some ``kinds`` promise, alone and with new effects."""
    model, logs = at.marginal(products, sizes(kinds)), len(products)
    alone = model.evidence()
    if kinds != at.hypothesis.kinds:
        same = Hypothesis(at.names, kinds)
        yield Promise(same, alone - same.price(logs), at.state)
    for one in _ranked(*model.beyond(), new.names, most):
        wider = Hypothesis((*at.names, *new.names[list(one.columns)].tolist()), kinds)
        begun = [new.tried[k].copy() for k in one.columns]
        for point, amount in zip(begun, one.amounts, strict=True):
            point[0] *= min(max(amount, 0.3), 4.0)
        state = replace(at.state, x=np.concatenate([at.state.x, *begun]))
        yield Promise(wider, alone + one.log_gain - wider.price(logs), state)


def _kinds(at: Explanation, other: bool) -> Iterator[frozenset[str]]:
    """The kinds of ``at``, with any ``other`` ones; discs may begin unlike where pads fade."""
    kinds = at.hypothesis.kinds
    more = [k for k in KINDS if other and k not in kinds and (k != "heat" or FADE in at.names)]
    every = chain.from_iterable(combinations(more, k) for k in range(len(more) + 1))
    return (kinds | frozenset(some) for some in every)


_WIDE = 40
"""Pairs to which a third effect is added."""


@dataclass(frozen=True)
class _Subset:
    """``columns``, their ``amounts``, and what ln of the evidence gains but for their price."""

    columns: tuple[int, ...]
    amounts: tuple[float, ...]
    log_gain: float


def _ranked(E: Array, g: Array, of: Names, most: int) -> list[_Subset]:
    """Single columns, pairs and triples of other effects, the best of each names.

    ``E`` (c, c) and ``g`` (c,) as of `Marginal.beyond`, ``of`` (c,) whose column it is. Amounts are
    positive: other signs are other columns.
    """
    A = E + np.eye(g.size) / STRENGTH**2
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
    spent = (len(some) + 1) * math.log(STRENGTH)
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
