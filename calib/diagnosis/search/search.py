"""The search: moves that promise more, fits of the best of them, and hold-outs that judge.

one effect more -> one in the place of another -> several at once -> logs that differ in more kinds

The first move that ends surely more probable, on the hold-outs, too, is made, and all begins anew,
until no move is left.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

from calib.base.errors import ModelError
from calib.diagnosis.explanation.explanation import Explanation
from calib.diagnosis.explanation.fit import ALMOST, ROUGHLY, fit
from calib.diagnosis.explanation.hypothesis import Hypothesis, start_of
from calib.diagnosis.explanation.own import SCATTERED
from calib.diagnosis.explanation.predict import run_of
from calib.diagnosis.explanation.problem import Problem, turned
from calib.diagnosis.replays.gap import Gap, gap_of
from calib.diagnosis.replays.hold_outs import HoldOuts, Replayed, replayed
from calib.diagnosis.search.fits import Fits
from calib.diagnosis.search.rank import Further, Promise, further_columns, promises
from calib.diagnosis.search.terms import Ranked, ranked_terms
from calib.logs.log import Log

SURE = 10.0
"""ln of the odds, of calibration logs and hold-outs together, from which more is believed, and
something else is ruled out."""

_SHARE = 0.05
"""Share of all that is left which a cause of it takes at least."""

_WIDER, _WITHIN = 0.25, 0.5
"""Share by which an explanation may widen the gap of the replays on the way to a better one, and
what it may at least, in units of the noise."""

_FRESH = 8
"""Further effects that are tried anew beside every explanation; others are as without effects."""

_MOST = 12
"""Moves at most."""

_NEAR, _WRONG = 0.1, 0.5
"""Share of what a hypothesis gains by which a linear model is wrong about it: usually, and at most,
of an effect with many parameters such as a motor."""


@dataclass(frozen=True)
class SearchStep:
    """One step: the effects present, the mean squared innovation [1], ln of the odds it gained.

    ``calibration`` by the logs that are searched, ``holdout`` by those held out. And what it
    ``added`` and ``removed``, and by how much that innovation fell.
    """

    names: tuple[str, ...]
    innovation: float
    calibration: float
    holdout: float
    added: tuple[str, ...] = ()
    removed: tuple[str, ...] = ()
    innovation_gain: float = 0.0


def searched(problem: Problem, holdout: Sequence[Log]) -> "Search":
    """A search in a problem, judged by the logs that are held out."""
    runs = turned(problem.vehicle, [run_of(log) for log in holdout], problem.noise)
    search = Search(problem, HoldOuts(tuple(holdout), replace(problem, runs=runs)))
    search.run()
    return search


@dataclass
class Search:
    """The course of a search; ``fits`` all that was fitted; ``first`` and ``further`` effects at
    the base and at the best explanation; ``withdrawn`` what the hold-outs speak against, by keys.
    """

    problem: Problem
    held: HoldOuts
    base: Explanation = field(init=False)
    best: Explanation = field(init=False)
    fits: Fits = field(init=False)
    first: Further = field(init=False)
    further: Further = field(init=False)
    rivals: tuple[Explanation, ...] = ()
    steps: list[SearchStep] = field(default_factory=list)
    accepted: list[Replayed] = field(default_factory=list)
    withdrawn: dict[object, tuple[str, ...]] = field(default_factory=dict)

    def run(self) -> None:
        """Find the best explanation."""
        self.problem.tell("fitting the model without effects", 0, 1)
        self.base = self.best = fit(self.problem, Hypothesis(), start_of(self.problem))
        self.fits = Fits(self.problem, self.held.problem, self.base)
        self.steps.append(SearchStep((), self.base.reduced, 0.0, 0.0))
        self.further = self.first = further_columns(self.base)
        moves = (self.beside, self.exchanged, self.together, self.in_more_kinds)
        for _ in range(_MOST):
            if not any(self.accepts(move()) for move in moves) or self.no_effect():
                break
        self.rivals = self._rivals()
        if self.rivals and self.fits.value(self.rivals[0]) > self.fits.value(self.best):
            self.accept(self.rivals[0])
            self.rivals = self._rivals()
        found = _with_alike(self.best)
        self.base, self.best = self.base if found.names else found, found

    @cached_property
    def before(self) -> Replayed:
        """The hold-outs without effects."""
        return replayed(self.held, self.base, ROUGHLY)

    def gap(self, after: Replayed) -> Gap:
        """The gap on the hold-outs without effects and with them."""
        return gap_of(self.before.logs, after.logs, self.held.logs)

    def widens(self, after: Replayed) -> bool:
        """Whether effects widen the gap of the replays, beyond what noise does."""
        gap = self.gap(after)
        return gap.after > gap.before + max(_WIDER * gap.before, _WITHIN)

    def accept(self, new: Explanation) -> bool:
        """Go on from a better explanation, unless it widens the gap of the replays far."""
        new = fit(self.problem, new.hypothesis, new.state, new.columns)
        self.fits.add(new)
        more = float(new.log_evidence - self.best.log_evidence)
        held = float(self.fits.density(new) - self.fits.density(self.best))
        if more + held <= 0.0:
            return False
        try:
            after = replayed(self.held, new, ROUGHLY)
        except ModelError:
            after = None
        if after is None or self.widens(after):
            self.withdrawn[new.hypothesis.key] = new.names
            return False
        same, self.best = new.hypothesis == self.best.hypothesis, new
        self.accepted.append(after)
        if not same:
            last = self.steps[-1]
            added = tuple(name for name in new.names if name not in last.names)
            removed = tuple(name for name in last.names if name not in new.names)
            gain = last.innovation - new.reduced
            self.steps.append(SearchStep(new.names, new.reduced, more, held, added, removed, gain))
            self.further = self._renewed()
        return True

    def _renewed(self) -> Further:
        """Further columns beside the best: fresh ones of what promises most, else the first."""
        mostly = promises(self.best, self.first, 1)
        tops = [*dict.fromkeys(p.hypothesis.names[-1] for p in mostly)][:_FRESH]
        fresh = further_columns(self.best, tops)
        return fresh.joined(self.first.without((*self.best.names, *tops)))

    def accepts(self, news: Iterable[Explanation]) -> bool:
        """Whether it went on from the first of these that is surely more probable."""
        return any(map(self.accept, self.more_probable(news)))

    def beside(self, *, other: bool = False) -> list[Explanation]:
        """One effect more; with ``other`` logs may differ in further kinds besides."""
        tops = _best(promises(self.best, self.further, 1, other), self.best)
        return self.fits.fitted_best(tops, self.best)

    def in_more_kinds(self) -> list[Explanation]:
        """The same where logs may differ in further kinds, if something is left."""
        return self.beside(other=True) if left_over(self.best) else []

    def together(self) -> list[Explanation]:
        """Several effects at once, and logs that differ in any kinds, from the very start.

        Where what is found one after the other leaves something: the first may have stood for
        others. Those alone that promise what the best has, as far as a linear model can tell.
        """
        if not left_over(self.best):
            return []
        found = [*promises(self.base, self.first), *promises(self.base, self.first, 1, True)]
        best: dict[tuple[int, bool], Promise] = {}
        for p in found:
            size = len(p.hypothesis.names), bool(p.hypothesis.kinds)
            if size > (1, False) and p.log_evidence > self.nearly:
                best.setdefault(size, p)
        return self.fits.fitted_best(list(best.values()), self.base)

    def more_probable(self, news: Iterable[Explanation]) -> Iterator[Explanation]:
        """Those that are surely more probable than the best, by evidence."""
        best = self.best
        ranked = sorted({e.hypothesis.key: e for e in news}.values(), key=lambda e: -e.log_evidence)
        for e in ranked[:3]:
            more = e.log_evidence - best.log_evidence
            if more <= 0.0:
                break
            if e.hypothesis.key == best.hypothesis.key:
                if more > 2.0:
                    yield e
                continue
            if e.hypothesis.key in self.withdrawn:
                continue
            held = self.fits.density(e) - self.fits.density(best)
            if held > -SURE and more + held > self.worth:
                yield e
            elif more > SURE:
                self.withdrawn[e.hypothesis.key] = e.names

    @property
    def worth(self) -> float:
        """ln of the odds that a better explanation must gain, of all logs together.

        What takes a twentieth of all that is left or less is no cause of it.
        """
        left = self.best.reduced - 1.0 - 3.0 * self.best.scatter
        return max(SURE, _SHARE * 0.5 * left * self.best.count)

    def exchanged(self) -> list[Explanation]:
        """One or two effects, or other kinds, in the place of a part of the best explanation.

        A part may have stood for two. Where one is taken out a linear model may be far wrong, so
        its two best promises are tried whatever they promise; two effects must promise more.
        """
        best, news = self.best, []
        parts, other = len(best.names), bool(best.hypothesis.kinds)
        fewer = [
            *(self.fits.without(best, name) for name in best.names),
            *(self.fits.without_kind(best, kind) for kind in best.hypothesis.kinds),
        ]
        for e in fewer:
            further = further_columns(e) if e.names else self.first
            found = promises(e, further, 1 if other else 2, other)
            one = [p for p in found if len(p.hypothesis.names) <= parts]
            two = [
                p
                for p in found
                if len(p.hypothesis.names) > parts
                and p.log_evidence > best.log_evidence + SURE
                and not set(best.names) < set(p.hypothesis.names)
            ]
            news += self.fits.fitted_best([*one[:2], *two[:1]], e)
        return news

    @cached_property
    def terms(self) -> list[Ranked]:
        """Empirical terms in the place of any effect."""
        return ranked_terms(self.base)

    def no_effect(self) -> bool:
        """Whether a term alone promises more than the best explanation, and what may follow it.

        With any further effects, and logs that differ in any kinds.
        """
        if not (self.best.names and left_over(self.best)):
            return False
        promised = self.base.log_evidence + self.terms[0].log_gain
        if promised < self.best.log_evidence + SURE:
            return False
        found = [
            *promises(self.best, self.further),
            *promises(self.base, self.first),
            *promises(self.best, self.further, 1, True),
        ]
        most = max(p.log_evidence for p in found)
        return promised > most + SURE

    @property
    def nearly(self) -> float:
        """ln of the evidence from which a promise may be as good as the best explanation."""
        gained = self.best.log_evidence - self.base.log_evidence
        return self.best.log_evidence - _NEAR * gained

    def _rivals(self) -> tuple[Explanation, ...]:
        """Explanations of no more parameters that no log, searched or held out, rules out."""
        best, out = self.best, []
        most = self.fits.value(best)
        for e in list(self.fits.fitted.values()):
            simple = len(e.names) <= len(best.names) and e.state.x.size <= best.state.x.size
            if set(e.names) <= set(best.names) or not simple:
                continue
            if e.log_evidence < best.log_evidence - 2.0 * SURE:
                continue
            if self.fits.value(e) < most - 2.0 * SURE:
                continue
            one = fit(self.problem, e.hypothesis, e.state, e.columns, ALMOST)
            self.fits.add(one)
            if self.fits.value(one) > most - SURE:
                out.append(one)
        return tuple(sorted(out, key=lambda e: -self.fits.value(e)))


def _best(found: list[Promise], at: Explanation) -> list[Promise]:
    """What may be better than ``at``, and the best of its kind: for all that a linear model can be
    wrong, at most three without and one with logs that differ in more kinds.
    """
    out = []
    for kinds in (False, True):
        those = [p for p in found if (p.hypothesis.kinds > at.hypothesis.kinds) == kinds]
        if not those:
            continue
        best = max(p.log_evidence for p in those)
        least = max(at.log_evidence + 5.0, best - 5.0 - _WRONG * (best - at.log_evidence))
        out += [p for p in those if p.log_evidence > least][: 1 if kinds else 3]
    return out


def _with_alike(at: Explanation) -> Explanation:
    """The explanation with logs that are alike in what they usually differ in, where that is more
    probable.
    """
    some = (frozenset(one) for one in ((), SCATTERED, *((kind,) for kind in SCATTERED)))
    options = [replace(at.hypothesis, alike=alike - at.hypothesis.kinds) for alike in some]
    best = max(options, key=lambda one: at.marginal(sizes=one.sizes).evidence())
    return fit(at.problem, best, at.state, at.columns, ALMOST)


def left_over(at: Explanation) -> bool:
    """Whether more than noise is left in the innovations, or in what logs have of their own."""
    return at.reduced > 1.01 + 3.0 * at.scatter or at.strain > 5.0
