"""What further effects promise, alone and together, by one linear model of all logs.

Every effect is a column for each point of its further parameters at which it is tried. The evidence
of any of them, of pairs, of triples, with logs that differ in any kinds, then is linear algebra of
some ten rows.
"""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain, combinations, product

import numpy as np
from numpy.typing import NDArray

from calib.base.arrays import Array
from calib.car.effects.catalogue import every_effect
from calib.diagnosis.explanation.base import KINDS, sizes
from calib.diagnosis.explanation.explanation import Explanation, of_all
from calib.diagnosis.explanation.gaussian import Products
from calib.diagnosis.explanation.hypothesis import FADE, STRENGTH, Hypothesis, State, elements_of

Names = NDArray[np.str_]

_WIDE = 40  # pairs to which a third effect is added


@dataclass(frozen=True)
class Promise:
    """A hypothesis, its evidence by the linear model, and the state from which it is fitted."""

    hypothesis: Hypothesis
    log_evidence: float
    state: State


@dataclass(frozen=True)
class Trial:
    """An effect at a ``point`` in spreads of its card, and what it ``changes`` (n,) in each log."""

    name: str
    point: Array
    changes: list[Array]


def trials(at: Explanation, names: Iterable[str] | None = None) -> list[Trial]:
    """Further effects, of these ``names`` or every one, beside an explanation."""
    problem, every = at.problem, every_effect(at.problem.vehicle.effects)
    new = [n for n in (every if names is None else names) if n not in at.names]
    found = problem.mapped(partial(_tried, at.alone), new)
    out = list[Trial]()
    for done, (name, of_name) in enumerate(zip(new, found, strict=True)):
        problem.tell(f"trying effects: {name.replace('_', ' ')}", done, len(new))
        out += of_name
    return out


def _tried(at: Explanation, name: str) -> list[Trial]:
    """An effect at full strength of either sign, then with each further parameter a spread away."""
    elements, out = elements_of(at.problem.vehicle.effects, name), []
    lags = at.lags
    wider, unit = replace(at.hypothesis, names=(*at.names, name)), np.eye(len(elements))
    shifts = [0.0 * unit[0], *(s * other for other in unit[1:] for s in (-1.0, 1.0))]
    for sign, shift in product((1.0, -1.0), shifts):
        point = sign * unit[0] + shift
        if all(e.low <= x <= e.high for e, x in zip(elements, point, strict=True)):
            state = replace(at.state, x=np.append(at.state.x, point))
            moved = zip(of_all(at.problem, wider, state, lags)[1], at.innovations, strict=True)
            out.append(Trial(name, point, [a - b for a, b in moved]))
    return out


def promises(
    at: Explanation, further: Iterable[Trial], most: int = 3, other: bool = False
) -> list[Promise]:
    """Further effects, at ``most`` so many, and kinds beside those of ``at``; best first."""
    new = [trial for trial in further if trial.name not in at.names]
    by_log = zip(*(trial.changes for trial in new), strict=True)
    products = at.products_with([np.stack(of_log) for of_log in by_log])
    found = chain.from_iterable(_promised(at, new, products, k, most) for k in _kinds(at, other))
    best: dict[object, Promise] = {}
    for one in sorted(found, key=lambda p: -p.log_evidence):
        best.setdefault(one.hypothesis.key, one)
    best.pop(at.hypothesis.key, None)
    return list(best.values())


def _promised(
    at: Explanation, new: list[Trial], products: list[Products], kinds: frozenset[str], most: int
) -> Iterator[Promise]:
    """What logs that differ in some ``kinds`` promise, alone and with new effects."""
    model = at.marginal(products, sizes(kinds))
    alone, names = model.evidence(), np.array([trial.name for trial in new])
    for one in (_Subset((), (), 0.0), *_ranked(*model.beyond(), names, most)):
        some = [new[k] for k in one.columns]
        hypothesis = Hypothesis((*at.names, *(trial.name for trial in some)), kinds)
        begun = [trial.point.copy() for trial in some]
        for point, amount in zip(begun, one.amounts, strict=True):
            point[0] *= min(max(amount, 0.3), 4.0)
        state = replace(at.state, x=np.concatenate([at.state.x, *begun]))
        gain = one.log_gain - hypothesis.price(len(products))
        yield Promise(hypothesis, alone + gain, state)


def _kinds(at: Explanation, other: bool) -> Iterator[frozenset[str]]:
    """The kinds of ``at``, with any ``other`` ones; discs may begin unlike where pads fade."""
    kinds = at.hypothesis.kinds
    more = [k for k in KINDS if other and k not in kinds and (k != "heat" or FADE in at.names)]
    every = chain.from_iterable(combinations(more, k) for k in range(len(more) + 1))
    return (kinds | frozenset(some) for some in every)


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
    A, found = E + np.eye(g.size) / STRENGTH**2, list[_Subset]()
    starts: list[tuple[int, ...]] = [()]
    for size in range(most):
        best: dict[frozenset[str], _Subset] = {}
        wider = (one for start in starts for one in _beside(A, g, of, start))
        for one in sorted(wider, key=lambda one: -one.log_gain):
            best.setdefault(frozenset(of[list(one.columns)]), one)
        found += best.values()
        starts = [one.columns for one in list(best.values())[:_WIDE]]
        if size == 0:
            starts = [(k,) for k in range(g.size)]
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
    order = np.argsort(-gain)
    order = order[np.isfinite(gain[order])]
    first_of_each = np.sort(np.unique(of[order], return_index=True)[1])
    return [
        _Subset((*columns, k), (*first[:, k].tolist(), float(last[k])), float(gain[k]))
        for k in order[first_of_each].tolist()
    ]
