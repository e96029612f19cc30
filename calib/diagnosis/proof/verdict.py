"""From the search to a verdict: what is named, what is as likely, and whether something is left.

    best explanation --> replays of the hold-outs --> anything left? --> more likely by a term?
                                                        no: named          yes: unknown

Something is left where the replays have lasting errors beyond three units of noise, or where the
innovations have far more than noise. It is no known effect where an empirical term alone is more
probable than all that is named.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import ModelError
from calib.diagnosis.explanation.explanation import (
    Columns,
    Explanation,
    State,
    columns_by_heat,
    columns_by_x,
    fit,
    of_all,
    own_columns,
)
from calib.diagnosis.explanation.gaussian import Products
from calib.diagnosis.explanation.own import OWN, sizes
from calib.diagnosis.explanation.problem import Problem
from calib.diagnosis.proof.hold_outs import HoldOuts
from calib.diagnosis.proof.remainder import Remainder
from calib.diagnosis.proof.terms import with_terms
from calib.diagnosis.search.search import Search
from calib.logs.log import Log

NO_GAP, NAMED, AMBIGUOUS, UNKNOWN = "no_gap", "named", "ambiguous", "unknown"

_STRANGE = 8.0
"""Scatter of the mean squared innovation from which a cause is present, whatever replays show."""


@dataclass(frozen=True)
class Replayed:
    """An explanation without a departure of its tyre, as a model has it, and what it leaves.

    ``own`` (runs, 8) of the hold-outs, ``logs`` their replays.
    """

    at: Explanation
    own: Array
    logs: tuple[Log, ...]


@dataclass(frozen=True)
class Verdict:
    """``word`` as in diagnosis.json; ``base`` without effects; ``best`` what is named, or ``base``.

    ``rivals`` as likely, ``tried`` all others, the best first; ``seen`` is ``best`` as the
    hold-outs see it; ``terms`` explanations with the best empirical terms beside ``best``,
    where something is left, best first; ``left`` in the replays
    with ``best``.
    """

    word: str
    held: HoldOuts
    base: Explanation
    best: Explanation
    rivals: tuple[Explanation, ...]
    tried: tuple[Explanation, ...]
    seen: Explanation
    before: Replayed
    after: Replayed
    left: Remainder
    terms: tuple[Explanation, ...]

    @property
    def stands(self) -> bool:
        """Whether effects are named."""
        return self.word in (NAMED, AMBIGUOUS)


def verdict_of(search: Search, logs: Sequence[Log]) -> Verdict:
    """The verdict on the ``best`` of a search, by the hold-outs ``logs``."""
    held = HoldOuts(tuple(logs), search.held)
    base, best = search.base, search.best
    before = replayed(held, base)
    after = before
    if best.names:
        try:
            after = replayed(held, best)
        except ModelError:
            best = base
    left = held.left(after.at, after.own, after.logs)
    rest = left.significant or strange(best)
    beside = tuple(with_terms(best)) if rest else ()
    if rest and best.names:
        alone = tuple(with_terms(base))
        if alone[0].log_evidence > best.log_evidence:
            best, after, beside = base, before, alone
            left = held.left(before.at, before.own, before.logs)
    rivals = search.rivals if best.names else ()
    named = AMBIGUOUS if rivals else NAMED
    word = named if best.names else UNKNOWN if rest else NO_GAP
    return Verdict(
        word, held, base, best, rivals, search.others(), seen_by(held.problem, best, after.own),
        before, after, left, beside,
    )  # fmt: skip


def seen_by(held: Problem, at: Explanation, own: Array) -> Explanation:
    """An explanation as other logs see it, its parameters as they are."""
    state = State(at.state.x, at.state.form, own)
    r = of_all(held, at.hypothesis, state)
    return Explanation(held, at.hypothesis, state, r, Columns([], [], []))


def strange(at: Explanation) -> bool:
    """Whether far more than noise is left in the innovations."""
    return at.reduced > 1.01 + _STRANGE * at.scatter


def replayed(held: HoldOuts, at: Explanation) -> Replayed:
    """Fit an explanation as a model has it, and replay the hold-outs. Raises ModelError."""
    plain = without_form(at)
    own = placed(held.problem, plain)
    return Replayed(plain, own, held.replays(plain.base, plain.effects, own))


def without_form(at: Explanation) -> Explanation:
    """The same hypothesis, with tyres that do not depart from their form."""
    none = [np.zeros_like(F) for F in at.columns.form]
    state = replace(at.state, form=np.zeros_like(at.state.form))
    hypothesis = replace(at.hypothesis, departs=False)
    return fit(at.problem, hypothesis, state, replace(at.columns, form=none))


def placed(held: Problem, at: Explanation) -> Array:
    """What each hold-out has of its own, (runs, 8), of the kinds in which the logs differ."""
    own = np.zeros((len(held.runs), len(OWN)))
    if not at.hypothesis.kinds:
        return own
    S = np.where(sizes(at.hypothesis.kinds) != sizes(()), sizes(at.hypothesis.kinds), 0.0)
    for _ in range(3):
        state = State(at.state.x, at.state.form, own)
        r = of_all(held, at.hypothesis, state)
        J = columns_by_x(held, at.hypothesis, state, r, 0)
        heat = columns_by_heat(held, at.hypothesis, state, r)
        seen = Explanation(held, at.hypothesis, state, r, Columns(J, [], heat))
        for i, one in enumerate(r):
            none = np.zeros((0, one.size))
            products = Products.of(none, own_columns(seen, i), one, own[i])
            own[i] -= products.reduced(S)[1][:, -1]
    return own
