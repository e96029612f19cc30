"""All fits of a search by their hypotheses, and the density of the hold-outs given each of them.

Gains are differences of ln of the evidence, prices included. A promise is a hypothesis with its
evidence by a linear model, before it is fitted (`calib.diagnosis.rank`).
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from calib.base.arrays import Array
from calib.diagnosis.explanation.fit import Fit, linearised
from calib.diagnosis.explanation.gauss_newton import ROUGH, fit_logs
from calib.diagnosis.explanation.hypothesis import FADE, Hypothesis, State, start_of
from calib.diagnosis.explanation.problem import Problem
from calib.diagnosis.explanation.unknowns import BASE_SIZE
from calib.diagnosis.rank import Promise
from calib.diagnosis.replays import holdout_effects

_PRUNING_GAIN = 20.0  # largest gain by leaving out what is not worth its price
_SHORTFALL = 3.0  # how far a fit may fall behind its promise before it is fitted again
_DOUBTFUL, _DOUBTFUL_SHARE = 100.0, 0.01
"""Worth of an effect below which a fit without it is tried: a number, plus a share of the gain over
the base, since the linear model may be wrong by that share."""


@dataclass
class Fits:
    """All fits of a problem by the keys of their hypotheses."""

    problem: Problem
    holdouts: Problem
    base: Fit = field(init=False)  # without effects
    fitted: dict[object, Fit] = field(default_factory=dict)
    densities: dict[object, float] = field(default_factory=dict)  # as `density` returns them
    attempts: set[object] = field(default_factory=set)  # keys of a part, and of the fit it is from

    def __post_init__(self) -> None:
        self.base = fit_logs(self.problem, Hypothesis(), start_of(self.problem))
        self.add(self.base)

    def is_known(self, hypothesis: Hypothesis, promised: float) -> bool:
        """Whether a fit is stored whose ln of the evidence is not far below ``promised``."""
        fit = self.fitted.get(hypothesis.key)
        return fit is not None and fit.log_evidence > promised - _SHORTFALL

    def add(self, fit: Fit) -> None:
        """Store a fit, unless an earlier fit of the same hypothesis is more probable."""
        key = fit.hypothesis.key
        if fit.log_evidence >= self.fitted.get(key, fit).log_evidence:
            self.fitted[key] = fit
            self.densities.pop(key, None)

    def best_of(self, chosen: Sequence[Promise], near: Fit, least: float = -np.inf) -> list[Fit]:
        """Fit the ``chosen`` promises, from the columns of ``near``; best first.

        Fits that may be the best are pruned. For ``least`` see `fit_logs`.
        """
        unknown = [p for p in chosen if not self.is_known(p.hypothesis, p.log_evidence)]
        if unknown:
            names = ", ".join(" + ".join(p.hypothesis.names) for p in unknown).replace("_", " ")
            self.problem.tell(f"fitting {names}", 0, 1)
        job = partial(_fitted, self.problem.for_worker, near.columns, near.has_unusual_base, least)
        for fit in self.problem.mapped(job, unknown):
            self.add(replace(fit, problem=self.problem))
        fits = [self.fitted[p.hypothesis.key] for p in chosen]
        fits.sort(key=lambda fit: -fit.log_evidence)
        to_prune = max((fit.log_evidence for fit in fits), default=0.0) - _PRUNING_GAIN
        return [self.pruned(fit) if fit.log_evidence > to_prune else fit for fit in fits]

    def pruned(self, fit: Fit) -> Fit:
        """Leave out groups and effects not worth their price, as long as that is better."""
        while True:
            doubtful_worth = _DOUBTFUL
            doubtful_worth += _DOUBTFUL_SHARE * (fit.log_evidence - self.base.log_evidence)
            doubtful = [name for name in fit.names if fit.worth_of(name) < doubtful_worth]
            parts = self.without_each(fit, doubtful)
            better = max(parts, key=lambda part: part.log_evidence, default=fit)
            if better.log_evidence <= fit.log_evidence:
                return fit
            fit = better

    def without_each(self, fit: Fit, names: Iterable[str]) -> list[Fit]:
        """Fit without each effect of ``names`` in turn, then without each group of ``fit``."""
        parts, groups, runs = [], fit.hypothesis.groups, len(self.problem.runs)
        for name in names:
            others = tuple(n for n in fit.names if n != name)
            # heats of discs act through the fade alone
            part = Hypothesis(others, groups - {"heat"} if name == FADE else groups)
            price_saved = fit.hypothesis.price(runs) - part.price(runs)
            promised = fit.log_evidence - fit.worth_of(name) + price_saved
            parts.append(self._part(fit, part, promised))
        for group in groups:
            part = Hypothesis(fit.names, groups - {group})
            promised = fit.marginal(sigmas=part.sigmas).evidence() - part.price(runs)
            parts.append(self._part(fit, part, promised))
        return parts

    def _part(self, fit: Fit, part: Hypothesis, promised: float) -> Fit:
        """Return the fit of a part of a hypothesis, stored or fitted from the state of ``fit``."""
        attempt = part.key, fit.hypothesis.key
        if attempt not in self.attempts and not self.is_known(part, promised):
            self.attempts.add(attempt)
            keep = np.isin(fit.prior.effect_names, ["", *part.names])
            same = part.sigmas == fit.hypothesis.sigmas
            state = State(
                x=fit.state.x[keep[: fit.state.x.size]],
                discrepancy=fit.state.discrepancy,
                random_effects=np.where(same, fit.state.random_effects, 0.0),
            )
            near = [J[keep] for J in fit.columns]
            self.add(fit_logs(self.problem, part, state, near, tolerance=ROUGH))
        return self.fitted[part.key]

    def evidence_of_all(self, fit: Fit) -> float:
        """ln of the evidence of all logs: those of the problem and the hold-outs."""
        return fit.log_evidence + self.density(fit)

    def density(self, fit: Fit) -> float:
        """ln of the density of the hold-outs given the other logs, up to a constant.

        It follows from one linear model of all logs, at the best random effects of the hold-outs.
        """
        key, holdouts = fit.hypothesis.key, self.holdouts
        if key not in self.densities:
            state = replace(fit.state, random_effects=holdout_effects(holdouts, fit))
            held_out = linearised(holdouts, fit.hypothesis, state)
            together = fit.marginal([*fit.products, *held_out.products])
            gain = together.evidence() - fit.marginal().evidence()
            self.densities[key] = gain - fit.hypothesis.price_of_angles(len(holdouts.runs))
        return self.densities[key]


def _fitted(
    problem: Problem, near: Sequence[Array], unusual_base: bool, least: float, promise: Promise
) -> Fit:
    """Fit a promise from its state; with an ``unusual_base``, from its effects and a usual base."""
    state = promise.state
    if unusual_base:
        start = start_of(problem)
        state = replace(start, x=np.concatenate([start.x, state.x[BASE_SIZE:]]))
    return fit_logs(problem, promise.hypothesis, state, near, least, ROUGH)
