"""The search: moves that promise more, fits of the best of them, and hold-outs that judge.

one effect more --> others in the place of one --> logs that differ in more kinds

The first move that ends surely more probable, on the hold-outs, too, is made, and all begins anew,
until no move is left.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

import numpy as np

from calib.base.errors import ModelError
from calib.diagnosis.explanation.base import SCATTERED
from calib.diagnosis.explanation.channels import ChannelNoise
from calib.diagnosis.explanation.fit import Fit
from calib.diagnosis.explanation.gauss_newton import fit_logs
from calib.diagnosis.explanation.predict import run_of
from calib.diagnosis.explanation.problem import Problem, turned, unbraked_noise
from calib.diagnosis.fits import Fits
from calib.diagnosis.rank import Trial, promises, trials
from calib.diagnosis.replays import Gap, HoldOuts, Replayed, gap_of, replayed
from calib.diagnosis.terms import Ranked, ranked_terms
from calib.logs.log import Log

SURE = 10.0  # ln of the odds, of all logs together, from which more is believed, or ruled out

_SHARE = 0.05  # share of all that is left which a cause of it takes at least
_WIDER = 0.25  # share by which a fit may widen the gap on the way to a better one
_WITHIN = 0.5  # what it may widen it by at least, in units of the noise
_FRESH = 8  # further effects tried anew beside a fit
_MOST = 12  # moves at most
_QUIETER = 0.9  # share of a channel's noise below which a fit leaves it quieter
_WRONG = 0.5  # share of a gain by which a linear model is wrong at most, of a motor's parameters


def run_search(problem: Problem, holdout: Sequence[Log]) -> "Search":
    """A search in a problem, judged by the logs that are held out.

    It begins anew with the noise that a fit leaves where that is quieter: an effect that
    acts in unbraked parts, such as a tone ring that runs out, was part of the noise.
    """
    while True:
        runs = turned(problem.vehicle, [run_of(log) for log in holdout], problem.noise)
        search = Search(problem, HoldOuts(tuple(holdout), replace(problem, runs=runs)))
        search.run()
        if (noise := search.quieter()) is None:
            return search
        problem = replace(problem, noise=noise)


@dataclass
class Search:
    """The course of a search; ``fits`` all that was fitted; ``first`` and ``further`` effects at
    the base and at the best fit; ``steps`` the names of each fit that was the best one in turn;
    ``withdrawn`` what the hold-outs speak against, by keys.
    """

    problem: Problem
    holdouts: HoldOuts
    base: Fit = field(init=False)
    best: Fit = field(init=False)
    fits: Fits = field(init=False)
    first: list[Trial] = field(init=False)
    further: list[Trial] = field(init=False)
    rivals: tuple[Fit, ...] = ()
    steps: list[tuple[str, ...]] = field(default_factory=lambda: [()])
    accepted: list[Replayed] = field(default_factory=list)
    withdrawn: dict[object, tuple[str, ...]] = field(default_factory=dict)

    def run(self) -> None:
        """Find the best fit."""
        self.problem.tell("fitting the model without effects", 0, 1)
        self.fits = Fits(self.problem, self.holdouts.problem)
        self.base = self.best = self.fits.base
        self.further = self.first = trials(self.base)
        moves = (self.beside, self.exchanged, partial(self.beside, other=True))
        for _ in range(_MOST):
            better = (e for move in moves for e in self.more_probable(move()))
            if not any(map(self.accept, better)) or self.no_effect() or self.quieter():
                break
        self.rivals = self._rivals()
        likeliest = max((self.best, *self.rivals), key=self._odds)
        if likeliest is not self.best and self.accept(likeliest, least=-SURE):
            self.rivals = self._rivals()
        fit = self._with_alike()
        self.base, self.best = self.base if fit.names else fit, fit

    def quieter(self) -> ChannelNoise | None:
        """The noise that effects leave in the unbraked parts, if a channel has less with them."""
        fit, problem = self.best, self.problem
        if not fit.names:
            return None
        noise = unbraked_noise(problem.vehicle, fit.base, fit.effects, problem.runs)
        return noise if np.any(noise.sigma <= _QUIETER * problem.noise.sigma) else None

    def replayed(self, fit: Fit) -> Replayed:
        """Replay the hold-outs with a fit. Raises ModelError."""
        is_base = not fit.names and fit.hypothesis.walk is None
        return replayed(self.holdouts, fit, None if is_base else self.base_replayed.simulated)

    @cached_property
    def base_replayed(self) -> Replayed:
        """The hold-outs without effects, on the pads and roads that fit those best."""
        return self.replayed(self.base)

    def gap(self, after: Replayed) -> Gap:
        """The gap on the hold-outs without effects and with them, each on its own pads and roads.

        What is wrong may have far pads, with which anything would shrink the gap.
        """
        return gap_of(self.base_replayed.logs, after.logs, self.holdouts.logs)

    def widens(self, after: Replayed) -> bool:
        """Whether effects widen the gap of the replays, beyond what noise does."""
        gap = self.gap(after)
        return gap.rms_after > gap.rms_before + max(_WIDER * gap.rms_before, _WITHIN)

    def accept(self, new: Fit, least: float = SURE) -> bool:
        """Go on from what is better by ``least``, and widens no gap far."""
        more, holdout_gain = self._gained(new)
        same = new.hypothesis.key == self.best.hypothesis.key
        if more + holdout_gain <= (0.0 if same else least):
            return False
        try:
            after = self.replayed(new)
        except ModelError:
            after = None
        if after is None or self.widens(after):
            self.withdrawn[new.hypothesis.key] = new.names
            return False
        self.best = new
        self.accepted.append(after)
        if not same:
            self.steps.append(new.names)
            self.further = self._trials(new)
        return True

    def _trials(self, fit: Fit) -> list[Trial]:
        """Further effects beside a fit: what promises most is tried anew, others as at the base."""
        mostly = (p.hypothesis.names[-1] for p in promises(fit, self.first, 1))
        tops = [*dict.fromkeys(mostly)][: _FRESH if fit.names else 0]
        return [*trials(fit, tops), *(one for one in self.first if one.name not in tops)]

    def beside(self, *, other: bool = False) -> list[Fit]:
        """One effect more; with ``other`` logs may differ in further kinds besides.

        What is near the best promise, for all that a linear model can be wrong.
        """
        best, tops = self.best, []
        promised = promises(best, self.further, 1, other)
        for kinds in (False, True):
            those = [p for p in promised if (p.hypothesis.kinds > best.hypothesis.kinds) == kinds]
            most = max((p.log_evidence - best.log_evidence for p in those), default=0.0)
            least = best.log_evidence + max(5.0, (1.0 - _WRONG) * most - 5.0)
            tops += [p for p in those if p.log_evidence > least][: 1 if kinds else 3]
        return self.fits.best_of(tops, best, best.log_evidence - 2.0 * SURE)

    def more_probable(self, news: Iterable[Fit]) -> Iterator[Fit]:
        """Those that are surely more probable than the best, by evidence."""
        best = self.best
        # what takes a twentieth of all that is left or less is no cause of it
        excess = best.reduced - 1.0 - 3.0 * best.scatter
        worth = max(SURE, _SHARE * 0.5 * excess * best.count)
        more = {e.hypothesis.key: e for e in news if e.log_evidence > best.log_evidence}
        for key, e in sorted(more.items(), key=lambda one: -one[1].log_evidence)[:3]:
            if key == best.hypothesis.key:
                if e.log_evidence > best.log_evidence + 2.0:
                    yield e
            elif key not in self.withdrawn:
                gain, holdout_gain = self._gained(e)
                if holdout_gain > -SURE and gain + holdout_gain > worth:
                    yield e
                elif gain > SURE:
                    self.withdrawn[key] = e.names

    def _gained(self, new: Fit) -> tuple[float, float]:
        """ln of the odds against the best by the logs that are searched, and by those held out."""
        holdout_gain = self.fits.density(new) - self.fits.density(self.best)
        return float(new.log_evidence - self.best.log_evidence), float(holdout_gain)

    def exchanged(self) -> list[Fit]:
        """One or two effects, or other kinds, in the place of a part of the best fit.

        Or two where it has none. A part may have stood for two. Without it a linear model may be
        far wrong, so the best two are tried whatever they promise; two effects must promise more.
        """
        best, news = self.best, []
        parts, other = len(best.names), bool(best.hypothesis.kinds)
        for e in self.fits.fewer(best, best.names) or [best]:
            promised = promises(e, self._trials(e), 1 if other else 2, other)
            single = [p for p in promised if len(p.hypothesis.names) <= parts]
            wider = (p for p in promised if len(p.hypothesis.names) > parts)
            out = best.hypothesis.parts - e.hypothesis.parts
            others = (p for p in wider if not out or not out <= p.hypothesis.parts)
            two = [p for p in others if p.log_evidence > best.log_evidence + SURE]
            news += self.fits.best_of([*single[:2], *two[:1]], e, best.log_evidence - 2.0 * SURE)
        return news

    @cached_property
    def terms(self) -> list[Ranked]:
        """Empirical terms in the place of any effect."""
        return ranked_terms(self.base)

    def no_effect(self) -> bool:
        """Whether a term alone promises more than the best fit, and what may follow it.

        With any further effects, and logs that differ in any kinds.
        """
        best = self.best
        is_excess = best.reduced > 1.01 + 3.0 * best.scatter or best.random_effects_excess > 5.0
        if not (best.names and is_excess):
            return False
        by_term = self.base.log_evidence + self.terms[0].log_gain - SURE
        if by_term < best.log_evidence:
            return False
        others = [
            *promises(best, self.further),
            *promises(best, self.further, 1, other=True),
            *promises(self.base, self.first),
        ]
        return by_term > max(p.log_evidence for p in others)

    def _odds(self, fit: Fit) -> float:
        """ln of the odds between rivals: what every car has comes before what only some have."""
        return self.fits.value(fit) + fit.hypothesis.expected

    def _rivals(self) -> tuple[Fit, ...]:
        """Fits of no more parameters that no log, searched or held out, rules out."""
        best, value, out = self.best, self.fits.value, []
        most, least = value(best), best.log_evidence - 2.0 * SURE
        for e in list(self.fits.fitted.values()):
            more = e.state.x.size > best.state.x.size
            if set(e.names) <= set(best.names) or more or e.log_evidence < least:
                continue
            if value(e) > most - SURE:
                out.append(e)
        return tuple(sorted(out, key=lambda e: -value(e)))

    def _with_alike(self) -> Fit:
        """The best one with logs alike in what they usually differ in, where that is likelier."""
        fit = self.best
        some = (frozenset(one) for one in ((), SCATTERED, *((kind,) for kind in SCATTERED)))
        options = [replace(fit.hypothesis, alike=alike - fit.hypothesis.kinds) for alike in some]
        likeliest = max(options, key=lambda one: fit.marginal(sizes=one.sizes).evidence())
        return fit_logs(fit.problem, likeliest, fit.state, fit.columns)
