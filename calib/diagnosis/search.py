"""Search for the effects that explain the logs, step by step, judged by the hold-outs.

    one effect more --> other effects in the place of one --> logs that differ in more groups

These are the moves. The linear model ranks what each move may give, and the best are fitted. The
first fit that is surely more probable, on the hold-outs, too, is accepted, and the moves begin
anew, until none is left. A promise is a hypothesis with an evidence by the linear model, a gain a
difference of ln of the evidence.
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
from calib.diagnosis.explanation.problem import Problem, unbraked_noise, with_ripple_phase
from calib.diagnosis.fits import Fits
from calib.diagnosis.rank import Trial, promises, trials
from calib.diagnosis.replays import Gap, HoldOuts, Replayed, gap_of, replayed
from calib.diagnosis.terms import Ranked, ranked_terms
from calib.logs.log import Log

SURE = 10.0  # ln of the odds, of all logs together, from which something is believed or ruled out
_SHARE = 0.05  # share of the excess of the squares that an effect must explain
_WIDER = 0.25  # share by which a fit may widen the gap on the way to a better one
_WITHIN = 0.5  # widening of the gap that is allowed at least, in units of the noise
_FRESH = 8  # further effects that are tried anew beside a fit
_MOST = 12  # moves at most
_QUIETER = 0.9  # share of a channel's noise below which a fit leaves it quieter
_WRONG = 0.5  # share of a gain by which the linear model is wrong at most: it is so for a motor


def run_search(problem: Problem, holdout: Sequence[Log]) -> "Search":
    """Search in a problem, judged by the logs that are held out.

    The search begins anew if its best fit leaves less noise: an effect that acts in unbraked parts,
    such as a tone ring that runs out, was part of the noise.
    """
    while True:
        runs = with_ripple_phase(problem.vehicle, [run_of(log) for log in holdout], problem.noise)
        search = Search(problem, HoldOuts(tuple(holdout), replace(problem, runs=runs)))
        search.run()
        noise = search.quieter()
        if noise is None:
            return search
        problem = replace(problem, noise=noise)


@dataclass
class Search:
    """The course of a search from the fit without effects to the best fit."""

    problem: Problem
    holdouts: HoldOuts
    base: Fit = field(init=False)  # without effects
    best: Fit = field(init=False)
    fits: Fits = field(init=False)
    first: list[Trial] = field(init=False)  # of effects beside the base
    further: list[Trial] = field(init=False)  # of effects beside the best fit
    rivals: tuple[Fit, ...] = ()  # that no log rules out
    steps: list[tuple[str, ...]] = field(default_factory=lambda: [()])  # effects of each best fit
    accepted: list[Replayed] = field(default_factory=list)  # replays of each best fit
    # effects of fits that the hold-outs speak against, by key
    withdrawn: dict[object, tuple[str, ...]] = field(default_factory=dict)

    def run(self) -> None:
        """Find the best fit and its rivals."""
        self.problem.tell("fitting the model without effects", 0, 1)
        self.fits = Fits(self.problem, self.holdouts.problem)
        self.base = self.best = self.fits.base
        self.further = self.first = trials(self.base)
        for _ in range(_MOST):
            if not self._moves_on() or self.is_no_effect() or self.quieter():
                break
        self.rivals = self._rivals()
        likeliest = max((self.best, *self.rivals), key=self._odds)
        if likeliest is not self.best and self.accept(likeliest, least=-SURE):
            self.rivals = self._rivals()
        self.best = self._with_alike()
        if not self.best.names:
            self.base = self.best

    def _moves_on(self) -> bool:
        """Make the first move that gives a fit which is accepted; return whether there is one."""
        for move in (self.one_more, self.exchanges, partial(self.one_more, more_groups=True)):
            for fit in self.more_probable(move()):
                if self.accept(fit):
                    return True
        return False

    def quieter(self) -> ChannelNoise | None:
        """The noise that the best fit leaves in unbraked parts if a channel is quieter, or None."""
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
        """The hold-outs without effects, on the pads and roads that then fit best."""
        return self.replayed(self.base)

    def gap(self, after: Replayed) -> Gap:
        """The gap on the hold-outs without and with effects, each with the best pads and roads.

        With those of a wrong fit, which may be far off, any effect would shrink the gap.
        """
        return gap_of(self.base_replayed.logs, after.logs, self.holdouts.logs)

    def widens(self, after: Replayed) -> bool:
        """Whether effects widen the gap of the replays by more than noise does."""
        gap = self.gap(after)
        return gap.rms_after > gap.rms_before + max(_WIDER * gap.rms_before, _WITHIN)

    def accept(self, new: Fit, least: float = SURE) -> bool:
        """Make a fit the best if it gains enough and does not widen the gap far; return whether so.

        Enough is more than ``least``, or more than 0 for a better fit of the best hypothesis.
        """
        same = new.hypothesis.key == self.best.hypothesis.key
        if sum(self._gains(new)) <= (0.0 if same else least):
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
        """Trials of effects beside a fit: the most promising ones anew, others as at the base."""
        if not fit.names:
            return [*self.first]
        by_promise = dict.fromkeys(p.hypothesis.names[-1] for p in promises(fit, self.first, 1))
        anew = [*by_promise][:_FRESH]
        return [*trials(fit, anew), *(trial for trial in self.first if trial.name not in anew)]

    def one_more(self, *, more_groups: bool = False) -> list[Fit]:
        """Fit one effect more; with ``more_groups`` logs may differ in further groups, too.

        Up to three promises in the present groups are fitted, and one in more groups: those behind
        the best promise by no more than a linear model can be wrong.
        """
        best, tops = self.best, []
        promised = promises(best, self.further, 1, more_groups)
        for wider, count in ((False, 3), (True, 1)):
            some = [p for p in promised if (p.hypothesis.groups > best.hypothesis.groups) == wider]
            most = max((p.log_evidence - best.log_evidence for p in some), default=0.0)
            least = best.log_evidence + max(5.0, (1.0 - _WRONG) * most - 5.0)
            tops += [p for p in some if p.log_evidence > least][:count]
        return self.fits.best_of(tops, best, best.log_evidence - 2.0 * SURE)

    def more_probable(self, fits: Iterable[Fit]) -> Iterator[Fit]:
        """Yield fits that are surely more probable than the best one, best first."""
        best = self.best
        excess = best.mean_square - 1.0 - 3.0 * best.scatter
        least = max(SURE, _SHARE * 0.5 * excess * best.count)
        better = {f.hypothesis.key: f for f in fits if f.log_evidence > best.log_evidence}
        for fit in sorted(better.values(), key=lambda f: -f.log_evidence)[:3]:
            key = fit.hypothesis.key
            if key == best.hypothesis.key:
                if fit.log_evidence > best.log_evidence + 2.0:
                    yield fit
            elif key not in self.withdrawn:
                gain, holdout_gain = self._gains(fit)
                if holdout_gain > -SURE and gain + holdout_gain > least:
                    yield fit
                elif gain > SURE:
                    self.withdrawn[key] = fit.names

    def _gains(self, new: Fit) -> tuple[float, float]:
        """ln of the odds against the best fit, by the logs of the problem and by the hold-outs."""
        holdout_gain = self.fits.density(new) - self.fits.density(self.best)
        return float(new.log_evidence - self.best.log_evidence), float(holdout_gain)

    def exchanges(self) -> list[Fit]:
        """Fit one or two effects, or further groups, in the place of a part of the best fit.

        A best fit without effects gets one or two. The part may have stood for two effects. Without
        the part the linear model may be far wrong, so the best two single effects are fitted
        whatever they promise. A pair must promise more than the best fit, and not have the part.
        """
        best, fits = self.best, []
        count, more_groups = len(best.names), bool(best.hypothesis.groups)
        for fit in self.fits.fewer(best, best.names) or [best]:
            promised = promises(fit, self._trials(fit), 1 if more_groups else 2, more_groups)
            part = best.hypothesis.parts - fit.hypothesis.parts
            single = [p for p in promised if len(p.hypothesis.names) <= count]
            pairs = [
                p
                for p in promised
                if len(p.hypothesis.names) > count
                and not (part and part <= p.hypothesis.parts)
                and p.log_evidence > best.log_evidence + SURE
            ]
            tops = [*single[:2], *pairs[:1]]
            fits += self.fits.best_of(tops, fit, best.log_evidence - 2.0 * SURE)
        return fits

    @cached_property
    def terms(self) -> list[Ranked]:
        """Empirical terms in the place of any effect, ranked."""
        return ranked_terms(self.base)

    def is_no_effect(self) -> bool:
        """Whether a term alone promises more than the best fit and all moves from that fit."""
        best = self.best
        is_excess = best.mean_square > 1.01 + 3.0 * best.scatter or best.random_effects_excess > 5.0
        if not (best.names and is_excess):
            return False
        by_term = self.base.log_evidence + self.terms[0].log_gain - SURE
        if by_term < best.log_evidence:
            return False
        others = [
            *promises(best, self.further),
            *promises(best, self.further, 1, more_groups=True),
            *promises(self.base, self.first),
        ]
        return by_term > max(p.log_evidence for p in others)

    def _odds(self, fit: Fit) -> float:
        """ln of the odds between rivals, where effects that every car has cost no price."""
        return self.fits.value(fit) + fit.hypothesis.price_of_usual

    def _rivals(self) -> tuple[Fit, ...]:
        """Fits with other effects and at most as many parameters, which no log rules out."""
        best, value, rivals = self.best, self.fits.value, []
        most, least = value(best), best.log_evidence - 2.0 * SURE
        for fit in list(self.fits.fitted.values()):
            is_part = set(fit.names) <= set(best.names)
            is_larger = fit.state.x.size > best.state.x.size
            if is_part or is_larger or fit.log_evidence < least:
                continue
            if value(fit) > most - SURE:
                rivals.append(fit)
        return tuple(sorted(rivals, key=lambda fit: -value(fit)))

    def _with_alike(self) -> Fit:
        """The best fit, with logs alike in `SCATTERED` groups if that is more probable."""
        fit = self.best
        subsets = [(), SCATTERED, *((group,) for group in SCATTERED)]
        differ = fit.hypothesis.groups
        options = [replace(fit.hypothesis, alike=frozenset(x) - differ) for x in subsets]
        likeliest = max(options, key=lambda option: fit.marginal(sigmas=option.sigmas).evidence())
        return fit_logs(fit.problem, likeliest, fit.state, fit.columns)
