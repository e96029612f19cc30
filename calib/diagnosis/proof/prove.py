"""The proof of a decision on the hold-outs, and what is added until nothing is left.

    decision ──> do the replays get better? ──> anything left? ──> a further effect ──┐
                        no: unknown                no: done            ↑              │
                                                                       └── it helps ──┘
                                                               it does not: something else

Two measures are asked of what is left: the mean squared innovation of the calibration logs, and the
lasting errors of the replayed hold-outs (`calib.diagnosis.proof.remainder`). There is no limit to
the number of effects: each has its price by parameter, and the hold-outs must get better with each.
"""

from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from calib.base.errors import ModelError
from calib.diagnosis.explanation.candidate import Candidate
from calib.diagnosis.explanation.fit import fit_without
from calib.diagnosis.explanation.ranges import at_bound, divided, pressed
from calib.diagnosis.gates import GATES
from calib.diagnosis.proof.confirm import beyond_form, chi2_by_run, helps, squares
from calib.diagnosis.proof.hold_outs import HoldOuts
from calib.diagnosis.proof.remainder import Remainder
from calib.diagnosis.proof.unexplained import SLIP, UnexplainedTerm, place_of_rest
from calib.diagnosis.search.decide import (
    Decision,
    confusable,
    gain,
    quiet,
    refuted,
    settled,
    simplest_first,
    spared,
    strange,
)
from calib.diagnosis.search.search import hints, refine
from calib.diagnosis.search.together import together
from calib.logs.log import Log

Array = NDArray[np.float64]


FURTHER, FURTHER_REPLAYED = 0.012, 0.004
"""Least gain of a further effect in the mean squared innovation, and of one that replays show well.
Where the form of a named effect differs from the car's, a wrong one gains up to 0.009: a drag of
0.05 m^2 beside a rolling resistance that grows with speed gains 0.003 and closes 60 % of the
replays' errors. A first effect that gains less counts only where something significant is left."""


MOST, MOST_REPLAYED = 0.6, 0.7
"""Share of what is left in the replays that a further effect must close, and one with a small gain.
One that is wrong closes less: it takes over only what happens to run along with it
(tests/studies/naming.py)."""

NEARLY_NOTHING, NEARLY_NOTHING_REPLAYED = 0.07, 0.15
"""Share of the excess of the innovations, and of the lasting errors of the replays, that several
effects together may leave: what differs in their form. Of the replays it is the second one where
nothing is left in the innovations. It is told as a remainder."""


BETTER, CHANCE = 0.9, 0.3
"""Replays have become better if less than this share of their lasting errors is left; where they
were small before, if they have not grown by more than this, in units of the noise."""


@dataclass(frozen=True)
class Withdrawn:
    """An explanation that fits the calibration logs and does not hold on the hold-outs.

    ``names`` of its effects; ``closed`` the share of the lasting errors of the replays that it
    closes [1], negative where they grow, None where it cannot be replayed.
    """

    names: tuple[str, ...]
    closed: float | None


@dataclass(frozen=True)
class SearchStep:
    """One step: the effects present, mean squared innovation and size of the remainder [1]."""

    names: tuple[str, ...]
    innovation: float
    left: float


@dataclass(frozen=True)
class Proved:
    """A decision with what speaks for it.

    ``held`` the hold-outs; ``before`` and ``after`` are their replays without effects and with
    those of the decision; ``left`` what remains in the latter, ``rest`` whether that, or what
    remains in the innovations, is significant; ``withdrawn`` what did not hold; ``steps`` the
    course of the search; ``placed`` where what is left acts, if that was asked on the way.
    """

    held: HoldOuts
    decision: Decision
    before: tuple[Log, ...]
    after: tuple[Log, ...]
    left: Remainder
    rest: bool
    withdrawn: tuple[Withdrawn, ...]
    steps: tuple[SearchStep, ...]
    placed: UnexplainedTerm | None = None


def prove(held: HoldOuts, decision: Decision) -> Proved:
    """Withdraw what makes the hold-outs worse, then add effects while that makes them better.

    Something is left, too, where the range of a parameter holds it: see `pressed`.
    """
    found = _named_with(held, decision)
    if found.rest:
        found = _from_a_runner_up(held, decision) or found
    if found.decision.verdict not in ("named", "ambiguous"):
        return found
    found = _unless_held(held, _one_for_two(held, _exchanged(held, found)))
    return replace(found, rest=found.rest or bool(pressed(found.decision.best)))


