"""Rank further effects, alone and together, by one linear model of all logs.

    fit --trials--> changes of the innovations --promises--> hypotheses with their evidence

An effect has a column for each point of its parameters at which it is tried. The evidence of single
effects, pairs and triples, with logs that differ in any groups of random effects, is then linear
algebra of some ten rows.
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
from calib.diagnosis.explanation.base import GROUPS, random_sigmas
from calib.diagnosis.explanation.fit import Fit, predict_all
from calib.diagnosis.explanation.gaussian import Products
from calib.diagnosis.explanation.hypothesis import FADE, STRENGTH, Hypothesis, State, elements_of

Names = NDArray[np.str_]

_WIDE = 40  # pairs to which a third effect is added
_LEAST, _MOST = 0.3, 4.0  # factors on the strength of a trial from which a fit may begin [1]


@dataclass(frozen=True)
class Promise:
    """A hypothesis and its evidence by the linear model."""

    hypothesis: Hypothesis
    log_evidence: float
    state: State  # from which it is fitted


@dataclass(frozen=True)
class Trial:
    """An effect, and how it changes the innovations of each log."""

    name: str
    point: Array  # x of the effect
    changes: list[Array]  # (n,)


def trials(fit: Fit, names: Iterable[str] | None = None) -> list[Trial]:
    """Try further effects beside a fit: those of ``names``, or all that are known."""
    problem, catalogue = fit.problem, all_effects(fit.problem.vehicle.effects)
    further = [n for n in (catalogue if names is None else names) if n not in fit.names]
    by_name = problem.mapped(partial(_trials_of, fit.for_worker), further)
    collected: list[Trial] = []
    for number, (name, of_name) in enumerate(zip(further, by_name, strict=True)):
        problem.tell(f"trying effects: {name.replace('_', ' ')}", number, len(further))
        collected += of_name
    return collected


def _trials_of(fit: Fit, name: str) -> list[Trial]:
    """Try an effect at full strength of either sign, with each further parameter a spread off."""
    elements = elements_of(fit.problem.vehicle.effects, name)
    unit = np.eye(len(elements))
    wider = replace(fit.hypothesis, names=(*fit.names, name))
    shifts = [0.0 * unit[0], *(sign * further for further in unit[1:] for sign in (-1.0, 1.0))]
    collected = []
    for sign, shift in product((1.0, -1.0), shifts):
        point = sign * unit[0] + shift
        if all(e.low <= x <= e.high for e, x in zip(elements, point, strict=True)):
            state = replace(fit.state, x=np.append(fit.state.x, point))
            moved = predict_all(fit.problem, wider, state, fit.lags)[1]
            changes = [a - b for a, b in zip(moved, fit.innovations, strict=True)]
            collected.append(Trial(name, point, changes))
    return collected


def promises(
    fit: Fit, further: Iterable[Trial], most: int = 3, more_groups: bool = False
) -> list[Promise]:
    """Rank ``fit`` with up to ``most`` further effects, and ``more_groups`` or not; best first."""
    tried = [trial for trial in further if trial.name not in fit.names]
    by_log = zip(*(trial.changes for trial in tried), strict=True)
    products = fit.products_with([np.stack(of_log) for of_log in by_log])
    promised = [
        promise
        for groups in _groups(fit, more_groups)
        for promise in _promised(fit, tried, products, groups, most)
    ]
    best: dict[object, Promise] = {}
    for promise in sorted(promised, key=lambda p: -p.log_evidence):
        best.setdefault(promise.hypothesis.key, promise)
    best.pop(fit.hypothesis.key, None)
    return list(best.values())


def _promised(
    fit: Fit, tried: list[Trial], products: list[Products], groups: frozenset[str], most: int
) -> Iterator[Promise]:
    """Hypotheses in which logs differ in ``groups``, without and with further effects."""
    model = fit.marginal(products, random_sigmas(groups))
    without, names = model.evidence(), np.array([trial.name for trial in tried])
    for subset in (_Subset((), (), 0.0), *_ranked(*model.eliminated(), names, most)):
        chosen = [tried[k] for k in subset.columns]
        hypothesis = Hypothesis((*fit.names, *(trial.name for trial in chosen)), groups)
        points = [trial.point.copy() for trial in chosen]
        for point, amount in zip(points, subset.amounts, strict=True):
            point[0] *= min(max(amount, _LEAST), _MOST)
        state = replace(fit.state, x=np.concatenate([fit.state.x, *points]))
        gain = subset.log_gain - hypothesis.price(len(products))
        yield Promise(hypothesis, without + gain, state)


def _groups(fit: Fit, more_groups: bool) -> Iterator[frozenset[str]]:
    """The groups of ``fit``, with any further ones; discs differ in heat only where pads fade."""
    groups = fit.hypothesis.groups
    further = [
        group
        for group in GROUPS
        if more_groups and group not in groups and (group != "heat" or FADE in fit.names)
    ]
    subsets = chain.from_iterable(combinations(further, k) for k in range(len(further) + 1))
    return (groups | frozenset(subset) for subset in subsets)


@dataclass(frozen=True)
class _Subset:
    """Some ``columns``, their ``amounts``, and the gain of ln of the evidence before the price."""

    columns: tuple[int, ...]
    amounts: tuple[float, ...]
    log_gain: float


def _ranked(E: Array, g: Array, names: Names, most: int) -> list[_Subset]:
    """Single columns, pairs and triples of different effects, the best for each set of effects.

    ``E`` (c, c) and ``g`` (c,) are those of `Marginal.eliminated`, ``names`` (c,) the effects of
    the columns. Amounts are positive: the other sign of an effect is another column.
    """
    A = E + np.eye(g.size) / STRENGTH**2
    subsets: list[_Subset] = []
    starts: list[tuple[int, ...]] = [()]
    for size in range(most):
        wider = [subset for start in starts for subset in _extended(A, g, names, start)]
        best: dict[frozenset[str], _Subset] = {}
        for subset in sorted(wider, key=lambda s: -s.log_gain):
            best.setdefault(frozenset(names[list(subset.columns)]), subset)
        subsets += best.values()
        if size == 0:
            starts = [(k,) for k in range(g.size)]
        else:
            starts = [subset.columns for subset in list(best.values())[:_WIDE]]
    return subsets


def _extended(A: Array, g: Array, names: Names, columns: tuple[int, ...]) -> list[_Subset]:
    """Some columns with one further column, the best of each name, if all amounts are positive.

    The amounts solve A x = g; a Schur complement gives the last one, for all columns at once.
    """
    fixed = list(columns)
    inside, d = A[np.ix_(fixed, fixed)], np.diag(A)
    K = np.linalg.solve(inside, A[fixed])
    schur = d - np.sum(A[fixed] * K, axis=0)
    use = (schur > 1e-9 * d) & ~np.isin(names, names[fixed])
    projected, schur = g - g[fixed] @ K, np.where(use, schur, 1.0)
    last, alone = projected / schur, np.linalg.solve(inside, g[fixed])
    others = alone[:, None] - K * last
    fall = g[fixed] @ alone + projected * last
    log_determinant = np.linalg.slogdet(inside)[1] + np.log(schur)
    log_prior = (len(fixed) + 1) * math.log(STRENGTH)
    good = use & (last > 0.0) & np.all(others > 0.0, axis=0)
    gain = np.where(good, 0.5 * (fall - log_determinant) - log_prior, -np.inf)
    order = np.argsort(-gain)
    order = order[np.isfinite(gain[order])]
    best_of_each_name = np.sort(np.unique(names[order], return_index=True)[1])
    return [
        _Subset((*columns, k), (*others[:, k].tolist(), float(last[k])), float(gain[k]))
        for k in order[best_of_each_name].tolist()
    ]
