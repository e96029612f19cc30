"""Search for the effects that explain the logs, step by step, judged by the hold-outs.

Three moves lead from the best fit so far to a better one, tried in this order: add an effect,
exchange a part for other effects, add an effect or groups in which logs differ. A linear model
ranks the hypotheses of a move, and the best of them are fitted. The first fit that is surely more
probable, on the hold-outs, too, is accepted. Then the moves begin anew, until none is left.

A promise is a hypothesis with its evidence by a linear model. Gains and odds are differences of ln
of the evidence.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

import numpy as np

from calib.base.errors import ModelError
from calib.diagnosis.explanation.channels import ChannelNoise
from calib.diagnosis.explanation.fit import Fit
from calib.diagnosis.explanation.gauss_newton import fit_logs
from calib.diagnosis.explanation.predict import run_of
from calib.diagnosis.explanation.problem import Problem, unbraked_noise, with_ripple_phase
from calib.diagnosis.explanation.unknowns import SCATTERED
from calib.diagnosis.fits import Fits
from calib.diagnosis.rank import Trial, promises, trials
from calib.diagnosis.replays import Gap, HoldOuts, Replayed, gap_of, replayed
from calib.diagnosis.terms import Ranked, ranked_terms
from calib.logs.log import Log

DECISIVE = 10.0  # gain by all logs together from which something is believed or ruled out
_LEAST_SHARE = 0.05  # share of the excess of the squares that an effect must explain
_WIDENING, _WIDENING_NOISE = 0.25, 0.5
"""How far a fit may widen the gap on the way to a better fit: a share of the gap, but at least a
number in units of the noise."""
_TRIED_ANEW = 8  # number of further effects that are tried anew beside a fit
_MAX_MOVES = 12
_QUIETER = 0.9  # share of a channel's noise below which a fit leaves the channel quieter
_LINEAR_ERROR, _LINEAR_OFFSET = 0.5, 5.0
"""Largest error of a promised gain: a share of the gain, which a motor needs, and a number."""
_LEAST_PROMISE = 5.0  # gain that a further effect must promise to be fitted
_BETTER_FIT = 2.0  # gain of another fit of the best hypothesis from which it is better


def run_search(problem: Problem, holdout: Sequence[Log]) -> "Search":
    """Search in a problem, judged by the hold-out logs.

    The search begins anew if its best fit leaves less noise: then an effect that acts in unbraked
    parts, such as a tone ring that runs out, was part of the noise.
    """
    while True:
        runs = with_ripple_phase(problem.vehicle, [run_of(log) for log in holdout], problem.noise)
        search = Search(problem, HoldOuts(tuple(holdout), replace(problem, runs=runs)))
        search.run()
        noise = search.quieter_noise()
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
    base_trials: list[Trial] = field(init=False)  # of effects beside the base
    best_trials: list[Trial] = field(init=False)  # of effects beside the best fit
    rivals: tuple[Fit, ...] = ()  # fits with other effects, which no log rules out
    steps: list[tuple[str, ...]] = field(default_factory=lambda: [()])  # effects of each best fit
    accepted: list[Replayed] = field(default_factory=list)  # replays of each best fit
    withdrawn: dict[object, tuple[str, ...]] = field(default_factory=dict)
    """Effects of the fits that the hold-outs speak against, by the keys of their hypotheses."""

    def run(self) -> None:
        """Find the best fit and its rivals."""
        self.problem.tell("fitting the model without effects", 0, 1)
        self.fits = Fits(self.problem, self.holdouts.problem)
        self.base = self.best = self.fits.base
        self.best_trials = self.base_trials = trials(self.base)
        for _ in range(_MAX_MOVES):
            if not self._move() or self.is_term_likelier() or self.quieter_noise() is not None:
                break
        self.rivals = self._find_rivals()
        likeliest = max((self.best, *self.rivals), key=self._odds)
        if likeliest is not self.best and self.accept(likeliest, least=-DECISIVE):
            self.rivals = self._find_rivals()
        self.best = self._with_alike()
        if not self.best.names:
            self.base = self.best

    def _move(self) -> bool:
        """Make the first move that gives a fit which is accepted; return whether there is one."""
        add_in_groups = partial(self.fit_additions, more_groups=True)
        for fit_move in (self.fit_additions, self.fit_exchanges, add_in_groups):
            for fit in self.more_probable(fit_move()):
                if self.accept(fit):
                    return True
        return False

    def quieter_noise(self) -> ChannelNoise | None:
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

        With the pads and roads of a wrong fit, any effect would shrink the gap.
        """
        return gap_of(self.base_replayed.logs, after.logs, self.holdouts.logs)

    def widens(self, after: Replayed) -> bool:
        """Whether effects widen the gap of the replays by more than is allowed."""
        gap = self.gap(after)
        return gap.rms_after > gap.rms_before + max(_WIDENING * gap.rms_before, _WIDENING_NOISE)

    def accept(self, new: Fit, least: float = DECISIVE) -> bool:
        """Make a fit the best if it gains enough and does not widen the gap; return whether so.

        The gain must be above ``least``, or above 0 for a better fit of the best hypothesis.
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
            self.best_trials = self._trials(new)
        return True

    def _trials(self, fit: Fit) -> list[Trial]:
        """Trials of effects beside a fit: the most promising ones anew, others as at the base."""
        if not fit.names:
            return [*self.base_trials]
        promised = promises(fit, self.base_trials, 1)
        anew = [*dict.fromkeys(p.hypothesis.names[-1] for p in promised)][:_TRIED_ANEW]
        return [*trials(fit, anew), *(t for t in self.base_trials if t.name not in anew)]

    def fit_additions(self, *, more_groups: bool = False) -> list[Fit]:
        """Fit the best hypothesis with a further effect; with ``more_groups`` also further groups.

        Up to three promises in the present groups are fitted, and one in more groups, unless they
        lie behind the best promise by more than the linear model can be wrong.
        """
        best, chosen = self.best, []
        promised = promises(best, self.best_trials, 1, more_groups)
        in_groups = [p for p in promised if p.hypothesis.groups == best.hypothesis.groups]
        in_more_groups = [p for p in promised if p.hypothesis.groups > best.hypothesis.groups]
        for candidates, count in ((in_groups, 3), (in_more_groups, 1)):
            largest = max((p.log_evidence - best.log_evidence for p in candidates), default=0.0)
            near_largest = (1.0 - _LINEAR_ERROR) * largest - _LINEAR_OFFSET
            least = best.log_evidence + max(_LEAST_PROMISE, near_largest)
            chosen += [p for p in candidates if p.log_evidence > least][:count]
        return self.fits.best_of(chosen, best, best.log_evidence - 2.0 * DECISIVE)

    def more_probable(self, fits: Iterable[Fit]) -> Iterator[Fit]:
        """Yield those of the best three fits that are surely more probable, best first.

        Fits that only the hold-outs speak against are withdrawn.
        """
        best = self.best
        excess = best.mean_square - 1.0 - 3.0 * best.scatter
        # a fall of the squares is twice a gain of ln of the likelihood
        least = max(DECISIVE, _LEAST_SHARE * 0.5 * excess * best.count)
        better = {f.hypothesis.key: f for f in fits if f.log_evidence > best.log_evidence}
        for fit in sorted(better.values(), key=lambda f: -f.log_evidence)[:3]:
            key = fit.hypothesis.key
            if key == best.hypothesis.key:
                if fit.log_evidence > best.log_evidence + _BETTER_FIT:
                    yield fit
            elif key not in self.withdrawn:
                gain, holdout_gain = self._gains(fit)
                if holdout_gain > -DECISIVE and gain + holdout_gain > least:
                    yield fit
                elif gain > DECISIVE:
                    self.withdrawn[key] = fit.names

    def _gains(self, new: Fit) -> tuple[float, float]:
        """Gains over the best fit, by the logs of the problem and by the hold-outs."""
        holdout_gain = self.fits.density(new) - self.fits.density(self.best)
        return float(new.log_evidence - self.best.log_evidence), float(holdout_gain)

    def fit_exchanges(self) -> list[Fit]:
        """Leave out each part of the best fit, an effect or a group, and fit others in its place.

        A part may have stood for two effects, so up to two effects take its place; if logs differ
        in groups, an effect and groups. Without the part the linear model may be far wrong, so two
        hypotheses with no more effects than the best fit are fitted whatever they promise. A larger
        one must lack the part and promise more. A best fit without parts is extended.
        """
        best, fits = self.best, []
        count, more_groups = len(best.names), bool(best.hypothesis.groups)
        parts = self.fits.without_each(best, best.names)
        for fit in parts if parts else [best]:
            promised = promises(fit, self._trials(fit), 1 if more_groups else 2, more_groups)
            part = best.hypothesis.parts - fit.hypothesis.parts
            not_larger = [p for p in promised if len(p.hypothesis.names) <= count]
            larger = [p for p in promised if len(p.hypothesis.names) > count]
            without_part = [p for p in larger if not part or not part <= p.hypothesis.parts]
            likelier = [p for p in without_part if p.log_evidence > best.log_evidence + DECISIVE]
            chosen = [*not_larger[:2], *likelier[:1]]
            fits += self.fits.best_of(chosen, fit, best.log_evidence - 2.0 * DECISIVE)
        return fits

    @cached_property
    def terms(self) -> list[Ranked]:
        """Empirical terms beside the base, ranked."""
        return ranked_terms(self.base)

    def is_term_likelier(self) -> bool:
        """Whether a term alone promises more than the best fit and all moves from that fit."""
        best = self.best
        is_excess = best.mean_square > 1.01 + 3.0 * best.scatter or best.random_effects_excess > 5.0
        if not (best.names and is_excess):
            return False
        by_term = self.base.log_evidence + self.terms[0].log_gain - DECISIVE
        if by_term < best.log_evidence:
            return False
        others = [
            *promises(best, self.best_trials),
            *promises(best, self.best_trials, 1, more_groups=True),
            *promises(self.base, self.base_trials),
        ]
        return by_term > max(p.log_evidence for p in others)

    def _odds(self, fit: Fit) -> float:
        """ln of the evidence of all logs, where effects that every car has cost no price."""
        return self.fits.evidence_of_all(fit) + fit.hypothesis.price_of_usual

    def _find_rivals(self) -> tuple[Fit, ...]:
        """Fits with other effects and at most as many parameters, which no log rules out."""
        best, evidence, rivals = self.best, self.fits.evidence_of_all, []
        least = evidence(best) - DECISIVE
        for fit in list(self.fits.fitted.values()):
            is_part = set(fit.names) <= set(best.names)
            is_larger = fit.state.x.size > best.state.x.size
            is_far_behind = fit.log_evidence < best.log_evidence - 2.0 * DECISIVE
            if not (is_part or is_larger or is_far_behind) and evidence(fit) > least:
                rivals.append(fit)
        return tuple(sorted(rivals, key=lambda fit: -evidence(fit)))

    def _with_alike(self) -> Fit:
        """The best fit, with logs alike in some of the `SCATTERED` groups if more probable so."""
        fit = self.best
        subsets = [(), SCATTERED, *((group,) for group in SCATTERED)]
        differ = fit.hypothesis.groups
        options = [replace(fit.hypothesis, alike=frozenset(x) - differ) for x in subsets]
        likeliest = max(options, key=lambda option: fit.marginal(sigmas=option.sigmas).evidence())
        return fit_logs(fit.problem, likeliest, fit.state, fit.columns)