def _named_with(held: HoldOuts, decision: Decision) -> Proved:
    """What is proved, as far as effects are only added."""
    before = held.replayed(decision.base)
    bare = held.left(decision.base, before)
    present = Proved(held, decision, before, before, bare, True, (), (_step(decision.base, bare),))
    if decision.verdict in ("named", "ambiguous"):
        present = _confirmed(held, present, bare)
    elif decision.verdict == "no_gap" and bare.significant:
        present = replace(present, decision=replace(decision, verdict="unknown"))
    if present.decision.verdict == "no_gap":
        return replace(present, rest=False)
    if present.decision.verdict == "unknown":
        return _found(held, present)
    while remains(present.decision.best, present.left):
        further = _further(held, present)
        if further is None:
            if better(bare.size, present.left.size):
                return present
            return _withdrawn(present, bare, _closed(present, bare))
        present = further
    present = replace(present, rest=False)
    while _hinted(present.decision.best) and (further := _further(held, present)) is not None:
        present = further
    return present


def _from_a_runner_up(held: HoldOuts, decision: Decision) -> Proved | None:
    """What is proved from another pair, where one effect more leaves nothing; None if none does.

    Where a third effect is missing, a wrong second one can explain more than the right one.
    """
    best = decision.best
    if len(best.names) < 2:
        return None
    pairs = [c for c in decision.rivals if len(c.names) == len(best.names)]
    for pair in pairs[: GATES.runners_up]:
        if all(one.reduced > quiet(one) for one in refine(pair, GATES.tried)):
            continue
        others = (best, *(c for c in decision.rivals if c is not pair))
        found = _named_with(held, replace(decision, best=pair, rivals=others, faint=None))
        if found.decision.verdict in ("named", "ambiguous") and not found.rest:
            return found
    return None


def remains(best: Candidate, left: Remainder) -> bool:
    """Whether something significant is left, in the innovations or in the replays."""
    return left.significant or best.reduced > quiet(best)


def _hinted(best: Candidate) -> bool:
    """Whether one further effect promises more than a difference in form would bring."""
    return hints(best)[0].gain > FURTHER * best.count


def _gap(base: Candidate, bare: Remainder) -> bool:
    """Whether a cause is present, even if no known effect explains it."""
    return bare.significant or strange(base)


def _step(candidate: Candidate, left: Remainder) -> SearchStep:
    return SearchStep(candidate.names, candidate.reduced, left.size)


def _confirmed(held: HoldOuts, present: Proved, bare: Remainder) -> Proved:
    """Replay with the effects; back to without them if that is worse, or cannot be done.

    Also where nothing significant was left without them, and they may stand for a difference in
    form: they explain no more than that does, a parameter ends at its bound, or the replays get
    worse by however little.
    """
    base, best = present.decision.base, present.decision.best
    judged = _judged(held, best)
    if judged is None:
        return _withdrawn(present, bare, None)
    after, left = judged
    steps = (*present.steps, _step(best, left))
    tried = replace(present, after=after, left=left, steps=steps)
    if _gap(base, bare):
        holds = not (_grown(bare, left) and _grown(*_at_best(held, tried)))
    else:
        of_form = gain(base, best) < FURTHER or bool(at_bound(best))
        without, with_them = _at_best(held, tried)
        holds = not of_form and with_them.size < GATES.worse * without.size
    return tried if holds else _withdrawn(tried, bare, _closed(tried, bare))


def _grown(before: Remainder, after: Remainder) -> bool:
    return after.size > GATES.worse * before.size + CHANCE


def _at_best(held: HoldOuts, tried: Proved) -> tuple[Remainder, Remainder]:
    """What is left without effects and with them, less what errors of the parameters explain.

    Pads that are 0.1 % off move the replayed speed by as much as its noise.
    """
    bare, best = tried.decision.base, tried.decision.best
    return held.left_at_best(bare, tried.before), held.left_at_best(best, tried.after)


def _withdrawn(present: Proved, bare: Remainder, closed: float | None) -> Proved:
    """Back to the base, where the replays leave ``bare``; the names did not hold."""
    base = present.decision.base
    verdict = "unknown" if _gap(base, bare) else "no_gap"
    return replace(
        present,
        decision=replace(present.decision, verdict=verdict, best=base),
        after=present.before,
        left=bare,
        withdrawn=(Withdrawn(present.decision.best.names, closed),),
        steps=present.steps[:1],
        rest=verdict == "unknown",
    )


def _closed(present: Proved, bare: Remainder) -> float:
    return 1.0 - present.left.size / max(bare.size, 1e-9)


def better(before: float, after: float) -> bool:
    """Whether replays with lasting errors ``after`` are better than those with ``before``."""
    return after < BETTER * before if before > GATES.remainder_least else after < before + CHANCE


