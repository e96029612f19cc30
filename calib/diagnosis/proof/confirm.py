"""Whether an explanation of the calibration logs holds on the hold-outs, step by step.

Nothing is fitted to the hold-outs. An effect that does not explain them better is withdrawn.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.explanation.candidate import Candidate
from calib.diagnosis.explanation.problem import Problem
from calib.diagnosis.gates import GATES
from calib.diagnosis.search.decide import Decision, confusable, strange

Array = NDArray[np.float64]

PROOF, BEYOND_DOUBT = 0.003, 0.02
"""Least gain on the hold-outs of an effect that the calibration shows, and of one that is faint."""

FELT, FELT_PART = 10.0, 0.02
"""Change of the sum of squares above which a hold-out shows the effect: three sigma, and a share of
the change in the hold-out that shows it most."""


def confirm(decision: Decision, held: Problem) -> Decision:
    """Withdraw an effect that does not help on the hold-outs, log by log.

    A log that does not show the effect is not counted. After a withdrawal the verdict is `no_gap`
    only if neither the calibration logs nor the hold-outs have a gap without the effect.
    """
    if decision.faint is not None and second_shown(decision.faint, held):
        return _without_refuted(decision.faint, held)
    if not decision.best.names:
        return decision
    fall = chi2_by_run(held, decision.base) - chi2_by_run(held, decision.best)
    count = _count_of(held, decision.base)
    if np.sum(fall) / count > (PROOF if decision.detected else BEYOND_DOUBT) and helps(fall):
        return _without_refuted(decision, held)
    on_hold_outs = float(np.sum(chi2_by_run(held, decision.base))) / count
    base = decision.base
    left = replace(base, chi2=max(on_hold_outs, base.reduced) * base.count)
    verdict = "unknown" if strange(left) else "no_gap"
    withdrawn = (decision.best, *decision.rivals)
    return replace(decision, verdict=verdict, best=base, rivals=withdrawn)


def _without_refuted(decision: Decision, held: Problem) -> Decision:
    """Drop rivals that the hold-outs refute; an ambiguous effect may then become a named one."""
    count = _count_of(held, decision.base)
    own = float(np.sum(chi2_by_run(held, decision.best)))
    refuted = [
        rival
        for rival in confusable(decision.best, decision.rivals)
        if float(np.sum(chi2_by_run(held, rival))) - own > BEYOND_DOUBT * count
    ]
    rivals = tuple(c for c in decision.rivals if all(c is not r for r in refuted))
    verdict = decision.verdict
    if verdict == "ambiguous" and not confusable(decision.best, rivals):
        verdict = "named"
    return replace(decision, verdict=verdict, rivals=rivals)


def helps(fall: Array) -> bool:
    """Whether most of the hold-outs (n,) that show an effect are explained better with it."""
    felt = fall[np.abs(fall) > max(FELT, FELT_PART * float(np.max(np.abs(fall))))]
    return bool(np.mean(felt > 0.0) > 0.5) if felt.size else False


SECOND_PROOF, SECOND_PART = 0.05, 0.01
"""Least gain on the hold-outs of a faint second effect, beyond a share of the first's gain: if the
form of the first is not exact, any second effect takes half a percent of that."""


def second_shown(pair: Decision, held: Problem) -> bool:
    """Whether the hold-outs show a second effect clearly, and it explains most of the rest."""
    assert pair.first is not None
    count = _count_of(held, pair.base)
    none, first, both = (_squares(held, c) / count for c in (pair.base, pair.first, pair.best))
    fall = np.sum(first - both, axis=1)
    gained = float(np.sum(fall))
    return bool(
        gained > SECOND_PROOF
        and beyond_form(none, first, both, SECOND_PART) > SECOND_PROOF
        and gained > GATES.second_share * (float(np.sum(first)) - GATES.floor)
        and helps(fall * count)
    )


def beyond_form(before: Array, at: Array, option: Array, share: float) -> float:
    """Fall of squared innovations by a further effect that the form of others cannot have left.

    Squares by run and channel (r, c): ``before`` any effect, ``at`` the present ones, and with the
    ``option``. What is left by a form that is not exact is a ``share`` of what it explains, in
    those runs and channels: a ripple is not lost beside a delay of v.
    """
    form = share * np.maximum(before - at, 0.0)
    return float(np.sum(np.maximum(at - option - form, 0.0)))


def chi2_by_run(problem: Problem, candidate: Candidate) -> Array:
    """Sum of squared innovations of every run."""
    return np.asarray(np.sum(_squares(problem, candidate), axis=1))


def _squares(problem: Problem, candidate: Candidate) -> Array:
    return squares(problem.whitened(candidate.base, candidate.effects))


def squares(whitened: Sequence[Sequence[Array]]) -> Array:
    """Sums of squared innovations (r, c) by run and channel."""
    return np.array([[float(c @ c) for c in run] for run in whitened])


def _count_of(problem: Problem, candidate: Candidate) -> int:
    """Number of innovations of a candidate in a problem."""
    return sum(c.size for run in problem.whitened(candidate.base, candidate.effects) for c in run)
