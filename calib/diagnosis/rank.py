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
from calib.car.effects.catalogue import all_effects
from calib.diagnosis.explanation.base import KINDS, sizes
from calib.diagnosis.explanation.fit import Fit, of_all
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


def trials(fit: Fit, names: Iterable[str] | None = None) -> list[Trial]:
    """Further effects, of these ``names`` or every one, beside a fit."""
    problem, every = fit.problem, all_effects(fit.problem.vehicle.effects)
    new = [n for n in (every if names is None else names) if n not in fit.names]
    of_names = problem.mapped(partial(_tried, fit.alone), new)
    out = list[Trial]()
    for done, (name, of_name) in enumerate(zip(new, of_names, strict=True)):
        problem.tell(f"trying effects: {name.replace('_', ' ')}", done, len(new))
        out += of_name
    return out


def _tried(fit: Fit, name: str) -> list[Trial]:
    """An effect at full strength of either sign, then with each further parameter a spread away."""
    elements, out = elements_of(fit.problem.vehicle.effects, name), []
    lags = fit.lags
    wider, unit = replace(fit.hypothesis, names=(*fit.names, name)), np.eye(len(elements))
    shifts = [0.0 * unit[0], *(s * other for other in unit[1:] for s in (-1.0, 1.0))]
    for sign, shift in product((1.0, -1.0), shifts):
        point = sign * unit[0] + shift
        if all(e.low <= x <= e.high for e, x in zip(elements, point, strict=True)):
            state = replace(fit.state, x=np.append(fit.state.x, point))
            moved = zip(of_all(fit.problem, wider, state, lags)[1], fit.innovations, strict=True)
            out.append(Trial(name, point, [a - b for a, b in moved]))
    return out


def promises(
    fit: Fit, further: Iterable[Trial], most: int = 3, other: bool = False
) -> list[Promise]:
    """Further effects, at ``most`` so many, and kinds beside those of ``fit``; best first."""
    new = [trial for trial in further if trial.name not in fit.names]
    by_log = zip(*(trial.changes for trial in new), strict=True)
    products = fit.products_with([np.stack(of_log) for of_log in by_log])
    promised = chain.from_iterable(
        _promised(fit, new, products, k, most) for k in _kinds(fit, other)
    )
    best: dict[object, Promise] = {}
    for one in sorted(promised, key=lambda p: -p.log_evidence):
        best.setdefault(one.hypothesis.key, one)
    best.pop(fit.hypothesis.key, None)
    return list(best.values())


def _promised(
    fit: Fit, new: list[Trial], products: list[Products], kinds: frozenset[str], most: int
) -> Iterator[Promise]:
    """What logs that differ in some ``kinds`` promise, alone and with new effects."""
    model = fit.marginal(products, sizes(kinds))
    alone, names = model.evidence(), np.array([trial.name for trial in new])
    for subset in (_Subset((), (), 0.0), *_ranked(*model.beyond(), names, most)):
        some = [new[k] for k in subset.columns]
        hypothesis = Hypothesis((*fit.names, *(trial.name for trial in some)), kinds)
        begun = [trial.point.copy() for trial in some]
        for point, amount in zip(begun, subset.amounts, strict=True):
            point[0] *= min(max(amount, 0.3), 4.0)
        state = replace(fit.state, x=np.concatenate([fit.state.x, *begun]))
        gain = subset.log_gain - hypothesis.price(len(products))
        yield Promise(hypothesis, alone + gain, state)


def _kinds(fit: Fit, other: bool) -> Iterator[frozenset[str]]:
    """The kinds of ``fit``, with any ``other`` ones; discs may begin unlike where pads fade."""
    kinds = fit.hypothesis.kinds
    more = [k for k in KINDS if other and k not in kinds and (k != "heat" or FADE in fit.names)]
    every = chain.from_iterable(combinations(more, k) for k in range(len(more) + 1))
    return (kinds | frozenset(some) for some in every)


@dataclass(frozen=True)
class _Subset:
    """``columns``, their ``amounts``, and what ln of the evidence gains but for their price."""

    columns: tuple[int, ...]
    amounts: tuple[float, ...]
    log_gain: float


def _ranked(E: Array, g: Array, names: Names, most: int) -> list[_Subset]:
    """Single columns, pairs and triples of other effects, the best of each names.

    ``E`` (c, c) and ``g`` (c,) as of `Marginal.beyond`; ``names`` (c,) the effect of each
    column. Amounts are positive: other signs are other columns.
    """
    A, subsets = E + np.eye(g.size) / STRENGTH**2, list[_Subset]()
    starts: list[tuple[int, ...]] = [()]
    for size in range(most):
        best: dict[frozenset[str], _Subset] = {}
        wider = (one for start in starts for one in _beside(A, g, names, start))
        for one in sorted(wider, key=lambda one: -one.log_gain):
            best.setdefault(frozenset(names[list(one.columns)]), one)
        subsets += best.values()
        starts = [one.columns for one in list(best.values())[:_WIDE]]
        if size == 0:
            starts = [(k,) for k in range(g.size)]
    return subsets


def _beside(A: Array, g: Array, names: Names, columns: tuple[int, ...]) -> list[_Subset]:
    """Some columns with one further of each name, where all amounts are positive."""
    some = list(columns)
    inside, d = A[np.ix_(some, some)], np.diag(A)
    K = np.linalg.solve(inside, A[some])
    remaining_square = d - np.sum(A[some] * K, axis=0)
    use = (remaining_square > 1e-9 * d) & ~np.isin(names, names[some])
    projected, remaining_square = g - g[some] @ K, np.where(use, remaining_square, 1.0)
    last, alone = projected / remaining_square, np.linalg.solve(inside, g[some])
    first = alone[:, None] - K * last
    fall = g[some] @ alone + projected * last
    determinant = np.linalg.slogdet(inside)[1] + np.log(remaining_square)
    spent = (len(some) + 1) * math.log(STRENGTH)
    good = use & (last > 0.0) & np.all(first > 0.0, axis=0)
    gain = np.where(good, 0.5 * (fall - determinant) - spent, -np.inf)
    order = np.argsort(-gain)
    order = order[np.isfinite(gain[order])]
    first_of_each = np.sort(np.unique(names[order], return_index=True)[1])
    return [
        _Subset((*columns, k), (*first[:, k].tolist(), float(last[k])), float(gain[k]))
        for k in order[first_of_each].tolist()
    ]