def _judged(held: HoldOuts, candidate: Candidate) -> tuple[tuple[Log, ...], Remainder] | None:
    """Replays with a candidate and what is left in them; None if they cannot be computed."""
    try:
        replayed = held.replayed(candidate)
        return replayed, held.left(candidate, replayed)
    except ModelError:
        return None


def _further(held: HoldOuts, present: Proved) -> Proved | None:
    """More effects on top of those that are named, one or a pair; None if none help enough.

    Or the best pair of the search instead of the one that is named: that may stand for both.
    """
    at, faint = present.decision.best, present.decision.faint
    options = _options(at)
    if faint is not None and len(faint.best.names) == len(at.names) + 1:
        options = simplest_first([*options, faint.best])
    return _helping(held, present, options) or _helping(held, present, _pairs_on(at))


def _helping(held: HoldOuts, present: Proved, options: list[Candidate]) -> Proved | None:
    """The first of the options that helps enough, or None."""
    for option in options:
        judged = _judged(held, option)
        if judged is None or not _helpful(held, present, option):
            continue
        if not _closes_most(present, option, judged[1]):
            continue
        rivals = tuple(o for o in options if o is not option)
        return _without_spare(held, present, _added(present, option, rivals, judged))
    return None


def _without_spare(held: HoldOuts, before: Proved, present: Proved) -> Proved:
    """The explanation without effects that stood for the one that was added last.

    Or without that one, if the effects ``before`` it explain as much in another fit: they had come
    to a minimum that is not the lowest.
    """
    at = present.decision.best
    fewer = spared(at)
    judged = None if fewer is at else _judged(held, fewer)
    if judged is None or _grown(present.left, judged[1]):
        return present
    if at.names[-1] in fewer.names:
        return _added(present, fewer, (), judged)
    lower = gain(before.decision.best, fewer) > FURTHER_REPLAYED
    return _added(before, fewer, (), judged) if lower else present


def _exchanged(held: HoldOuts, present: Proved) -> Proved:
    """The explanation without an odd effect, or with one as simple for it, if it fits as well.

    Odd is one that ends at its bound, or acts on both axles in an odd share. Beside a motor, a lag
    and a delay look like an oscillation without overshoot and a delay. An engine at both axles
    looks like rolling resistance.
    """
    at = present.decision.best
    for name in dict.fromkeys((*at_bound(at), *divided(at))):
        fewer = fit_without(at, name)
        spared_price = GATES.parameter * (at.parameters - fewer.parameters - 1) * at.count
        others = refine(fewer, GATES.tried, at.chi2 + spared_price, but=name)
        for option in (fewer, *others):
            if (exchanged := _simpler(held, present, option)) is not None:
                return exchanged
    return present


def _one_for_two(held: HoldOuts, present: Proved) -> Proved:
    """The explanation with one effect in the place of two, if it fits as well.

    A slope that no accelerometer feels looks like a drag and rolling radii together.
    """
    at = present.decision.best
    if len(at.names) <= GATES.several:
        return present
    for one, other in combinations(at.names, 2):
        fewer = fit_without(fit_without(at, one), other)
        if hints(fewer)[0].gain < GATES.nearly_all * (fewer.chi2 - at.chi2):
            continue
        for option in refine(fewer, 1):
            if (exchanged := _simpler(held, present, option)) is not None:
                return exchanged
    return present


def _simpler(held: HoldOuts, present: Proved, option: Candidate) -> Proved | None:
    """What is proved with another explanation; None if it is less simple, or fits less well."""
    at = present.decision.best
    if set(option.names) == set(at.names) or option.parameters > at.parameters:
        return None
    if simplest_first([at, option])[0] is at:
        return None
    option = spared(option)
    judged = _judged(held, option)
    if judged is None or (judged[1].significant and _grown(present.left, judged[1])):
        return None
    if refuted(present.decision.base, option):
        return None
    exchanged = _added(present, option, (at,), judged)
    return replace(exchanged, rest=present.rest and remains(option, judged[1]))


def _unless_held(held: HoldOuts, found: Proved) -> Proved:
    """What is proved; nothing where one front brake torque that is held explains as much.

    Brake control is in no catalogue. Where it acts, several effects together can imitate most of
    it, and leave something.
    """
    best = found.decision.best
    if not found.rest or len(best.names) < GATES.several:
        return found
    one = place_of_rest(found.decision.base, held)
    if one.on_hold_outs or one.driver != SLIP or one.at.reduced > best.reduced:
        return found
    bare = held.left(found.decision.base, found.before)
    return replace(_withdrawn(found, bare, _closed(found, bare)), placed=one)


