"""Rank further effects, alone and together, by one linear model of all logs.

    fit --trials--> changes of the innovations --promises--> hypotheses with their evidence

A trial is an effect at a point of its parameters, which changes the innovations. In the linear
model the changes are proportional to the amount of the trial. So the evidence of one to three
effects, with any groups of random effects, follows by linear algebra from matrices with about ten
rows and a column for each trial.
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
from calib.diagnosis.explanation.fit import Fit, predict_all
from calib.diagnosis.explanation.gaussian import Products
from calib.diagnosis.explanation.hypothesis import FADE, STRENGTH, Hypothesis, State, elements_of
from calib.diagnosis.explanation.unknowns import GROUPS, random_sigmas

Names = NDArray[np.str_]

_MAX_PAIRS = 40  # number of pairs to which a third effect is added
_MIN_AMOUNT, _MAX_AMOUNT = 0.3, 4.0  # limits of the amount of a trial at which a fit begins [1]


@dataclass(frozen=True)
class Promise:
    """A hypothesis and its evidence by the linear model."""

    hypothesis: Hypothesis
    log_evidence: float
    state: State  # where its fit begins


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
    """Try an effect at a strength of x = 1 and -1, also with each further parameter at 1 and -1."""
    elements = elements_of(fit.problem.vehicle.effects, name)
    unit = np.eye(len(elements))
    wider = replace(fit.hypothesis, names=(*fit.names, name))
    shifts = [0.0 * unit[0], *(sign * further for further in unit[1:] for sign in (-1.0, 1.0))]
    collected = []
    for sign, shift in product((1.0, -1.0), shifts):
        point = sign * unit[0] + shift
        if all(e.low <= x <= e.high for e, x in zip(elements, point, strict=True)):
            state = replace(fit.state, x=np.append(fit.state.x, point))
            _, moved = predict_all(fit.problem, wider, state, fit.lags)
            changes = [a - b for a, b in zip(moved, fit.innovations, strict=True)]
            collected.append(Trial(name, point, changes))
    return collected


def promises(
    fit: Fit, candidates: Iterable[Trial], most: int = 3, more_groups: bool = False
) -> list[Promise]:
    """Rank ``fit`` with up to ``most`` of the ``candidates``; best first.

    With ``more_groups`` logs may differ in further groups, too.
    """
    tried = [trial for trial in candidates if trial.name not in fit.names]
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
            point[0] *= min(max(amount, _MIN_AMOUNT), _MAX_AMOUNT)
        state = replace(fit.state, x=np.concatenate([fit.state.x, *points]))
        gain = subset.log_gain - hypothesis.price(len(products))
        yield Promise(hypothesis, without + gain, state)


def _groups(fit: Fit, more_groups: bool) -> Iterator[frozenset[str]]:
    """The groups of ``fit``; with ``more_groups`` also together with any further groups."""
    groups = fit.hypothesis.groups
    further = [group for group in GROUPS if group not in groups] if more_groups else []
    if "heat" in further and FADE not in fit.names:
        further.remove("heat")  # heats of discs act through the fade alone
    subsets = chain.from_iterable(combinations(further, k) for k in range(len(further) + 1))
    return (groups | frozenset(subset) for subset in subsets)


@dataclass(frozen=True)
class _Subset:
    """Some ``columns`` of trials, their ``amounts`` [1], and the gain of ln of the evidence."""

    columns: tuple[int, ...]
    amounts: tuple[float, ...]
    log_gain: float  # before the price


def _ranked(E: Array, g: Array, names: Names, most: int) -> list[_Subset]:
    """Subsets of up to ``most`` columns of different effects, the best for each set of effects.

    ``E`` (c, c) and ``g`` (c,) are those of `Marginal.eliminated`, ``names`` (c,) the effects of
    the columns. Amounts are positive: the other sign of an effect is another column. Each has a
    normal prior with the standard deviation `STRENGTH`.
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
        if size == 0:  # pairs begin at each trial, also at one that is not the best of its effect
            starts = [(k,) for k in range(g.size)]
        else:
            starts = [subset.columns for subset in list(best.values())[:_MAX_PAIRS]]
    return subsets


def _extended(A: Array, g: Array, names: Names, columns: tuple[int, ...]) -> list[_Subset]:
    """The j ``columns`` with a further column, the best of each name, if all amounts are positive.

    The amounts solve A x = g. A Schur complement gives that of each of c further columns at once.
    """
    fixed = list(columns)
    inside, d = A[np.ix_(fixed, fixed)], np.diag(A)
    K = np.linalg.solve(inside, A[fixed])  # (j, c)
    schur = d - np.sum(A[fixed] * K, axis=0)  # (c,)
    is_possible = (schur > 1e-9 * d) & ~np.isin(names, names[fixed])
    schur, projected = np.where(is_possible, schur, 1.0), g - g[fixed] @ K
    amount = projected / schur  # of the further column (c,)
    without = np.linalg.solve(inside, g[fixed])  # amounts of the j columns without it (j,)
    beside = without[:, None] - K * amount  # amounts of the j columns beside it (j, c)
    fall = g[fixed] @ without + projected * amount
    log_determinant = np.linalg.slogdet(inside)[1] + np.log(schur)
    log_prior = (len(fixed) + 1) * math.log(STRENGTH)
    is_allowed = is_possible & (amount > 0.0) & np.all(beside > 0.0, axis=0)
    gain = np.where(is_allowed, 0.5 * (fall - log_determinant) - log_prior, -np.inf)
    best: dict[str, _Subset] = {}
    for k in np.argsort(-gain).tolist()[: np.count_nonzero(is_allowed)]:  # allowed ones come first
        if names[k] not in best:
            amounts = (*beside[:, k].tolist(), float(amount[k]))
            best[names[k]] = _Subset((*columns, k), amounts, float(gain[k]))
    return list(best.values())