def _closes_most(present: Proved, option: Candidate, left: Remainder) -> bool:
    """Whether a further effect explains most of what is left, where that is seen.

    That is in the replays or in the innovations; in replays with nothing significant left, only
    beside a gain that no difference in form brings. Where they have something left, a gain in the
    innovations counts only so far as the form of the effects before cannot have left it, or if it
    leaves next to nothing. An effect that turns with the wheels is not seen in replays at all.
    """
    at = present.decision.best
    brought = gain(at, option)
    faint = max(FURTHER_REPLAYED, GATES.further_of_all * gain(present.decision.base, at))
    if left.size < (1.0 - GATES.nearly_all) * present.left.size:
        faint *= 0.5
    if brought > (faint if present.left.significant else FURTHER):
        share = MOST if brought > FURTHER else MOST_REPLAYED
        if left.size < (1.0 - share) * present.left.size:
            return True
    if _grown(present.left, left) or brought < FURTHER:
        return False
    excess = at.reduced - GATES.floor
    if not present.left.significant or (strange(at) and brought > GATES.nearly_all * excess):
        return brought > MOST * excess
    before, with_at, with_option = (
        squares(c.whitened) for c in (present.decision.base, at, option)
    )
    fall = beyond_form(before, with_at, with_option, GATES.second_of_all)
    return fall > MOST * excess * option.count


def _options(at: Candidate) -> list[Candidate]:
    """The best further effects that are worth their parameters."""
    fitted = settled(simplest_first(refine(at, GATES.tried)))
    return [c for c in fitted if gain(at, c) > GATES.faint_second * (c.parameters - at.parameters)]


def _helpful(held: HoldOuts, present: Proved, option: Candidate) -> bool:
    """Whether the hold-outs get better step by step, and no channel speaks against it."""
    at = present.decision.best
    fall = chi2_by_run(held.problem, at) - chi2_by_run(held.problem, option)
    return float(np.sum(fall)) > 0.0 and helps(fall) and not refuted(present.decision.base, option)


def _added(
    present: Proved,
    option: Candidate,
    rivals: tuple[Candidate, ...],
    judged: tuple[tuple[Log, ...], Remainder],
) -> Proved:
    verdict = "ambiguous" if confusable(option, rivals) else "named"
    rivals = (*rivals, *present.decision.rivals)
    decision = replace(present.decision, verdict=verdict, best=option, rivals=rivals)
    steps = (*present.steps, _step(option, judged[1]))
    return replace(present, decision=decision, after=judged[0], left=judged[1], steps=steps)


def _found(held: HoldOuts, present: Proved) -> Proved:
    """Three effects or more, where no single one and no pair explains the logs.

    So many can imitate a cause that is in no catalogue. They are named only if next to nothing is
    left with them, in innovations and replays, and if none of them can be spared.
    """
    start = next((c for c in (present.decision.best, *present.decision.rivals) if c.names), None)
    if start is None:
        return present
    at, rivals = _with_more(start)
    if at is start:
        return present
    at = spared(at)
    judged = _judged(held, at)
    if judged is None or not _helpful(held, present, at):
        return present
    left, gap = judged[1], present.decision.base.reduced - GATES.floor
    if at.reduced > max(quiet(at), GATES.floor + NEARLY_NOTHING * gap):
        return present
    share = NEARLY_NOTHING_REPLAYED if at.reduced <= quiet(at) else NEARLY_NOTHING
    if left.significant and left.size > share * present.left.size:
        return present
    return replace(_added(present, at, tuple(rivals), judged), rest=remains(at, left))


def _with_more(start: Candidate) -> tuple[Candidate, list[Candidate]]:
    """The best explanation with further effects, and its rivals: one by one, else in pairs.

    Pairs are added to what was found, and to each of its effects alone: the other one may stand for
    such a pair.
    """
    at, rivals = start, list[Candidate]()
    while at.reduced > quiet(at):
        options = _options(at)
        if not options or gain(at, options[0]) < GATES.step * (at.reduced - GATES.floor):
            break
        at, rivals = options[0], options[1:]
    if at.reduced <= quiet(at):
        return at, rivals
    parents = [start, *(fit_without(start, name) for name in start.names if len(start.names) > 1)]
    found = [c for parent in parents for c in _pairs_on(parent)]
    ranked = simplest_first([at, *found])
    return ranked[0], rivals if ranked[0] is at else ranked[1:]


def _pairs_on(at: Candidate) -> list[Candidate]:
    """Pairs of further effects that explain most of what is left."""
    return together(at, GATES.tried, MOST_REPLAYED * (at.reduced - GATES.floor))
